"""Joints of a mechanism locked where they stand: what moved becomes fixed, and all else keeps its name and place."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from eurdf.kinematics.exceptions import CannotLock
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_transform import joint_transform
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.mimic import Mimic, drivers
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.spanning_tree import rigid_roots

#: A named configuration may place a locked joint's child this far from where it is locked, in m and in rad.
AGREEMENT = 1e-6

Coordinates = Mapping[str, Sequence[float]]


@dataclass(frozen=True, slots=True)
class LockedMechanism:
    """A mechanism some of whose joints are locked, and what went with them.

    Attributes:
        mechanism: The mechanism, its locked joints fixed. Bodies, joints and frames have kept names and order.
        joints: Names of the joints that were locked, those that follow one of them too, in the mechanism's order.
        closures: Those that are gone, since nothing moves their two frames against each other any more.
        actuators: Names of those that are gone, since they are locked.
        configurations: Names of those that are gone, since they have a locked joint elsewhere.
    """

    mechanism: Mechanism
    joints: tuple[str, ...]
    closures: tuple[Closure, ...]
    actuators: tuple[str, ...]
    configurations: tuple[str, ...]


def lock_joints(mechanism: Mechanism, joints: Iterable[str], coordinates: Coordinates) -> LockedMechanism:
    """Fix joints at given coordinates.

    The placement of a locked joint becomes ``placement * joint_transform(joint, c) * offset``, so that its child, and
    the frame that bears the joint's name, stay where they are. Whether the closures that are gone were closed is not
    looked at.

    Args:
        mechanism: The mechanism.
        joints: Names of joints. With a joint, those that follow it are locked; one that is fixed stays so.
        coordinates: For each joint its coordinates as files have them. A joint left out is at its neutral; those of a
            mimic joint are ignored.

    Raises:
        CannotLock: A name is that of no joint, or of one that follows another that is not locked.
        ValueError: A joint is given too few or too many coordinates, or a quaternion of length 0.
    """
    by_name = {joint.name: joint for joint in mechanism.joints}
    laws = drivers({joint.name: joint.mimic for joint in mechanism.joints if joint.mimic is not None})
    locked = _locked(by_name, joints, laws)
    at = {name: joint_transform(by_name[name], _coordinates(by_name, name, coordinates, laws)) for name in locked}
    ordered = tuple(_fixed(joint, at) for joint in mechanism.joints)
    rigid = rigid_roots(mechanism.bodies[0].name, ordered)
    movable: list[Closure] = []
    constant: list[Closure] = []
    for closure in mechanism.closures:
        (constant if rigid[closure.a.body] == rigid[closure.b.body] else movable).append(closure)
    kept = {
        name: MappingProxyType({joint: values for joint, values in configuration.items() if joint not in at})
        for name, configuration in mechanism.configurations.items()
        if all(
            _near(pose, joint_transform(by_name[joint], _coordinates(by_name, joint, configuration, laws)))
            for joint, pose in at.items()
        )
    }
    return LockedMechanism(
        replace(
            mechanism,
            joints=ordered,
            closures=tuple(movable),
            actuators=tuple(name for name in mechanism.actuators if name not in at),
            configurations=MappingProxyType(kept),
        ),
        tuple(at),
        tuple(constant),
        tuple(name for name in mechanism.actuators if name in at),
        tuple(name for name in mechanism.configurations if name not in kept),
    )


def _locked(by_name: Mapping[str, Joint], names: Iterable[str], laws: Mapping[str, Mimic]) -> list[str]:
    """The joints to be locked, in the mechanism's order: those named, but fixed ones, and all that follow them."""
    named = set(names)
    for name in sorted(named - by_name.keys()):
        near = difflib.get_close_matches(name, list(by_name), n=1)
        raise CannotLock(name, "there is no such joint" + (f"; did you mean '{near[0]}'?" if near else ""))
    locked = []
    for name in by_name:
        leader = laws[name].joint if name in laws else name
        if leader in named:
            locked.append(name)
        elif name in named:
            raise CannotLock(name, f"it follows '{leader}'; lock that one", leader)
    return [name for name in locked if by_name[name].type is not JointType.FIXED]


def _coordinates(
    by_name: Mapping[str, Joint], name: str, coordinates: Coordinates, laws: Mapping[str, Mimic]
) -> Sequence[float]:
    if name in laws:
        law = laws[name]
        (leading,) = coordinates.get(law.joint, by_name[law.joint].coordinates.neutral)
        return (law.multiplier * leading + law.offset,)
    return coordinates.get(name, by_name[name].coordinates.neutral)


def _fixed(joint: Joint, at: Mapping[str, Pose]) -> Joint:
    """The joint, fixed where it is if it is locked."""
    if joint.name not in at:
        return joint
    placement = joint.placement * at[joint.name] * joint.offset
    return Joint(joint.name, JointType.FIXED, joint.parent, joint.child, placement)


def _near(one: Pose, other: Pose) -> bool:
    apart = one.inverse() * other
    angle = 2.0 * math.atan2(math.hypot(*apart.quaternion[:3]), abs(apart.quaternion[3]))
    return math.hypot(*apart.xyz) <= AGREEMENT and angle <= AGREEMENT
