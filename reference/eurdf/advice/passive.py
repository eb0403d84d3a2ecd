"""Motions that need no actuator: those of a rod that spins about its own line, of a wheel, of the root."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.analysis import LoopAnalysis, Motion
from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.residual import jacobian_along
from eurdf.kinematics.scale import characteristic_length

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# By how much lines that count as one may differ, in rad and characteristic lengths: the numbers in files are rounded.
_SAME_LINE = 1e-3

# How far the centre of mass of a wheel may be from its axis, in radii of gyration.
_CENTRED = 0.02

_ROOT_JOINTS = frozenset({"JointModelFreeFlyer", "JointModelPlanar"})


def without_spins(robot: Robot, loop: LoopAnalysis) -> list[Motion]:
    """The uncontrolled motions of a group of loops, but for those of rods that spin about their own lines.

    A spin is a motion by which all bodies that move turn about one fixed line: their twists, seen from a point of the
    line, are multiples of one that only turns.
    """
    if not loop.motions:
        return []
    q = loop.motions[0].q
    _, J = jacobian_along(robot, q)
    length = characteristic_length(robot)
    return [motion for motion in loop.motions if not _turns_about_one_line(_twists(robot, J, motion), length)]


def needs_no_actuator(robot: Robot, motion: Motion) -> bool:
    """Whether a motion outside of the loops is one of a floating or planar root, or of a wheel.

    A wheel is what a hinge carries at the end of the tree with its centre of mass on the axis.
    """
    model = robot.model
    (velocity,) = motion.velocities.tolist()
    joint = max(j for j in range(1, model.njoints) if model.nvs[j] and model.idx_vs[j] <= velocity)
    if model.nvs[joint] > 1:
        return bool(model.parents[joint] == 0 and model.joints[joint].shortname() in _ROOT_JOINTS)
    if joint in model.parents.tolist():
        return False
    joint_model, inertia = model.joints[joint], model.inertias[joint]
    data = joint_model.createData()
    joint_model.calc(data, motion.q)
    axis = data.S.reshape(6)[3:]
    if data.S.reshape(6)[:3].any() or not inertia.mass > 0.0:
        return False
    radius = np.sqrt(np.trace(inertia.inertia) / (2.0 * inertia.mass))
    return bool(np.linalg.norm(np.cross(axis, inertia.lever)) <= _CENTRED * radius)


def _twists(robot: Robot, J: Matrix, motion: Motion) -> list[Vector]:
    """Twists (6,) in the world, linear and angular, of the bodies of the joints that a motion moves.

    Bodies further out move as one of these does.

    Args:
        robot: The robot.
        J: World Jacobian (6, nvExtended) at the configuration of the motion.
        motion: A motion of loops.
    """
    model = robot.model
    velocity = dict(zip(motion.velocities.tolist(), motion.values.tolist(), strict=True))
    twists: dict[int, Vector] = {}
    for joint in range(1, model.njoints):  # a parent has a lower index than its child
        first, column = model.idx_vs[joint], model.idx_vExtendeds[joint]
        own = [velocity.get(first + k, 0.0) for k in range(model.nvExtendeds[joint])]
        if any(own):
            above = model.parents[joint]
            while above and above not in twists:
                above = model.parents[above]
            twists[joint] = twists.get(above, np.zeros(6)) + J[:, column : column + len(own)] @ np.array(own)
    return list(twists.values())


def _turns_about_one_line(twists: list[Vector], length: float) -> bool:
    """Whether twists are such, but for those of bodies that stay where they are.

    Args:
        twists: Of bodies, each (6,), linear and angular, rad/s and m/s; the velocities that they come from are about 1.
        length: Characteristic length, m.
    """
    turning, axis, point = 0.0, np.zeros(3), np.zeros(3)
    for twist in twists:
        speed = float(np.linalg.norm(twist[3:]))
        if speed > turning:
            turning, axis = speed, twist[3:] / speed
            point = np.cross(axis, twist[:3]) / speed  # of the line, the nearest to the origin of the world
    bound = _SAME_LINE * max(turning, _SAME_LINE)
    return all(
        np.linalg.norm(np.cross(axis, twist[3:])) <= bound
        and np.linalg.norm(twist[:3] + np.cross(twist[3:], point)) <= bound * length
        for twist in twists
    )
