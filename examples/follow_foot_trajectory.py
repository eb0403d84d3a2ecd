"""Leads the foot of Digit along an ellipse, by inverse kinematics that keeps the loops closed and the limits.

Run as ``python examples/follow_foot_trajectory.py [FOLDER]``: it writes the angles of the motors to
``foot_trajectory.csv``.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf

Array = npt.NDArray[np.float64]

PERIOD = 1.0  # s
SAMPLES = 100  # in a period
FORWARD = 0.15  # m, half the length of a step
UPWARD = 0.08  # m, half the height of it


class Followed(NamedTuple):
    """A motion of the leg, its start and its end the same.

    Attributes:
        robot: The robot.
        t: Times (n + 1,), s.
        q: Configurations (n + 1, nq).
        wanted: Positions of the ankle (n + 1, 3), m, that were wanted. The sole is to stay level.
        error: How far the foot is from where it is wanted, at most, m or rad.
    """

    robot: eurdf.Robot
    t: Array
    q: Array
    wanted: Array
    error: float


def main(folder: Path | None = None) -> Followed:
    """Find the motion; with a folder, write the angles of the motors into it."""
    robot = eurdf.load("digit_leg")
    q = robot.configurations["assembled"]
    pin.forwardKinematics(robot.model, robot.data, q)
    foot = pin.updateFramePlacement(robot.model, robot.data, robot.model.getFrameId("foot"))

    # From its start the foot moves back and up, to the front, and down again.
    t = np.linspace(0.0, PERIOD, SAMPLES + 1)
    angle = 2.0 * np.pi * t / PERIOD
    offset = np.column_stack([-FORWARD * np.sin(angle), np.zeros_like(t), UPWARD * (1.0 - np.cos(angle))])
    wanted = foot.translation + offset

    found, error = [], 0.0
    for position in wanted:
        solution = eurdf.inverse_kinematics(robot, {"foot": pin.SE3(foot.rotation, position)}, q)
        if not solution.converged:
            raise ValueError(f"the foot cannot get to {position}: {solution.errors[0]}")
        q = solution.q  # where the next one starts, so that the motion has no jumps
        found.append(q)
        error = max(error, solution.errors[0].position, solution.errors[0].angle)

    followed = Followed(robot, t, np.array(found), wanted, error)
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        write(followed, folder / "foot_trajectory.csv")
    return followed


def write(followed: Followed, path: Path) -> None:
    """Write times, s, and angles of the motors, rad, as a table."""
    actuation = followed.robot.actuation
    table = np.column_stack([followed.t, followed.q[:, actuation.idx_q]])
    np.savetxt(path, table, fmt="%.9f", delimiter=",", header=",".join(["t", *actuation.joints]), comments="")


if __name__ == "__main__":
    target = Path(sys.argv[1]) if sys.argv[1:] else Path()
    result = main(target)
    largest = np.degrees(np.abs(np.diff(result.q[:, result.robot.actuation.idx_q], axis=0)).max())
    opening = max(np.abs(eurdf.residual(result.robot, q)).max() for q in result.q)
    print(f"error of the foot     {result.error:.1e} m or rad at most")
    print(f"closures open by      {opening:.1e} m or rad at most")
    print(f"a motor turns by      {largest:.2f} degrees between two samples at most")
    print(f"written: {target / 'foot_trajectory.csv'}")
