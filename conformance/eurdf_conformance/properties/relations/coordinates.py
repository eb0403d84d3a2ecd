"""One configuration in other numbers: neutral joints left out, −q for q, and additional turns."""

from __future__ import annotations

import math

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Configuration, Coordinates, Mechanism
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.truth import truth


def leaving_out(example: Example, version: Version) -> Pair:
    """A robot at configurations that name every joint, and at the same without joints at neutral."""
    mechanism = example.mechanism
    neutral = {name: tuple(q) for name, q in truth(mechanism, "2").neutral().items()}
    whole = {name: {**neutral, **q} for name, q in mechanism.configurations.items()}
    return Pair(query_of(mechanism, version, at=whole), query_of(mechanism, version))


def turning(example: Example, version: Version) -> Pair:
    """A robot, and the same with −q for each quaternion q and an additional turn of each continuous joint."""
    mechanism = example.mechanism
    types = mechanism.types()
    at: dict[str, Configuration] = {
        name: {joint: _turned(types[joint], q) for joint, q in configuration.items() if not _leads(mechanism, joint)}
        | {joint: q for joint, q in configuration.items() if _leads(mechanism, joint)}
        for name, configuration in mechanism.configurations.items()
    }
    return Pair(query_of(mechanism, version), query_of(mechanism, version, at=at))


def _turned(kind: str, q: Coordinates) -> Coordinates:
    if kind == "continuous":
        return (q[0] + math.tau,)
    if kind in ("spherical", "floating"):
        return (*q[:-4], *(-x for x in q[-4:]))
    return q


def _leads(mechanism: Mechanism, joint: str) -> bool:
    """Whether another joint mimics this one: then an additional turn changes the pose."""
    return any(each.mimic is not None and each.mimic.joint == joint for each in mechanism.joints)


def has_turns(mechanism: Mechanism) -> bool:
    """Whether a joint has several coordinates for one pose."""
    return bool({"continuous", "spherical", "floating"} & set(mechanism.types().values()))


PROPERTIES = (
    Property(
        "leaving-out",
        "A joint that a configuration omits has its neutral coordinates.",
        ("EU-JNT-025", "EU-CFG-005"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(leaving_out),
    ),
    Property(
        "turning",
        "q and −q are the same rotation, and a full turn of a continuous joint changes nothing.",
        ("EU-JNT-025", "EU-JNT-015"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(turning),
        applies=has_turns,
    ),
)
