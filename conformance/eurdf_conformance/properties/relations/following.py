"""A mimic joint moves as an independent joint at the same coordinate; in version 1 `mimic` has no effect."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.files import Files
from eurdf_conformance.properties.mechanism import Configuration, Limit, Mechanism, Mimic
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.relations.changing import in_velocities
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.properties.urdf import urdf_text
from eurdf_conformance.protocol.message import Values

_WIDE = Limit(effort=1.0, velocity=1.0, lower=-100.0, upper=100.0)


def following(example: Example, version: Version) -> Pair:
    """A mechanism without mimic joints, at coordinates that satisfy the mimic equations, and the one with them.

    With q = m q_leader + o, the column of the leader is its own and m times that of who follows it.
    """
    mechanism = example.mechanism
    followers = {
        joint.name: follows for joint in mechanism.joints if (follows := leader(mechanism, joint.name))[0] != joint.name
    }
    free = freed(mechanism)
    at: dict[str, Configuration] = {}
    for name, q in mechanism.configurations.items():
        followed = {
            joint: (multiplier * q.get(driver, (0.0,))[0] + offset,)
            for joint, (driver, multiplier, offset) in followers.items()
        }
        at[name] = {**q, **followed}
    before, columns = truth(free, version).velocities, truth(mechanism, version).velocities
    J = np.zeros((len(before), len(columns)))
    for i, (name, number) in enumerate(before):
        driver, multiplier, _ = followers.get(name, (name, 1.0, 0.0))
        J[i, columns.index((driver, number))] = multiplier

    def carry(values: Values, index: int) -> Values:
        return in_velocities(values, J, columns)

    return Pair(query_of(free, version, at=at), query_of(mechanism, version), carry)


def leader(mechanism: Mechanism, joint: str) -> tuple[str, float, float]:
    """The joint at the end of a chain of mimics, with the multiplier and the offset of the whole chain."""
    mimics = {each.name: each.mimic for each in mechanism.joints}
    multiplier, offset = 1.0, 0.0
    while (mimic := mimics.get(joint)) is not None:
        multiplier, offset, joint = multiplier * mimic.multiplier, multiplier * mimic.offset + offset, mimic.joint
    return joint, multiplier, offset


def freed(mechanism: Mechanism) -> Mechanism:
    """Without mimics, and with wider limits for the joints that had one."""
    return mechanism.replace(
        joints=tuple(
            joint.model_copy(update={"mimic": None, "limit": _WIDE}) if joint.mimic else joint
            for joint in mechanism.joints
        )
    )


def ignoring(example: Example, version: Version) -> Pair:
    """A mechanism without mimics, and the same with mimics in its URDF, right or wrong."""
    mechanism, chance = example.mechanism, example.chance
    names = [*(joint.name for joint in mechanism.joints), "nobody"]
    joints = tuple(
        joint.model_copy(
            update={
                "mimic": Mimic(
                    joint=chance.one_of(names), multiplier=chance.between(-2.0, 2.0), offset=chance.between(-0.5, 0.5)
                )
                if chance.is_so(0.7)
                else None
            }
        )
        for joint in mechanism.joints
    )
    query = query_of(mechanism, version)
    files = Files(query.files.description, urdf_text(mechanism.replace(joints=joints)).encode())
    return Pair(query, query_of(mechanism, version, files=files))


def has_joint(mechanism: Mechanism) -> bool:
    """Whether a joint could have a mimic."""
    return bool(mechanism.joints)


def has_mimic(mechanism: Mechanism) -> bool:
    """Whether a joint mimics another."""
    return any(joint.mimic for joint in mechanism.joints)


PROPERTIES = (
    Property(
        "following",
        "A mimic joint moves as a free joint at the coordinate that its leader prescribes.",
        ("EU-URD-032", "EU-CLO-010", "EU-INR-006"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(following),
        versions=("2",),
        applies=has_mimic,
    ),
    Property(
        "mimics-ignored",
        "In version 1 a `mimic` changes nothing.",
        ("EU-ONE-009",),
        (Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        related(ignoring),
        versions=("1",),
        applies=has_joint,
    ),
)
