"""Which joint follows which, in the terms of Pinocchio's mimic joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Joint, Mechanism, Mimic

_FOLLOWERS = frozenset({JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC})


@dataclass(frozen=True, slots=True)
class Following:
    """How joints follow others, where Pinocchio is particular.

    Attributes:
        laws: For each joint that mimics, the joint that leads it in the end and the law between the two: Pinocchio's
            mimic joints cannot be chained.
        late: The leaders that come after one of their followers, in order. In Pinocchio a leader comes first.
        counted: Names of the continuous joints to hold as one angle. Pinocchio holds a continuous joint as (cos, sin),
            which has lost the number of turns that a multiplier such as 0.5 is in want of, and lets only continuous
            joints follow one, which follow no other.
    """

    laws: Mapping[str, Mimic] = field(default_factory=dict)
    late: tuple[Joint, ...] = ()
    counted: frozenset[str] = frozenset()


NONE = Following()


def following(mechanism: Mechanism) -> Following:
    """EU-URD-032: which joint follows which, and by what law."""
    mimics = {
        joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None and joint.type in _FOLLOWERS
    }
    if not mimics:
        return NONE
    laws: dict[str, Mimic] = {}
    for name in mimics:
        _follow_chain(name, mimics, laws)
    place = {joint.name: index for index, joint in enumerate(mechanism.joints)}
    overtaken = {law.joint for name, law in laws.items() if place[name] < place[law.joint]}
    late = tuple(joint for joint in mechanism.joints if joint.name in overtaken)
    return Following(laws, late, _counted(mechanism, laws))


def _follow_chain(name: str, mimics: Mapping[str, Mimic], laws: dict[str, Mimic]) -> None:
    """Find the law that leads a joint in the end, m₂ (m₁ q + o₁) + o₂, and those of the joints on the way to it."""
    chain = []
    while name in mimics and name not in laws:
        chain.append(name)
        name = mimics[name].joint
    for follower in reversed(chain):
        mimic = mimics[follower]
        step = laws.get(mimic.joint)
        if step is not None:
            offset = mimic.multiplier * step.offset + mimic.offset
            mimic = Mimic(step.joint, mimic.multiplier * step.multiplier, offset)
        laws[follower] = mimic


def _counted(mechanism: Mechanism, laws: Mapping[str, Mimic]) -> frozenset[str]:
    continuous = {joint.name for joint in mechanism.joints if joint.type is JointType.CONTINUOUS}
    # A turn of the leader is a whole number of turns of a follower, or makes a difference.
    whole = {name for name, law in laws.items() if law.multiplier.is_integer()}
    # One joint with a plain coordinate makes all that lead it, or are led with it, have one.
    plain = {law.joint for name, law in laws.items() if not ({name, law.joint} <= continuous and name in whole)}
    return frozenset(continuous & (plain | {name for name, law in laws.items() if law.joint in plain}))
