"""Lock joints of a mechanism: they become fixed; everything else keeps its name and place."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from eurdf.diagnostics.wording import meant
from eurdf.errors import CannotLock
from eurdf.mechanism.constraint import Constraint
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.spanning_tree import rigid_roots

#: A named configuration is kept if its pose of each locked joint differs from the locked pose by at most this, m and
#: rad.
AGREEMENT = 1e-6

Coordinates = Mapping[str, Sequence[float]]


@dataclass(frozen=True, slots=True)
class LockedMechanism:
    """A mechanism with locked joints, and what was removed from it.

    Attributes:
        mechanism: The mechanism, in which locked joints are fixed. Bodies, joints and frames keep names and order.
        joints: Names of the locked joints, including their mimic joints, in the mechanism's order.
        constraints: The removed constraints: those that no free joint changes.
        actuators: Names of the removed actuators: those that are locked.
        configurations: Names of the removed configurations: those with a different pose of a locked joint.
    """

    mechanism: Mechanism
    joints: tuple[str, ...]
    constraints: tuple[Constraint, ...]
    actuators: tuple[str, ...]
    configurations: tuple[str, ...]


def lock_joints(mechanism: Mechanism, joints: Iterable[str], coordinates: Coordinates) -> LockedMechanism:
    """Fix joints at given coordinates.

    The placement of a locked joint becomes ``placement * joint.transform(c) * offset``, so the child link and
    the joint's frame stay in place. The function does not check that the removed constraints were met.

    Args:
        mechanism: The mechanism.
        joints: Names of joints. The mimic joints of a locked joint are locked too; a fixed joint stays fixed.
        coordinates: Coordinates of joints as in files. A joint that is not given is at its neutral coordinates; those
            of a mimic joint are ignored.

    Raises:
        CannotLock: A name is not the name of a joint, or a mimic joint is named without its leader.
        ValueError: The number of coordinates of a joint is wrong, or a quaternion has length 0.
    """
    by_name = {joint.name: joint for joint in mechanism.joints}
    mimics = mechanism.leaders
    locked = _locked(by_name, joints, mimics)
    at = {name: by_name[name].transform(_coordinates(by_name, name, coordinates, mimics)) for name in locked}
    ordered = tuple(_fixed(joint, at) for joint in mechanism.joints)
    rigid = rigid_roots(mechanism.bodies[0].name, ordered)
    # The coordinate of each locked joint that has one.
    values = {}
    for name in locked:
        own = _coordinates(by_name, name, coordinates, mimics)
        if len(own) == 1:
            values[name] = own[0]
    constant = {
        constraint.name
        for constraint in mechanism.constraints
        if len({rigid[anchor.body] for anchor in constraint.anchors}) < 2 and at.keys() >= set(constraint.joints)
    }
    kept = {
        name: MappingProxyType({joint: values for joint, values in configuration.items() if joint not in at})
        for name, configuration in mechanism.configurations.items()
        if all(
            _near(pose, by_name[joint].transform(_coordinates(by_name, joint, configuration, mimics)))
            for joint, pose in at.items()
        )
    }
    return LockedMechanism(
        replace(
            mechanism,
            joints=ordered,
            closures=tuple(closure for closure in mechanism.closures if closure.name not in constant),
            couplings=tuple(
                coupling.with_joints_locked(values) for coupling in mechanism.couplings if coupling.name not in constant
            ),
            actuators=tuple(name for name in mechanism.actuators if name not in at),
            motors=MappingProxyType({name: motor for name, motor in mechanism.motors.items() if name not in at}),
            configurations=MappingProxyType(kept),
        ),
        tuple(at),
        tuple(constraint for constraint in mechanism.constraints if constraint.name in constant),
        tuple(name for name in mechanism.actuators if name in at),
        tuple(name for name in mechanism.configurations if name not in kept),
    )


def _locked(by_name: Mapping[str, Joint], names: Iterable[str], mimics: Mapping[str, Mimic]) -> list[str]:
    """The joints to lock, in the mechanism's order: those named and their mimic joints, without fixed ones."""
    named = set(names)
    for name in sorted(named - by_name.keys()):
        raise CannotLock(name, f"the robot has no such joint{meant(name, by_name)}")
    locked = []
    for name in by_name:
        leader = mimics[name].joint if name in mimics else name
        if leader in named:
            locked.append(name)
        elif name in named:
            raise CannotLock(name, f"it is a mimic joint of '{leader}'; lock '{leader}' instead", leader)
    return [name for name in locked if not by_name[name].type.is_fixed]


def _coordinates(
    by_name: Mapping[str, Joint], name: str, coordinates: Coordinates, mimics: Mapping[str, Mimic]
) -> Sequence[float]:
    if name in mimics:
        mimic = mimics[name]
        (leading,) = coordinates.get(mimic.joint, by_name[mimic.joint].type.neutral)
        return (mimic.multiplier * leading + mimic.offset,)
    return coordinates.get(name, by_name[name].type.neutral)


def _fixed(joint: Joint, at: Mapping[str, Pose]) -> Joint:
    """The joint; if it is locked, a fixed joint at its locked pose."""
    if joint.name not in at:
        return joint
    return joint.fixed(joint.placement * at[joint.name] * joint.offset)


def _near(one: Pose, other: Pose) -> bool:
    apart = one.inverse() * other
    angle = 2.0 * math.atan2(math.hypot(*apart.quaternion[:3]), abs(apart.quaternion[3]))
    return math.hypot(*apart.xyz) <= AGREEMENT and angle <= AGREEMENT
