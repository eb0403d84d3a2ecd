"""Whether two robots with the same links move alike: poses along a random motion, accelerations, and times."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.array import Vector
from eurdf.errors import NotClosable, UndeterminedMotion
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.dynamics import forward_dynamics
from eurdf.kinematics.frame_jacobian import frame_jacobian
from eurdf.kinematics.project import project_configuration, project_velocity
from eurdf.kinematics.residual import residual, residual_and_jacobian
from eurdf.kinematics.tolerances import BRANCH
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.frames import body_frame_ids
from eurdf.pinocchio.robot import Robot
from eurdf.writing.rewriting import Positions

#: Configurations that are compared, and how far the joints move from each to the next, rad and m.
_CONFIGURATIONS, _STEP = 12, 0.2

#: Calls of which the fastest is taken.
_CALLS = 15


@dataclass(frozen=True, slots=True, repr=False)
class SameMotion:
    """How far two robots differ along a random motion.

    Attributes:
        configurations: How many were compared.
        pose: Largest difference of the pose of a link, m and rad.
        acceleration: Largest difference of the acceleration of a joint that both have, actuated ones among them,
            relative to 1 plus the largest acceleration there; None if a joint without inertia can move.
        times: Time of a call of `eurdf.forward_dynamics` of each robot, s, the least of several; None if it has none.
    """

    configurations: int
    pose: float
    acceleration: float | None
    times: tuple[float, float] | None

    def __str__(self) -> str:
        found = f"poses differ by {self.pose:.1g} m or rad at {self.configurations} configurations of a random motion"
        if self.acceleration is None:
            return f"{found}; accelerations are not compared, since a joint without inertia can move"
        return f"{found}, accelerations by {self.acceleration:.1g}"

    def __repr__(self) -> str:
        return f"<SameMotion: {self}>"


def compare_motion(
    before: Robot, after: Robot, converted: Callable[[Positions], Positions], without: Collection[str] = ()
) -> SameMotion:
    """Compare the motion of two robots, from a closed configuration on.

    The velocity of the second robot is the one at which its links have the twists of the first one's.

    Args:
        before: A robot.
        after: A robot with its links.
        converted: From the positions of its joints to those of the second robot.
        without: Names of links that are not compared.

    Raises:
        NotClosable: The loops of the first robot do not close.
        UndeterminedMotion: A joint without inertia can move in the second robot alone.
    """
    random = np.random.default_rng(0)
    start = assemble(before, tolerance=BRANCH)
    if not start.closes:
        raise NotClosable("no closed configuration was found", start.open, start.q)
    links = [body.name for body in before.mechanism.bodies if body.name not in without and not body.virtual]
    q, nv = start.q, before.model.nv
    pose = 0.0
    acceleration: float | None = 0.0
    calls = None
    for _ in range(_CONFIGURATIONS):
        v = project_velocity(before, q, random.uniform(-1.0, 1.0, nv))
        p = after.configuration(_own(after, converted(before.joint_positions(q, mimic=True))))
        pose = max(pose, float(np.abs(residual(after, p)).max(initial=0.0)), _apart(before, q, after, p, links))
        if acceleration is not None:
            u = random.uniform(-1.0, 1.0, len(before.actuation.idx_v))
            w = _velocity(before, q, v, after, p, links)
            calls = partial(forward_dynamics, before, q, v, u), partial(forward_dynamics, after, p, w, u)
            try:
                a = calls[0]().a
            except UndeterminedMotion:
                acceleration = calls = None
            else:
                acceleration = max(acceleration, _differing(before, a, after, calls[1]().a))
        try:
            q = project_configuration(before, before.tree.integrate(q, _STEP * v), tolerance=BRANCH)
        except NotClosable:  # the motion ends here: another one begins
            q = start.q
    return SameMotion(_CONFIGURATIONS, pose, acceleration, None if calls is None else _times(*calls))


def _own(robot: Robot, positions: Positions) -> Positions:
    """The positions of the joints that have coordinates."""
    return {name: values for name, values in positions.items() if name in robot.slots or name == ROOT_JOINT}


def _apart(before: Robot, q: Vector, after: Robot, p: Vector, links: Collection[str]) -> float:
    """Largest difference of poses of links, m and rad."""
    (one, poses), (other, others) = _poses(before, q), _poses(after, p)
    return max(float(np.abs(poses[one[link]].homogeneous - others[other[link]].homogeneous).max()) for link in links)


def _poses(robot: Robot, q: Vector) -> tuple[dict[str, int], Any]:
    """Index of the frame of each link, and the poses of all frames."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return body_frame_ids(robot.mechanism), data.oMf


def _velocity(before: Robot, q: Vector, v: Vector, after: Robot, p: Vector, links: Collection[str]) -> Vector:
    """The velocity of the second robot at which its links have the twists of the first one's."""
    J, K = (
        np.vstack([frame_jacobian(robot, at, link, pin.LOCAL_WORLD_ALIGNED) for link in links])
        for robot, at in ((before, q), (after, p))
    )
    closed = residual_and_jacobian(after, p)[1]  # for links that the first robot does not have
    twists = np.concatenate([J @ v, np.zeros(len(closed))])
    return np.asarray(np.linalg.lstsq(np.vstack([K, closed]), twists, rcond=None)[0])


def _differing(before: Robot, a: Vector, after: Robot, b: Vector) -> float:
    """Largest difference of the accelerations of joints that both robots have, relative to 1 plus the largest."""
    kinds = {(joint.name, joint.type, joint.parent) for joint in before.mechanism.joints}
    joints = (joint for joint in after.mechanism.joints if joint.name in after.slots)
    names = [joint.name for joint in joints if (joint.name, joint.type, joint.parent) in kinds]
    differences = [a[before.tree.velocities_of(name)] - b[after.tree.velocities_of(name)] for name in names]
    largest = float(np.abs(a).max(initial=0.0))
    return max((float(np.abs(each).max(initial=0.0)) for each in differences), default=0.0) / (1.0 + largest)


def _times(*calls: Callable[[], object]) -> tuple[float, float]:
    least = [float("inf")] * 2
    for _ in range(_CALLS):
        for index, call in enumerate(calls):
            begin = time.perf_counter()
            call()
            least[index] = min(least[index], time.perf_counter() - begin)
    return least[0], least[1]
