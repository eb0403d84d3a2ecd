"""`eurdf.residual_and_jacobian` against Pinocchio's own Jacobians, and `eurdf.dq_dq_actuated` against the toolbox.

Pinocchio computes neither log6 of the closures nor its derivative; with both in Python, it is the second peer. The
toolbox of Batto, De Matteïs and Mansard, 2025, takes the pseudoinverse of the columns of K that are not actuated.
"""

from __future__ import annotations

from functools import partial

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.nearby import ROBOTS
from benchmarks.plain_newton import PlainNewton


def main() -> None:
    """Print a table, of the least processor times, at an assembled configuration."""
    head = f"{'robot':18} {'r and K':>9} {'pin':>9} {'log6 too':>9} {'ratio':>6} {'ratio':>6}"
    print(f"{head}   {'dq_dq_act.':>10} {'formula':>9} {'ratio':>6}")
    for name in ROBOTS:
        robot = eurdf.load(name, geometry=False)
        newton, q = PlainNewton(robot), eurdf.assemble(robot).q
        calls = (
            partial(eurdf.residual_and_jacobian, robot, q),
            partial(newton.constraint_jacobian_alone, q),
            partial(newton.closures, q),
            partial(eurdf.dq_dq_actuated, robot, q),
            partial(newton.dq_dq_actuated, q),
        )
        K, alone, with_log6, D, formula = (1e6 * time for time in least_times(calls, 200))
        print(
            f"{name:18} {K:6.1f} µs {alone:6.1f} µs {with_log6:6.1f} µs {K / alone:6.2f} {K / with_log6:6.2f}   "
            f"{D:7.1f} µs {formula:6.1f} µs {D / formula:6.2f}"
        )
