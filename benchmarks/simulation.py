"""`eurdf.simulate` against MuJoCo's RK4 on the same robots, from the same state, with the same step.

MuJoCo has closures as soft constraints (`connect`, `weld`) with its default options; its loops open by micrometres
where ours are closed to rounding. Gravity acts, and nothing else.
"""

from __future__ import annotations

import warnings

import mujoco
import numpy as np

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.mujoco_model import move, mujoco_model

ROBOTS = ("digit_leg", "digit_2legs", "kangaroo_leg", "stewart_platform", "cassie_leg", "five_bar", "four_bar")
STEP, STEPS = 1e-3, 20


def main() -> None:
    """Print a table, of the least processor times for a step."""
    print(f"{'robot':18} {'nv':>4} {'eurdf':>9} {'MuJoCo':>9} {'ratio':>6} {'open':>9} {'energy error':>13}")
    for name in ROBOTS:
        robot = eurdf.load(name, geometry=False)
        q, v = eurdf.assemble(robot).q, np.zeros(robot.model.nv)
        model, data = mujoco_model(robot, STEP)
        move(robot, model, data, q, v)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", eurdf.StepTooLongWarning)
            motion = eurdf.simulate(robot, q, v, duration=STEPS * STEP, step=STEP)
            ours, peer = least_times(
                (
                    lambda r=robot, q=q, v=v: eurdf.simulate(r, q, v, duration=STEPS * STEP, step=STEP),  # type: ignore[misc]
                    lambda m=model, d=data: mujoco.mj_step(m, d, STEPS),  # type: ignore[misc]
                ),
                10,
            )
        is_open = max(np.abs(eurdf.residual(robot, each)).max() for each in motion.q)
        error = motion.energy_error / motion.energy_exchanged
        times = f"{ours / STEPS * 1e6:6.0f} µs {peer / STEPS * 1e6:6.0f} µs {ours / peer:6.1f}"
        print(f"{name:18} {robot.model.nv:4} {times} {is_open:9.1e} {error:13.1e}")
