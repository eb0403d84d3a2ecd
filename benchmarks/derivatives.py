"""`eurdf.residual_and_jacobian` against Pinocchio, and `eurdf.kinematics.dq_dq_actuated` against the toolbox.

Pinocchio computes neither log₆ of the closures nor its derivative; with both in Python, it is the second peer. The
toolbox of Batto, De Matteïs and Mansard, 2025, takes the pseudoinverse of the columns of K that are not actuated. All
are at an assembled configuration. In a chain of four-bars, the peer evaluates one four-bar, N times; K of the whole
chain has 9 N² numbers.

Then `eurdf.dynamics_derivatives` against `eurdf.forward_dynamics`, whose derivatives by one-sided differences take
2 nv + nu + 1 calls, and against `pin.constraintDynamics` with its derivatives, which are wrong for 3d closures. The
time in a batch is that of one of 100 states.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

import eurdf
from benchmarks.dynamics import Peers, states
from benchmarks.interleaved import least_times
from benchmarks.plain_newton import PlainNewton
from benchmarks.robots import CHAINS, ROBOTS, chain, chains, robot_called
from benchmarks.table import Goal, Table, duration, ratio

_DYNAMICS = Goal(15.0)
_BATCH = 100


def tables() -> Iterator[Table]:
    """Of single robots and of chains."""
    yield Table(
        ("robot", "r and K", "pin", "with log₆", "ratio", "to log₆", "`dq_dq_actuated`", "formula", "ratio of these"),
        [_row(name) for name in (*ROBOTS, chains()[0])],
    )
    yield Table(
        (
            "robot",
            "derivatives",
            "dynamics",
            _DYNAMICS.of("ratio"),
            "by differences",
            "in a batch",
            "pin",
            "ratio to pin",
        ),
        [_dynamics_row(name) for name in ROBOTS],
        "Derivatives of forward dynamics",
    )
    yield Table(
        ("chain of N four-bars", "r and K, per loop", "with log₆", "ratio"),
        [_chain_row(count) for count in CHAINS],
    )


def _row(name: str) -> tuple[str, ...]:
    robot = robot_called(name)
    newton, q = PlainNewton(robot), eurdf.assemble(robot).q
    calls = (
        partial(eurdf.residual_and_jacobian, robot, q),
        partial(newton.constraint_jacobian_alone, q),
        partial(newton.closures, q),
        partial(eurdf.kinematics.dq_dq_actuated, robot, q),
        partial(newton.dq_dq_actuated, q),
    )
    K, alone, with_log6, D, formula = least_times(calls, 200)
    of_K = duration(K), duration(alone), duration(with_log6), ratio(K, alone), ratio(K, with_log6)
    return name, *of_K, duration(D), duration(formula), ratio(D, formula)


def _dynamics_row(name: str) -> tuple[str, ...]:
    robot = robot_called(name)
    ((q, v),), nu = states(robot, 1), len(robot.actuation.idx_v)
    many = np.tile(q, (_BATCH, 1)), np.tile(v, (_BATCH, 1))
    calls: list[partial[Any]] = [
        partial(function, robot, q, v) for function in (eurdf.dynamics_derivatives, eurdf.forward_dynamics)
    ]
    calls.append(partial(eurdf.batch.dynamics_derivatives, robot, *many))
    try:
        peers = Peers(robot)
        calls.append(partial(peers.derivatives, q, v, np.zeros(nu), eurdf.springs.spring_force(robot, q)))
    except eurdf.errors.NoConstraintModel:
        pass
    ours, dynamics, batch, *peer = least_times(calls, 30)
    differences = (2 * robot.tree.nv + nu + 1) * dynamics
    to_pin = [duration(peer[0]), ratio(ours, peer[0])] if peer else ["-", "-"]
    each = duration(ours), duration(dynamics), _DYNAMICS.cell(ours, dynamics), duration(differences)
    return name, *each, duration(batch / _BATCH), *to_pin


def _chain_row(count: int) -> tuple[str, ...]:
    robot, one = chain(count), chain(1)
    q, newton, q_one = eurdf.assemble(robot).q, PlainNewton(one), eurdf.assemble(one).q
    ours, alone = least_times((partial(eurdf.residual_and_jacobian, robot, q), partial(newton.closures, q_one)), 5)
    return str(count), duration(ours / count), duration(alone), ratio(ours / count, alone)
