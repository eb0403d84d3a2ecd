"""In version 2.1, springs are read as stated, and change neither a pose, nor a residual, nor K, nor M."""

from __future__ import annotations

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.document import document
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.mechanism import Joint, Mechanism
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.urdf import urdf_text
from eurdf_conformance.properties.yaml_text import yaml_text
from eurdf_conformance.protocol.message import CanonicalRobot

_SPRUNG = frozenset({"revolute", "continuous", "prismatic", "helical"})


def springs(example: Example, version: Version) -> Pair:
    """A mechanism, and the same one with springs on joints with one coordinate, also on mimic joints."""
    mechanism, chance = example.mechanism, example.chance
    written = document(mechanism, version)
    entries = dict(written.get("joints", {}))
    added: dict[str, tuple[float, float]] = {}
    for joint in mechanism.joints:
        if _can_have_spring(mechanism, joint):
            added[joint.name] = chance.between(0.5, 900.0), chance.between(-2.0, 2.0)
            entry = entries.get(joint.name, {})
            entries[joint.name] = {**entry, "stiffness": added[joint.name][0], "rest": added[joint.name][1]}
    files = Files(yaml_text(written | {"joints": entries}), urdf_text(mechanism).encode())

    def carry(robot: CanonicalRobot) -> CanonicalRobot:
        joints = []
        for joint in robot.joints:
            if joint.name in added:
                stiffness, rest = added[joint.name]
                joint = joint.model_copy(update={"stiffness": [stiffness], "rest": [rest]})
            joints.append(joint)
        return robot.model_copy(update={"joints": joints})

    return Pair(query_of(mechanism, version), query_of(mechanism, version, files=files), carry_robot=carry)


def _can_have_spring(mechanism: Mechanism, joint: Joint) -> bool:
    return mechanism.type_of(joint) in _SPRUNG and not joint.name.startswith("x-")


def applies(mechanism: Mechanism) -> bool:
    """Whether a joint can have a spring."""
    return any(_can_have_spring(mechanism, joint) for joint in mechanism.joints)


PROPERTIES = (
    Property(
        "springs",
        "Springs are read as stated, and change neither K nor the mass matrix.",
        ("EU-JNT-031", "EU-JNT-030"),
        (Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        related(springs),
        versions=("2.1",),
        applies=applies,
    ),
)
