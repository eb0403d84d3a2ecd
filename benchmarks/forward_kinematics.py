"""`eurdf.forward_kinematics` of one configuration against plain Newton on Pinocchio (`benchmarks/plain_newton.py`).

The motors are 0.05 rad or 1 mm from an assembled configuration, where both start. Both close the loops to 1e-10.
"""

from __future__ import annotations

import statistics
from functools import partial

import numpy as np

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.nearby import ROBOTS, motors_nearby
from benchmarks.plain_newton import PlainNewton

COUNT = 8


def main() -> None:
    """Print a table; times are medians over motor positions of the least processor time."""
    print(f"{'robot':18} {'nv':>4} {'eurdf':>9} {'Newton':>9} {'ratio':>6}   residuals")
    for name in ROBOTS:
        robot = eurdf.load(name, geometry=False)
        newton = PlainNewton(robot)
        q, positions = motors_nearby(robot, newton, COUNT)
        times, residuals = [], [0.0, 0.0]
        for values in positions:
            calls = (
                partial(eurdf.forward_kinematics, robot, values, q),
                partial(newton.forward_kinematics, values, q),
            )
            times.append(least_times(calls))
            found = [float(np.abs(eurdf.residual(robot, call())).max()) for call in calls]
            residuals = [max(pair) for pair in zip(residuals, found, strict=True)]
        ours, theirs = (1e3 * statistics.median(column) for column in zip(*times, strict=True))
        ratio = statistics.median(own / peer for own, peer in times)
        shown = f"{residuals[0]:.0e} {residuals[1]:.0e}"
        print(f"{name:18} {robot.model.nv:4} {ours:6.2f} ms {theirs:6.2f} ms {ratio:6.2f}   {shown}")
