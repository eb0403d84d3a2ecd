"""A configuration that shows where the loops of a robot are cut: its closures are open, all by the same distance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eurdf.array import Vector
from eurdf.closures.point import PointClosure
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tolerances import CLOSED
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import Robot


def opened(robot: Robot, q: Vector, gap: float) -> Vector:
    """A configuration (nq,) of the spanning tree in which the frames of each closure are apart.

    Frame B of each closure is moved in the direction in which the passive joints move it most easily, or farther away
    where it has a distance, and the joints follow; the actuators keep their positions. All gaps are half as large, or a
    quarter, if the joints reach no more; where closures depend on one another, they differ.

    Args:
        robot: The robot.
        q: Its configuration (nq,), closed.
        gap: How far apart, m.
    """
    points = [PointClosure(closure.name, closure.a, closure.b) for closure in robot.mechanism.closures]
    r, K = residual_and_jacobian(_with(robot, points), q)
    passive = np.setdiff1d(np.arange(robot.model.nv), robot.actuation.idx_v)
    places, directions = r[: 3 * len(points)].reshape(-1, 3), []
    for place, rows in zip(places, K[: 3 * len(points), passive].reshape(len(points), 3, -1), strict=True):
        distance = np.linalg.norm(place)
        directions.append(np.linalg.svd(rows)[0][:, 0] if distance <= CLOSED else place / distance)
    for part in (1.0, 0.5, 0.25):
        apart = places + part * gap * np.array(directions)
        moved = [
            replace(point, a=replace(point.a, pose=point.a.pose * Pose(tuple(away))))
            for point, away in zip(points, apart.tolist(), strict=True)
        ]
        found = assemble(_with(robot, moved), q, hold=robot.actuation.joints, restarts=0)
        if found.closes:
            break
    return found.q


def _with(robot: Robot, points: list[PointClosure]) -> Robot:
    return Robot(replace(robot.mechanism, closures=tuple(points)), robot.model)
