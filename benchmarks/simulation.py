"""`eurdf.simulate` against MuJoCo's RK4 on the same robots, from the same state, with the same step.

MuJoCo simulates the MJCF that `eurdf.export` writes, whose closures are soft constraints, as stiff as the step allows.
Gravity and springs act, and nothing else; joints move by up to 0.5 rad/s or m/s at first. Twenty steps of 1 ms are
simulated; then the loops are open by what the table states (m, rad). A step of four evaluations and a projection is
also compared with one `eurdf.forward_dynamics`. Robots of fewer than 20 velocities have no goal to MuJoCo: they take
what the calls from Python take.

The floor is what the calls of Pinocchio take: four of its solver, three to five Jacobians, an inverse dynamics,
integrations and energies. In a step of five_bar they take 23 µs, twice what MuJoCo takes for all of it; 60 to 100
calls of NumPy on small arrays, 0.3 to 1 µs each, and 120 to 170 of Python take the rest. With distances, couplings or
redundant rows, each of the four evaluations also needs M⁻¹ and a Jacobian: in a step of tello and toddlerbot_2legs, the
calls of Pinocchio alone take 2.6 and 2.8 times what MuJoCo takes for all of it.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from functools import partial

import numpy as np

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.mujoco_model import MuJoCoRobot
from benchmarks.robots import ROBOTS, robot_called
from benchmarks.table import Goal, Table, duration, ratio

STEP, STEPS = 1e-3, 20

_MUJOCO, _DYNAMICS = Goal(5.0), Goal(8.0)
_FEWEST = 20  # velocities of a robot for which MuJoCo is a goal


def tables() -> Iterator[Table]:
    """One of all robots."""
    times = "robot", "nv", "eurdf, per step", "MuJoCo", _MUJOCO.of("to MuJoCo"), _DYNAMICS.of("to dynamics")
    columns = (*times, "loops open by", "of MuJoCo", "relative energy error")
    yield Table(columns, [_row(name) for name in (*ROBOTS, "10 four-bars", "30 four-bars")])


def _row(name: str) -> tuple[str, ...]:
    robot = robot_called(name)
    q, nv = eurdf.assemble(robot).q, robot.model.nv
    v = eurdf.project_velocity(robot, q, np.random.default_rng(0).normal(size=nv))
    v *= 0.5 / np.abs(v).max()
    peer = MuJoCoRobot(robot, STEP)
    peer.move(q, v)
    simulate = partial(eurdf.simulate, robot, q, v, duration=STEPS * STEP, step=STEP)
    dynamics = partial(eurdf.forward_dynamics, robot, q, v)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", eurdf.errors.StepTooLongWarning)
        motion = simulate()
        peer.step(STEPS)
        is_open = max(np.abs(eurdf.residual(robot, each)).max() for each in motion.q)
        openings = f"{is_open:.0e}", f"{peer.opening:.0e}"
        ours, other, one = least_times((simulate, partial(peer.step, STEPS), lambda: [dynamics() for _ in range(20)]))
    ours, other, one = ours / STEPS, other / STEPS, one / 20
    judged = _MUJOCO.cell(ours, other) if nv >= _FEWEST else ratio(ours, other)
    energy = f"{motion.energy_error / motion.energy_exchanged:.0e}" if motion.energy_exchanged > 0.0 else "-"
    return name, str(nv), duration(ours), duration(other), judged, _DYNAMICS.cell(ours, one), *openings, energy
