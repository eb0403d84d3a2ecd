"""Leads the foot of Digit to a target with Pink, one quadratic program a step, with the loops as hard equalities.

Run as ``python examples/reach_with_pink.py [SOLVER]``; the solver is one of those that ``qpsolvers`` finds.
"""

from __future__ import annotations

import sys
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from pink import Configuration, solve_ik
from pink.tasks import FrameTask

import eurdf
from eurdf.pink import ClosureTask

STEP = 0.02  # s
STEPS = 50  # while the target moves
AFTERWARDS = 5  # steps while the target is at rest
OFFSET = np.array([0.1, 0.02, 0.1])  # m, of the target from the start
WEIGHT = 10.0  # 1/m and 1/rad

#: Of solvers that stop far above rounding.
SETTINGS = {"clarabel": {"tol_gap_abs": 1e-12, "tol_gap_rel": 1e-12, "tol_feas": 1e-12}}


class Reached(NamedTuple):
    """How well the foot has followed.

    Attributes:
        error: How far the foot is from its target at the end, m or rad.
        opening: The same of the loops.
        opening_on_the_way: The largest opening after a step, m or rad.
    """

    error: float
    opening: float
    opening_on_the_way: float


def main(solver: str = "daqp") -> Reached:
    """Move the foot, within the limits of position and velocity of the URDF."""
    robot = eurdf.load("digit_leg")
    configuration = Configuration(robot.model, robot.data, robot.configurations["assembled"])
    start = configuration.get_transform_frame_to_world("foot")
    foot, loops = FrameTask("foot", WEIGHT, WEIGHT), ClosureTask(robot)
    openings = []
    for step in range(1, STEPS + AFTERWARDS + 1):
        foot.set_target(pin.SE3(start.rotation, start.translation + min(step / STEPS, 1.0) * OFFSET))
        v = solve_ik(configuration, [foot], STEP, solver, damping=1e-6, constraints=[loops], **SETTINGS.get(solver, {}))
        configuration.integrate_inplace(v, STEP)
        openings.append(float(np.abs(eurdf.residual(robot, configuration.q)).max()))
    return Reached(float(np.abs(foot.compute_error(configuration)).max()), openings[-1], max(openings))


if __name__ == "__main__":
    reached = main(*sys.argv[1:])
    print(f"error of the foot   {reached.error:.1e} m or rad")
    print(f"loops open by       {reached.opening:.1e} m or rad, {reached.opening_on_the_way:.1e} on the way")
