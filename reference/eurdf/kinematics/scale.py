"""Scaling of lengths and angles to one unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Vector
from eurdf.closures.coupling import Couplings
from eurdf.kinematics.loop import find_loops, joints_of_loops
from eurdf.mechanism.constraint import Coupling
from eurdf.pinocchio.ancestry import Ancestry

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def characteristic_length(robot: Robot) -> float:
    """Reach of the robot's longest loop: half the sum of the distances from joint to joint around it, m.

    1 m for loops without extent, such as a spherical linkage whose joints are all at one point.
    """
    longest, tree = 0.0, robot.tree
    ancestry = Ancestry(tree.parents)
    sums = ancestry.sums(tree.reach)
    for loop, constraint in zip(find_loops(robot), robot.constraints, strict=True):
        if constraint.anchors:  # what relates coordinates has no extent
            around = sum(tree.distance_of(anchor) for anchor in constraint.anchors)
            for chain in loop.chains:
                around += ancestry.sum_to(chain.joint, chain.above, tree.reach, sums)
            longest = max(longest, around)
    return longest / 2.0 if longest > 1e-9 else 1.0


def row_scale(robot: Robot, length: float) -> Vector:
    """Factors (nc,) that make the rows of the residual dimensionless: 1/length for those in m, 1 for those in rad."""
    factor = {"m": 1.0 / length, "rad": 1.0}
    rows: list[float] = []
    for each in robot.constraints:
        if isinstance(each, Coupling):
            couplings = Couplings([each], robot.tree.coordinate, np.empty(0, np.intp))
            rows += couplings.scale(length).tolist()
        else:
            rows += [factor[unit] for unit in each.units]
    return np.array(rows)


def velocity_scale(robot: Robot, length: float) -> Vector:
    """Unit (nv,) of each velocity of the loops: the length if it only translates (m/s), else 1 (rad/s)."""
    tree = robot.tree
    scale = np.ones(tree.nv)
    # A mimic joint moves with the velocity of its leader.
    moving = {velocity for joint in joints_of_loops(robot) for velocity in tree.moving_velocities[joint]}
    for joint, own in enumerate(tree.own_velocities):
        if len(own) and own[0] in moving:
            scale[np.array(own)[tree.translates(joint)]] = length
    return scale
