"""`eurdf.inverse_kinematics` of one pose of a frame against plain Newton on Pinocchio (`benchmarks/plain_newton.py`).

The frame's target is its pose with the motors 0.05 rad or 1 mm from an assembled configuration, where both start. Both
close the loops to 1e-10 and bring the frame within 1e-8 (m, rad). Only `eurdf` respects the joint limits. Times are
medians over targets; the frame is that of the link that the motors move best, in a chain the last one.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from functools import partial

import numpy as np
import pinocchio as pin

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.nearby import motors_nearby
from benchmarks.plain_newton import NotConverged, PlainNewton
from benchmarks.robots import ROBOTS, chains, robot_called
from benchmarks.table import Table, duration

COUNT = 8


def tables() -> Iterator[Table]:
    """One of all robots."""
    columns = ("robot", "frame", "eurdf", "without limits", "plain Newton", "ratio", "ratio without limits")
    yield Table(columns, [_row(name) for name in (*ROBOTS, "kangaroo_2legs", chains()[0])])


def _row(name: str) -> tuple[str, ...]:
    robot = robot_called(name)
    newton = PlainNewton(robot)
    q, positions = motors_nearby(robot, newton, COUNT)
    frame = robot.mechanism.bodies[-1].name if name in chains() else most_mobile_link(robot, q)
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
    medians = [duration(statistics.median(column)) for column in zip(*times, strict=True)]
    ratios = [f"{statistics.median(row[column] / row[2] for row in times):.2f}" for column in (0, 1)]
    return name, f"`{frame}`", *medians, *ratios


def most_mobile_link(robot: eurdf.Robot, q: np.ndarray) -> str:
    """The link that the actuators move best in position."""
    links = [body.name for body in robot.mechanism.bodies if not body.virtual]
    jacobians = [eurdf.actuated_jacobian(robot, name, q)[:3] for name in links]
    return links[int(np.argmax([np.linalg.svd(J, compute_uv=False)[-1] for J in jacobians]))]
