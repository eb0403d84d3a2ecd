"""`eurdf.inverse_kinematics` of one pose of a frame against plain Newton on Pinocchio (`benchmarks/plain_newton.py`).

The frame's target is its pose with the motors 0.05 rad or 1 mm from an assembled configuration, where both start. Both
close the loops to 1e-10 and bring the frame within 1e-8 (m, rad). Only `eurdf` respects the joint limits.
"""

from __future__ import annotations

import statistics
from functools import partial

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.nearby import ROBOTS, motors_nearby
from benchmarks.plain_newton import NotConverged, PlainNewton

COUNT = 8


def main() -> None:
    """Print a table; times are medians over targets of the least processor time."""
    head = f"{'robot':18} {'frame':28} {'targets':>7} {'eurdf':>9} {'no limits':>9} {'Newton':>9}"
    print(f"{head} {'ratio':>6} {'ratio':>6}")
    for name in ROBOTS:
        robot = eurdf.load(name, geometry=False)
        newton = PlainNewton(robot)
        q, positions = motors_nearby(robot, newton, COUNT)
        frame = most_mobile_link(robot, q)
        index, times = robot.model.getFrameId(frame), []
        for values in positions:
            there = eurdf.forward_kinematics(robot, values, q)
            pin.framesForwardKinematics(robot.model, newton.data, there)
            target = pin.SE3(newton.data.oMf[index])
            try:
                newton.inverse_kinematics(index, target, q)
            except NotConverged:
                continue
            if eurdf.inverse_kinematics(robot, {frame: target}, q).converged:
                ours = partial(eurdf.inverse_kinematics, robot, {frame: target}, q)
                peer = partial(newton.inverse_kinematics, index, target, q)
                times.append(least_times((ours, partial(ours, limits=False), peer)))
        within, free, theirs = (1e3 * statistics.median(column) for column in zip(*times, strict=True))
        ratios = [statistics.median(row[column] / row[2] for row in times) for column in (0, 1)]
        print(
            f"{name:18} {frame:28} {len(times):7} {within:6.2f} ms {free:6.2f} ms {theirs:6.2f} ms "
            f"{ratios[0]:6.2f} {ratios[1]:6.2f}"
        )


def most_mobile_link(robot: eurdf.Robot, q: np.ndarray) -> str:
    """The link that the actuators move best in position."""
    links = [body.name for body in robot.mechanism.bodies if not body.virtual]
    jacobians = [eurdf.actuated_jacobian(robot, q, name)[:3] for name in links]
    return links[int(np.argmax([np.linalg.svd(J, compute_uv=False)[-1] for J in jacobians]))]
