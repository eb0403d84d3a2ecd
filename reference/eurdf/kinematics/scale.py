"""Scaling of lengths and angles to one unit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from eurdf.kinematics.ancestry import Ancestry
from eurdf.kinematics.array import Vector
from eurdf.kinematics.loop import find_loops, joints_of_loops

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def characteristic_length(robot: Robot) -> float:
    """Reach of the robot's longest loop: half the sum of the distances from joint to joint around it, m.

    1 m for loops without extent, such as a spherical linkage whose joints are all at one point.
    """
    longest = 0.0
    ancestry = Ancestry(robot.model.parents.tolist())
    reach = [math.hypot(*placement.translation) for placement in robot.model.jointPlacements]
    sums = ancestry.sums(reach)
    for loop, constraint in zip(find_loops(robot), robot.constraint_models, strict=True):
        around = math.hypot(*constraint.joint1_placement.translation)
        around += math.hypot(*constraint.joint2_placement.translation)
        for joint in (loop.joint_a, loop.joint_b):
            around += ancestry.sum_to(joint, loop.common, reach, sums)
        longest = max(longest, around)
    return longest / 2.0 if longest > 1e-9 else 1.0


def row_scale(robot: Robot, length: float) -> Vector:
    """Factors (nc,) that make the rows of the residual dimensionless: 1/length for those in m, 1 for those in rad."""
    scales = [(1.0 / length,) * 3 + (1.0,) * (3 if loop.spatial else 0) for loop in find_loops(robot)]
    return np.array([factor for row in scales for factor in row])


def velocity_scale(robot: Robot, length: float) -> Vector:
    """Unit (nv,) of each velocity of the loops: the length if it only translates (m/s), else 1 (rad/s)."""
    model = robot.model
    scale, neutral = np.ones(model.nv), pin.neutral(model)
    first_velocity = model.idx_vs.tolist()
    # A mimic joint moves with the velocity of its leader.
    moving = {first_velocity[joint] for joint in joints_of_loops(find_loops(robot), model.parents.tolist())}
    for joint, (first, width) in enumerate(zip(first_velocity, model.nvs, strict=True)):
        if width == 0 or first not in moving:
            continue
        joint_model = model.joints[joint]
        joint_data = joint_model.createData()
        joint_model.calc(joint_data, neutral)
        translates = ~joint_data.S.reshape(6, -1)[3:].any(axis=0)
        scale[first : first + width][translates] = length
    return scale
