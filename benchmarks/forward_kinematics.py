"""`eurdf.forward_kinematics` of one configuration against plain Newton on Pinocchio (`benchmarks/plain_newton.py`).

The motors are 0.05 rad or 1 mm from an assembled configuration, where both start. Both close the loops to 1e-10, which
the largest residuals (m, rad) show; times are medians over motor positions. In a chain of four-bars, plain Newton would
need a `pin.Data` of the whole robot, which takes 64 nv³ bytes; there it solves one four-bar, N times. The last column
is what the first call, which prepares the loops, adds to the memory of the process.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from functools import partial

import numpy as np

import eurdf
from benchmarks.interleaved import least_times, peak_memory
from benchmarks.nearby import ANGLE, motors_nearby
from benchmarks.plain_newton import PlainNewton
from benchmarks.robots import CHAINS, ROBOTS, chain, robot_called
from benchmarks.table import Table, duration, ratio

COUNT = 8


def tables() -> Iterator[Table]:
    """Of single robots and of chains."""
    yield Table(
        ("robot", "nv", "eurdf", "plain Newton", "ratio", "residual", "of Newton"), [_row(name) for name in ROBOTS]
    )
    yield Table(
        ("chain of N four-bars", "eurdf, per loop", "plain Newton", "ratio", "residual", "memory"),
        [_chain_row(count) for count in CHAINS],
    )


def _row(name: str) -> tuple[str, ...]:
    robot = robot_called(name)
    newton = PlainNewton(robot)
    q, positions = motors_nearby(robot, newton, COUNT)
    times, residuals = [], [0.0, 0.0]
    for values in positions:
        calls = (
            partial(eurdf.forward_kinematics, robot, values, q),
            partial(newton.forward_kinematics, values, q),
        )
        times.append(least_times(calls, seconds=0.1))
        found = [float(np.abs(eurdf.residual(robot, call())).max()) for call in calls]
        residuals = [max(pair) for pair in zip(residuals, found, strict=True)]
    if not times:
        return name, str(robot.model.nv), *["-"] * 5
    ours, peer = (statistics.median(column) for column in zip(*times, strict=True))
    relative = statistics.median(own / other for own, other in times)
    shown = [f"{residual:.0e}" for residual in residuals]
    return name, str(robot.model.nv), duration(ours), duration(peer), f"{relative:.2f}", *shown


def _chain_row(count: int) -> tuple[str, ...]:
    robot, one = chain(count), chain(1)
    newton, q, q_one = PlainNewton(one), eurdf.assemble(robot).q, eurdf.assemble(one).q
    before = peak_memory()
    move = partial(eurdf.forward_kinematics, robot, q[robot.actuation.idx_q] + ANGLE, q)
    residual = float(np.abs(eurdf.residual(robot, move())).max())
    grown = peak_memory() - before
    peer = partial(newton.forward_kinematics, q_one[one.actuation.idx_q] + ANGLE, q_one)
    ours, alone = least_times((move, peer), 5)
    each = ours / count
    return str(count), duration(each), duration(alone), ratio(each, alone), f"{residual:.0e}", f"{grown:.0f} MB"
