"""A joint that the description locks behaves as a joint that is fixed in the URDF."""

from __future__ import annotations

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import Joint, Mechanism
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of


def locking(example: Example, version: Version) -> Pair:
    """A mechanism whose locked joints are fixed in the URDF, and the same one whose description locks them."""
    return Pair(query_of(fixed_in_urdf(example.mechanism), version), query_of(example.mechanism, version))


def fixed_in_urdf(mechanism: Mechanism) -> Mechanism:
    """The mechanism with locked joints fixed in the URDF."""
    locked = {name for name, change in mechanism.changes.items() if change.type == "fixed"}
    return mechanism.replace(
        joints=tuple(_fixed(joint) if joint.name in locked else joint for joint in mechanism.joints),
        changes={name: change for name, change in mechanism.changes.items() if name not in locked},
    )


def _fixed(joint: Joint) -> Joint:
    return Joint(name=joint.name, type="fixed", parent=joint.parent, child=joint.child, origin=joint.origin)


def has_locked(mechanism: Mechanism) -> bool:
    """Whether a joint is locked."""
    return any(change.type == "fixed" for change in mechanism.changes.values())


PROPERTIES = (
    Property(
        "locking",
        "A joint that the description locks behaves as a fixed joint of the URDF.",
        ("EU-JNT-019", "EU-FRM-004", "EU-INR-005"),
        (Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        related(locking),
        applies=has_locked,
    ),
)
