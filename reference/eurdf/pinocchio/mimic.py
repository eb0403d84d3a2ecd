"""The mimic joints of a mechanism, in the form that Pinocchio supports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

from eurdf.mechanism.joint import Joint, JointProperties, Mimic, drivers
from eurdf.mechanism.mechanism import Mechanism


class Following(NamedTuple):
    """The mimic joints of a mechanism, in the form that Pinocchio supports.

    Attributes:
        mimics: For each mimic joint, the leader at the end of its chain and the relation between the two: Pinocchio's
            mimic joints cannot be chained.
        late: The leaders that come after one of their mimic joints, in order. Pinocchio needs the leader first.
        unwrapped: Names of the continuous joints with an unwrapped angle as coordinate. Pinocchio's (cos, sin) pair
            loses the number of turns, which matters for a multiplier such as 0.5, for a coupling and for a spring. And
            only a continuous joint can mimic a joint with such a pair.
    """

    mimics: Mapping[str, Mimic] = MappingProxyType({})
    late: tuple[Joint, ...] = ()
    unwrapped: frozenset[str] = frozenset()


def following(mechanism: Mechanism) -> Following:
    """EU-URD-032: the leader of each mimic joint, and the relation between the two."""
    mimics = {joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None and joint.type.is_axial}
    if not mimics and not mechanism.couplings and not any(joint.properties.stiffness for joint in mechanism.joints):
        return Following()
    resolved = drivers(mimics)
    place = {joint.name: index for index, joint in enumerate(mechanism.joints)}
    overtaken = {mimic.joint for name, mimic in resolved.items() if place[name] < place[mimic.joint]}
    late = tuple(joint for joint in mechanism.joints if joint.name in overtaken)
    return Following(resolved, late, _unwrapped(mechanism, resolved))


def _unwrapped(mechanism: Mechanism, resolved: Mapping[str, Mimic]) -> frozenset[str]:
    """EU-CPL-006: the continuous joints whose whole turns matter."""
    continuous = {joint.name for joint in mechanism.joints if joint.type.is_axial and not joint.type.limited}
    # With an integer multiplier, a turn of the leader is a whole number of turns of the mimic joint.
    whole = {name for name, mimic in resolved.items() if mimic.multiplier.is_integer()}
    # If one joint of a leader needs an unwrapped angle, so do the leader and its other mimic joints.
    plain = {
        mimic.joint for name, mimic in resolved.items() if not ({name, mimic.joint} <= continuous and name in whole)
    }
    plain.update(name for coupling in mechanism.couplings for name in coupling.joints)
    sprung = {joint.name for joint in mechanism.joints if any(joint.properties.stiffness)}
    plain.update(resolved[name].joint if name in resolved else name for name in sprung)
    return frozenset(continuous & (plain | {name for name, mimic in resolved.items() if mimic.joint in plain}))


def with_followers(mechanism: Mechanism, led: Following) -> dict[str, JointProperties]:
    """EU-JNT-032: the properties of each leader, with the armature, damping and friction of its mimic joints.

    A mimic joint moves with the velocity m v of its leader. So its armature and damping count m² times at the leader,
    and its friction |m| times. In a bare URDF nothing is added, as in Pinocchio's own parser.
    """
    if not led.mimics:
        return {}
    joints = {joint.name: joint for joint in mechanism.joints}
    folded: dict[str, JointProperties] = {}
    for name, mimic in led.mimics.items() if mechanism.version else ():
        m, own = mimic.multiplier, joints[name].properties
        leader = folded.get(mimic.joint, joints[mimic.joint].properties)
        folded[mimic.joint] = replace(
            leader,
            armature=_plus(leader.armature, m * m, own.armature),
            damping=_plus(leader.damping, m * m, own.damping),
            friction=_plus(leader.friction, abs(m), own.friction),
        )
    return folded


def _plus(values: tuple[float, ...], factor: float, more: tuple[float, ...]) -> tuple[float, ...]:
    """The one number of a leader, plus that of a mimic joint times a factor; empty tuples are zeros."""
    return values if not any(more) else (sum(values) + factor * sum(more),)
