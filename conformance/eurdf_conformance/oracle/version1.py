"""A description of version 1, the published dialect: chapter Version 1."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from eurdf_conformance.json_pointer import step
from eurdf_conformance.oracle.description import Actuator, Change, Closure, Description, FrameReference
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.plain_value import sequence, text

KEYS = ("closed_loop", "type", "name_mot", "joint_name", "joint_type")


def version1(document: dict[str, Any]) -> Description:
    """Read the five keys, EU-ONE-001; all others are user-defined, EU-ONE-008."""
    loops = sequence(document.get("closed_loop", []))
    types = sequence(document.get("type", ["6d"] * len(loops)))  # EU-ONE-004
    names = [text(name) for name in sequence(document.get("joint_name", []))]
    changes = [change(text(kind)) for kind in sequence(document.get("joint_type", []))]
    if len(types) != len(loops) or len(names) != len(changes) or len(set(names)) != len(names):
        raise NotRead("lists of unequal length, or a joint that occurs twice")
    return Description(
        version="1",
        closures=tuple(
            closure(i, loop, text(kind)) for i, (loop, kind) in enumerate(zip(loops, types, strict=True), 1)
        ),
        changes=dict(zip(names, changes, strict=True)),
        actuators=tuple(Actuator(text(name)) for name in sequence(document.get("name_mot", []))),
        own={step(key): value for key, value in document.items() if key not in KEYS},
    )


def closure(i: int, loop: Any, kind: str) -> Closure:
    """The i-th closure, from 1, which gives its name, EU-ONE-005."""
    types: dict[str, Literal["3d", "6d"]] = {"3d": "3d", "6d": "6d"}
    if kind.lower() not in types or len(sequence(loop)) != 2:
        raise NotRead(f"the closure {loop!r} of type {kind!r}")
    a, b = (FrameReference("name", text(name), np.eye(4)) for name in loop)
    return Closure(f"closure_{i}", types[kind.lower()], a, b)


def change(kind: str) -> Change:
    """The change for one word of `joint_type`."""
    if kind in ("SPHERICAL", "FIXED"):
        return Change(kind.lower())
    letters = kind.removeprefix("UJOINT_")
    if len(kind) != 9 or len(set(letters)) != 2 or not set(letters) <= set("XYZ"):
        raise NotRead(f"the type {kind!r}")
    return Change("pair", axes=tuple(np.eye(3)["XYZ".index(letter)] for letter in letters), letters=letters)
