"""In version 2.1, a mimic joint that the description frees moves as one without `mimic`."""

from __future__ import annotations

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.document import Document, document
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.mechanism import Joint, Mechanism, Mimic
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.relations.following import has_mimic
from eurdf_conformance.properties.urdf import urdf_text
from eurdf_conformance.properties.yaml_text import yaml_text

_CAN_MIMIC = frozenset({"revolute", "continuous", "prismatic"})


def freeing(example: Example, version: Version) -> Pair:
    """A mechanism without mimic joints, and the same one whose URDF has some, all of them freed."""
    mechanism, chance = example.mechanism, example.chance
    joints: list[Joint] = []
    for joint in mechanism.joints:
        leaders = [each.name for each in joints if each.type in _CAN_MIMIC]
        if _is_freeable(joint) and leaders and chance.is_so(0.8):
            mimic = Mimic(
                joint=chance.one_of(leaders),
                multiplier=chance.between(-2.0, 2.0),
                offset=chance.between(-0.5, 0.5),
            )
            joint = joint.model_copy(update={"mimic": mimic})
        joints.append(joint)
    mimicking = mechanism.replace(joints=tuple(joints))
    files = Files(yaml_text(_freed(mimicking, version)), urdf_text(mimicking).encode())
    return Pair(query_of(mechanism, version), query_of(mechanism, version, files=files))


def _is_freeable(joint: Joint) -> bool:
    return joint.type in _CAN_MIMIC and not joint.name.startswith("x-")


def _freed(mechanism: Mechanism, version: Version) -> Document:
    """The description, in which each joint with a mimic is freed: a merged one in the entry that merges it."""
    found = document(mechanism, version)
    entries = dict(found.get("joints", {}))
    for joint in mechanism.joints:
        if joint.mimic:
            name = mechanism.merged.get(joint.name, joint.name)
            entry = entries.get(name, {})
            entries[name] = {**({"type": entry} if isinstance(entry, str) else entry), "mimic": False}
    return found | ({"joints": entries} if entries else {})


def applies(mechanism: Mechanism) -> bool:
    """Whether no joint mimics another, and one could."""
    return not has_mimic(mechanism) and sum(map(_is_freeable, mechanism.joints)) > 1


PROPERTIES = (
    Property(
        "freeing",
        "A mimic joint that is freed moves as a joint without `mimic`.",
        ("EU-JNT-033", "EU-JNT-034"),
        (Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        related(freeing),
        versions=("2.1",),
        applies=applies,
    ),
)
