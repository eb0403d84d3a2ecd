"""A description of version 2: chapters The description, Frames, Closures, Joints, Actuation, Configurations."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np

from eurdf_conformance.level import Version
from eurdf_conformance.oracle.description import (
    Actuator,
    Change,
    Closure,
    ClosureType,
    Coupling,
    Description,
    FrameReference,
)
from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.own import own_data
from eurdf_conformance.oracle.plain_value import limits, mapping, number, numbers, sequence, text, vector
from eurdf_conformance.oracle.spatial import Array, from_rpy, pose, unit

KEYS = (
    "extended_urdf",
    "urdf",
    "root",
    "closures",
    "joints",
    "actuators",
    "frames",
    "configurations",
    "metadata",
)
#: Keys that version 2.1 adds.
ADDED = ("couplings",)
PROPERTIES = ("limits", "damping", "friction", "armature")
LIMITS = ("lower", "upper", "velocity", "effort")
#: Since version 2.1.
SPRING = ("stiffness", "rest")

#: For each type that a joint can become, the keys that go with it.
CHANGES = {"spherical": ("merges",), "universal": ("axes",), "cylindrical": (), "helical": ("pitch",), "fixed": ()}


def version2(document: dict[str, Any]) -> Description:
    """Read a description whose `extended_urdf` is "2.0" or "2.1"."""
    versions: dict[str, Version] = {"2.0": "2", "2.1": "2.1"}
    if document["extended_urdf"] not in versions:
        raise NotRead(f"version {document['extended_urdf']!r}")
    version = versions[document["extended_urdf"]]
    members = mapping(document, (*KEYS, *(ADDED if version == "2.1" else ())))
    roots: dict[str, Literal["fixed", "floating"]] = {"fixed": "fixed", "floating": "floating"}
    root = text(members.get("root", "fixed"))
    if root not in roots:
        raise NotRead(f"the root {root!r}")
    text(members.get("urdf", "robot.urdf"))
    mapping(members.get("metadata", {}))
    closures = [closure(value, version) for value in sequence(members.get("closures", []))]
    frames = [frame(value) for value in sequence(members.get("frames", []))]
    if len({name for name, _ in frames}) != len(frames):
        raise NotRead("two frames of one name")
    return Description(
        version=version,
        root=roots[root],
        closures=tuple(found for found in closures if found is not None),
        couplings=tuple(coupling(value) for value in sequence(members.get("couplings", []))),
        changes={name: change(value, version) for name, value in mapping(members.get("joints", {})).items()},
        actuators=tuple(actuator(value, version) for value in sequence(members.get("actuators", []))),
        frames=dict(frames),
        configurations={
            name: {joint: numbers(value) for joint, value in mapping(configuration).items()}
            for name, configuration in mapping(members.get("configurations", {})).items()
        },
        own=own_data(document),
    )


def closure(value: Any, version: Version) -> Closure | None:
    """A closure; one of a user-defined type is left out, EU-CLO-012."""
    members = mapping(value)
    kind = text(members.get("type"))
    types: dict[str, ClosureType] = {"3d": "3d", "6d": "6d"}
    if version == "2.1":
        types |= {"hinge": "hinge", "distance": "distance"}
    own: dict[str | None, tuple[str, ...]] = {"hinge": ("axis", "axes"), "distance": ("length",)}
    added = ("compliance",) if version == "2.1" else ()
    members = mapping(value, ("name", "type", "frames", *added, *own.get(types.get(kind), ())))
    if kind.startswith("x-"):
        return None
    if kind not in types or len(sequence(members.get("frames"))) != 2:
        raise NotRead(f"the closure {value!r}")
    a, b = (reference(item) for item in members["frames"])
    found = Closure(text(members.get("name")), types[kind], a, b, compliance=compliance(members, types[kind]))
    if kind == "hinge":
        return replace(found, axes=hinge_axes(members))
    return replace(found, length=distance_length(members)) if kind == "distance" else found


def compliance(members: dict[str, Any], kind: ClosureType) -> dict[str, float] | None:
    """How much a closure gives way: an angular one only if it holds an orientation, EU-CLO-020."""
    if "compliance" not in members:
        return None
    written = mapping(members["compliance"], ("linear", "angular"))
    found = {name: number(value) for name, value in written.items()}
    if not found or min(found.values()) < 0 or (found.get("angular") and kind in ("3d", "distance")):
        raise NotRead(f"the compliance {found!r}")
    return {name: found.get(name, 0.0) for name in ("linear", "angular")}


def hinge_axes(members: dict[str, Any]) -> tuple[Array, Array]:
    """The axis of a hinge in A and that in B; z where none is stated."""
    if "axis" in members and "axes" in members:
        raise NotRead("axis and axes")
    if "axes" not in members:
        both = unit(vector(members.get("axis", [0, 0, 1])))
        return both, both
    if len(stated := sequence(members["axes"])) != 2:
        raise NotRead(f"the axes {stated!r}")
    first, second = (unit(vector(axis)) for axis in stated)
    return first, second


def distance_length(members: dict[str, Any]) -> float:
    """The length of a distance, m; at least 0.1 mm."""
    length = number(members.get("length"))
    if length < 1e-4:
        raise NotRead(f"the length {length!r}")
    return length


def coupling(value: Any) -> Coupling:
    """A linear relation of two or more joints."""
    members = mapping(value, ("name", "joints", "offset"))
    joints = {name: number(coefficient) for name, coefficient in mapping(members.get("joints")).items()}
    if len(joints) < 2 or not all(joints.values()):
        raise NotRead(f"the coupling {value!r}")
    return Coupling(text(members.get("name")), joints, number(members.get("offset", 0)))


def reference(value: Any) -> FrameReference:
    """A reference to a frame: a name, or a mapping with `link` or `joint` and a pose."""
    if isinstance(value, str):
        return FrameReference("name", value, np.eye(4))
    members = mapping(value, ("link", "joint", "xyz", "rpy"))
    if ("link" in members) == ("joint" in members):
        raise NotRead(f"the frame {value!r}")
    M = pose(from_rpy(vector(members.get("rpy", [0, 0, 0]))), vector(members.get("xyz", [0, 0, 0])))
    if "link" in members:
        return FrameReference("link", text(members["link"]), M)
    return FrameReference("joint", text(members["joint"]), M)


def frame(value: Any) -> tuple[str, FrameReference]:
    """A frame that the description adds, and its name."""
    members = mapping(value)
    return text(members.pop("name", None)), reference(members)


def actuator(value: Any, version: Version) -> Actuator:
    """An actuator: a joint name, or a mapping with properties of the motor."""
    if isinstance(value, str):
        return Actuator(value)
    members = mapping(
        value, ("joint", "gear_ratio", "rotor_inertia", *(("name", "control") if version == "2.1" else ()))
    )
    gear, rotor = number(members.get("gear_ratio", 1)), number(members.get("rotor_inertia", 0))
    name = text(members["name"]) if "name" in members else None
    return Actuator(text(members.get("joint")), gear, rotor, name, control_range(members))


def control_range(members: dict[str, Any]) -> list[float] | None:
    """The range of torque or force of an actuator, EU-ACT-009; None where none is stated."""
    if "control" not in members:
        return None
    stated = [number(value) for value in sequence(members["control"])]
    if len(stated) != 2 or stated[0] > stated[1]:
        raise NotRead(f"the control range {stated!r}")
    return stated


def change(value: Any, version: Version) -> Change:
    """A type alone, or a mapping with a type, properties, or both."""
    members = {"type": value} if isinstance(value, str) else mapping(value)
    kind = members.get("type")
    if kind is not None and text(kind) not in CHANGES:
        raise NotRead(f"the type {kind!r}")
    added = (*SPRING, "mimic") if version == "2.1" else ()
    members = mapping(members, ("type", *PROPERTIES, *added, *CHANGES.get(kind or "", ())))
    if members.get("mimic", False) is not False or ("rest" in members and "stiffness" not in members):
        raise NotRead(f"the joint {value!r}")
    stated = members | mapping(members.get("limits", {}), LIMITS)
    return Change(
        type=kind,
        axes=axes(members.get("axes")) if kind == "universal" else (),
        pitch=number(members.get("pitch")) if kind == "helical" else 0.0,
        merges=tuple(text(name) for name in sequence(members.get("merges", []))),
        stated={
            name: limits(name, stated[name]) if name in LIMITS else [*numbers(stated[name])]
            for name in (*LIMITS, *PROPERTIES[1:], *SPRING)
            if name in stated
        },
        freed="mimic" in members,
    )


def axes(value: Any) -> tuple[Array, Array]:
    """The first and the second axis of a universal joint: two letters, or two vectors."""
    letters = dict(zip("xyz", np.eye(3), strict=True))
    if len(axes := list(value) if isinstance(value, str) else sequence(value)) != 2:
        raise NotRead(f"the axes {value!r}")
    first, second = (letters[axis] if axis in ("x", "y", "z") else unit(vector(axis)) for axis in axes)
    return first, second
