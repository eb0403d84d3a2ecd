"""Which joint follows which, in the terms of Pinocchio's mimic joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.mimic import MIMIC_TYPES, Mimic, drivers


@dataclass(frozen=True, slots=True)
class Following:
    """How joints follow others, where Pinocchio is particular.

    Attributes:
        laws: For each joint that mimics, the joint that leads it in the end and the law between the two: Pinocchio's
            mimic joints cannot be chained.
        late: The leaders that come after one of their followers, in order. In Pinocchio a leader comes first.
        counted: Names of the continuous joints to hold as one angle. Pinocchio holds a continuous joint as (cos, sin),
            which has lost the number of turns that a multiplier such as 0.5 is in want of, and lets only continuous
            joints follow one, which follow no other. A coupling counts turns as well.
    """

    laws: Mapping[str, Mimic] = field(default_factory=dict)
    late: tuple[Joint, ...] = ()
    counted: frozenset[str] = frozenset()


def following(mechanism: Mechanism) -> Following:
    """EU-URD-032: which joint follows which, and by what law."""
    mimics = {
        joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None and joint.type in MIMIC_TYPES
    }
    if not mimics and not mechanism.couplings:
        return Following()
    laws = drivers(mimics)
    place = {joint.name: index for index, joint in enumerate(mechanism.joints)}
    overtaken = {law.joint for name, law in laws.items() if place[name] < place[law.joint]}
    late = tuple(joint for joint in mechanism.joints if joint.name in overtaken)
    return Following(laws, late, _counted(mechanism, laws))


def _counted(mechanism: Mechanism, laws: Mapping[str, Mimic]) -> frozenset[str]:
    continuous = {joint.name for joint in mechanism.joints if joint.type is JointType.CONTINUOUS}
    # A turn of the leader is a whole number of turns of a follower, or makes a difference.
    whole = {name for name, law in laws.items() if law.multiplier.is_integer()}
    # One joint with a plain coordinate makes all that lead it, or are led with it, have one.
    plain = {law.joint for name, law in laws.items() if not ({name, law.joint} <= continuous and name in whole)}
    plain.update(name for coupling in mechanism.couplings for name in coupling.joints)
    return frozenset(continuous & (plain | {name for name, law in laws.items() if law.joint in plain}))
