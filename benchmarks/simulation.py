"""`eurdf.simulate` against MuJoCo's RK4 on the same robots, from the same state, with the same step.

MuJoCo has closures as soft constraints (`connect`, `weld`) with its default options; its loops open by micrometres
where ours are closed to rounding (m, rad). Gravity and springs act, and nothing else; the chain of four-bars is
horizontal, and its bars turn at first, so that it exchanges no energy. Twenty steps of 1 ms are simulated.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from functools import partial

import mujoco
import numpy as np

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.mujoco_model import move, mujoco_model
from benchmarks.robots import ROBOTS, chains, robot_called
from benchmarks.table import Table, duration, ratio

STEP, STEPS = 1e-3, 20


def tables() -> Iterator[Table]:
    """One of all robots."""
    columns = ("robot", "nv", "eurdf, per step", "MuJoCo", "ratio", "loops open by", "relative energy error")
    yield Table(columns, [_row(name) for name in (*ROBOTS, "five_bar", "four_bar", chains()[0])])


def _row(name: str) -> tuple[str, ...]:
    robot = robot_called(name)
    q, v = eurdf.assemble(robot).q, np.zeros(robot.model.nv)
    if name in chains():
        v = eurdf.project_velocity(robot, q, np.ones(robot.model.nv))
    model, data = mujoco_model(robot, STEP)
    move(robot, model, data, q, v)
    simulate = partial(eurdf.simulate, robot, q, v, duration=STEPS * STEP, step=STEP)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", eurdf.errors.StepTooLongWarning)
        motion = simulate()
        times = least_times((simulate, partial(mujoco.mj_step, model, data, STEPS)), 10)
    ours, peer = (taken / STEPS for taken in times)
    is_open = max(np.abs(eurdf.residual(robot, each)).max() for each in motion.q)
    exchanges = name not in chains()
    errors = f"{is_open:.0e}", f"{motion.energy_error / motion.energy_exchanged:.0e}" if exchanges else "-"
    return name, str(robot.model.nv), duration(ours), duration(peer), ratio(ours, peer), *errors
