"""The mimic joints of a mechanism, in the form that Pinocchio supports."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.mimic import MIMIC_TYPES, Mimic, drivers


@dataclass(frozen=True, slots=True)
class Following:
    """The mimic joints of a mechanism, in the form that Pinocchio supports.

    Attributes:
        mimics: For each mimic joint, the leader at the end of its chain and the relation between the two: Pinocchio's
            mimic joints cannot be chained.
        late: The leaders that come after one of their mimic joints, in order. Pinocchio needs the leader first.
        unwrapped: Names of the continuous joints with an unwrapped angle as coordinate. Pinocchio's (cos, sin) pair
            loses the number of turns, which matters for a multiplier such as 0.5 and for a coupling. And only a
            continuous joint can mimic a joint with such a pair.
    """

    mimics: Mapping[str, Mimic] = field(default_factory=dict)
    late: tuple[Joint, ...] = ()
    unwrapped: frozenset[str] = frozenset()


def following(mechanism: Mechanism) -> Following:
    """EU-URD-032: the leader of each mimic joint, and the relation between the two."""
    mimics = {
        joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None and joint.type in MIMIC_TYPES
    }
    if not mimics and not mechanism.couplings:
        return Following()
    resolved = drivers(mimics)
    place = {joint.name: index for index, joint in enumerate(mechanism.joints)}
    overtaken = {mimic.joint for name, mimic in resolved.items() if place[name] < place[mimic.joint]}
    late = tuple(joint for joint in mechanism.joints if joint.name in overtaken)
    return Following(resolved, late, _unwrapped(mechanism, resolved))


def _unwrapped(mechanism: Mechanism, resolved: Mapping[str, Mimic]) -> frozenset[str]:
    continuous = {joint.name for joint in mechanism.joints if joint.type is JointType.CONTINUOUS}
    # With an integer multiplier, a turn of the leader is a whole number of turns of the mimic joint.
    whole = {name for name, mimic in resolved.items() if mimic.multiplier.is_integer()}
    # If one joint of a leader needs an unwrapped angle, so do the leader and its other mimic joints.
    plain = {
        mimic.joint for name, mimic in resolved.items() if not ({name, mimic.joint} <= continuous and name in whole)
    }
    plain.update(name for coupling in mechanism.couplings for name in coupling.joints)
    return frozenset(continuous & (plain | {name for name, mimic in resolved.items() if mimic.joint in plain}))
