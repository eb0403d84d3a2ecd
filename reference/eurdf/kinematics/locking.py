"""Lock joints of a robot: the result is a smaller robot that moves as the first one with these joints held."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from eurdf.array import Indices, Vector
from eurdf.diagnostics.wording import meant
from eurdf.errors import CannotLock, LockedOpen
from eurdf.kinematics.closing import start
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.named import Named
from eurdf.kinematics.residual import all_openings, residual
from eurdf.kinematics.tolerances import CLOSED
from eurdf.mechanism.body import WORLD
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.mechanism.spanning_tree import rigid_roots
from eurdf.pinocchio.arguments import as_names, checked_tolerance
from eurdf.pinocchio.robot import Robot, build_robot, carried_over

# A named configuration is kept if it differs by at most this, m and rad, in the pose of each locked joint.
_AGREEMENT = 1e-6

_Coordinates = Mapping[str, Sequence[float]]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LockedRobot(Robot):
    """A robot with locked joints.

    Let q and v be a configuration and a velocity of the original robot at which the locked joints do not move. Those of
    this robot are ``q[robot.idx_q]`` and ``v[robot.idx_v]``.

    Attributes:
        locked_joints: Names of the locked joints, including their mimic joints.
        dropped_closures: Names of the closures that were removed, because no joint moves their two frames relative to
            each other any more. They are closed.
        dropped_actuators: Names of the actuators that were locked.
        dropped_configurations: Names of the configurations with a different pose of a locked joint.
        idx_q: Indices (nq,) of its coordinates in a q of the original robot.
        idx_v: Indices (nv,) of its velocities in a v of the original robot.
    """

    locked_joints: tuple[str, ...]
    dropped_closures: tuple[str, ...]
    dropped_actuators: tuple[str, ...]
    dropped_configurations: tuple[str, ...]
    idx_q: Indices
    idx_v: Indices

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}; locked: {', '.join(self.locked_joints) or 'none'}>"


def lock(
    robot: Robot, joints: str | Iterable[str], q: Named | None = None, *, tolerance: float = CLOSED
) -> LockedRobot:
    """Lock joints of a robot at a configuration.

    The locked joints become fixed joints of the new robot. All links, joints and frames keep their names and order and,
    at equal coordinates of the free joints, their poses. The new robot has the closures, actuators, geometry, limits
    and named configurations of the original one, except those that no longer apply; it lists what was dropped. A
    closure is dropped if no free joint moves its two frames relative to each other; a closure that became redundant is
    kept. A named configuration is dropped if the pose of a locked joint differs from that at q by more than 1e-6 m or
    rad.

    Model, constraint models and actuation are built from ``robot.mechanism``: manual changes to them are lost. Geometry
    is copied with its collision pairs, and shares its meshes.

    It corresponds to `freezeJoints` of the published toolbox (Batto, De Matteïs, Mansard, 2025) and, for a robot
    without closures, to ``pin.buildReducedModel``.

    Args:
        robot: The robot; it is not changed.
        joints: Names of joints, or one name. Mimic joints are locked with their leader. A fixed joint stays fixed.
        q: The configuration (nq,) to lock at. Coordinates of other joints matter only to the closures that are dropped.
            The default is the `assembled` configuration, or the neutral one if there is none.
        tolerance: Bound of each row of the residual of a dropped closure at q, m or rad.

    Raises:
        CannotLock: A name is not the name of a joint, or it is a mimic joint without its leader, or the floating root.
        LockedOpen: A closure that would be dropped is open at q.
        ValueError: ``q`` is not a configuration.
    """
    names = set(as_names(joints))
    if ROOT_JOINT in names and robot.mechanism.root == "floating":
        raise CannotLock(ROOT_JOINT, "it is the floating root; load the robot with root='fixed' instead")
    q, tolerance = start(robot, q, "q"), checked_tolerance(tolerance)
    locked = lock_joints(robot.mechanism, names, robot.joint_positions(q, mimic=True))
    _check_closed(robot, q, locked.constraints, tolerance)
    built = build_robot(locked.mechanism, geometry=False)
    idx_q, idx_v = _free_indices(robot, built)
    diagnostics = robot.diagnostics
    return LockedRobot(
        built.mechanism,
        built.model,
        carried_over(robot, built),
        robot.no_geometry,
        lambda _: diagnostics,
        locked_joints=locked.joints,
        dropped_closures=locked.constraints,
        dropped_actuators=locked.actuators,
        dropped_configurations=locked.configurations,
        idx_q=idx_q,
        idx_v=idx_v,
    )


def _check_closed(robot: Robot, q: Vector, names: Collection[str], tolerance: float) -> None:
    """Refuse closures that are open at q."""
    if not names:
        return
    r = residual(robot, q)
    is_open = [
        constraint.name in names and not np.abs(r[loop.rows]).max() <= tolerance
        for constraint, loop in zip(robot.constraints, find_loops(robot), strict=True)
    ]
    if any(is_open):
        openings = all_openings(robot, q)
        raise LockedOpen(tuple(found for found, stays in zip(openings, is_open, strict=True) if stays), tolerance)


def _free_indices(before: Robot, after: Robot) -> tuple[Indices, Indices]:
    """Indices of the coordinates and velocities of the new robot in those of the original one."""
    nq, nv = (7, 6) if after.mechanism.root == "floating" else (0, 0)
    idx_q, idx_v = list(range(nq)), list(range(nv))
    old = before.slots
    for name, new in sorted(after.slots.items(), key=lambda item: item[1].idx_q):
        idx_q += range(old[name].idx_q, old[name].idx_q + new.nq)
        idx_v += range(old[name].idx_v, old[name].idx_v + new.nv)
    return np.array(idx_q, dtype=np.intp), np.array(idx_v, dtype=np.intp)


class _LockedMechanism(NamedTuple):
    """A mechanism in which locked joints are fixed, and what was removed from it, as `LockedRobot` lists it."""

    mechanism: Mechanism
    joints: tuple[str, ...]
    constraints: tuple[str, ...]
    actuators: tuple[str, ...]
    configurations: tuple[str, ...]


def lock_joints(mechanism: Mechanism, joints: Iterable[str], coordinates: _Coordinates) -> _LockedMechanism:
    """Fix joints at given coordinates, as files have them.

    The placement of a locked joint becomes ``placement * joint.transform(c) * offset``, so the child link and
    the joint's frame stay in place. The function does not check that the removed constraints were met.
    """
    by_name = {joint.name: joint for joint in mechanism.joints}
    mimics = mechanism.leaders
    locked = _locked(by_name, joints, mimics)
    own = {name: _coordinates(by_name, name, coordinates, mimics) for name in locked}
    at = {name: by_name[name].transform(values) for name, values in own.items()}
    ordered = tuple(
        joint.fixed(joint.placement * at[joint.name] * joint.offset) if joint.name in at else joint
        for joint in mechanism.joints
    )
    rigid = rigid_roots(mechanism.bodies[0].name, ordered)
    single = {name: values[0] for name, values in own.items() if len(values) == 1}
    constant = {
        constraint.name
        for constraint in mechanism.constraints
        if len({rigid.get(end.body, WORLD) for end in constraint.anchors}) < 2 and at.keys() >= set(constraint.joints)
    }
    kept = {
        name: MappingProxyType({joint: values for joint, values in configuration.items() if joint not in at})
        for name, configuration in mechanism.configurations.items()
        if all(
            _near(pose, by_name[joint].transform(_coordinates(by_name, joint, configuration, mimics)))
            for joint, pose in at.items()
        )
    }
    return _LockedMechanism(
        replace(
            mechanism,
            joints=ordered,
            closures=tuple(closure for closure in mechanism.closures if closure.name not in constant),
            contacts=tuple(contact for contact in mechanism.contacts if contact.name not in constant),
            couplings=tuple(
                coupling.with_joints_locked(single) for coupling in mechanism.couplings if coupling.name not in constant
            ),
            actuators=tuple(name for name in mechanism.actuators if name not in at),
            motors=MappingProxyType({name: motor for name, motor in mechanism.motors.items() if name not in at}),
            configurations=MappingProxyType(kept),
        ),
        tuple(at),
        tuple(constraint.name for constraint in mechanism.constraints if constraint.name in constant),
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
    by_name: Mapping[str, Joint], name: str, coordinates: _Coordinates, mimics: Mapping[str, Mimic]
) -> Sequence[float]:
    if name in mimics:
        mimic = mimics[name]
        (leading,) = coordinates.get(mimic.joint, by_name[mimic.joint].type.neutral)
        return (mimic.multiplier * leading + mimic.offset,)
    return coordinates.get(name, by_name[name].type.neutral)


def _near(one: Pose, other: Pose) -> bool:
    apart = one.inverse() * other
    angle = 2.0 * math.atan2(math.hypot(*apart.quaternion[:3]), abs(apart.quaternion[3]))
    return math.hypot(*apart.xyz) <= _AGREEMENT and angle <= _AGREEMENT
