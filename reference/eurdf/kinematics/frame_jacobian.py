"""The Jacobian of a frame in the spanning tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pinocchio import LOCAL, LOCAL_WORLD_ALIGNED, WORLD

from eurdf.closures.se3 import skew
from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.derived import borrowed
from eurdf.kinematics.evaluate import Frames, frames

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def frame_jacobian(robot: Robot, q: Vector, frame: str, reference: Any) -> Matrix:
    """The derivative (6, nv) of a frame's motion by the velocities: linear, then angular rows.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        frame: Name of a link, a joint (its frame on the child side), or a frame of the description.
        reference: The axes of the twist: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.

    Raises:
        ValueError: The frame is unknown or ambiguous, or ``reference`` is none of the three.
    """
    with borrowed(robot, _frame, frame) as frames_:
        at = frames_.at(q[None])
        J: Matrix = frames_.jacobians(at)[0, 0]
        ((R,),), ((p,),) = frames_.poses(at)
    if reference == LOCAL_WORLD_ALIGNED:
        return J
    if reference == LOCAL:
        return np.concatenate((R.T @ J[:3], R.T @ J[3:]))
    if reference == WORLD:
        return np.concatenate((J[:3] + skew(p) @ J[3:], J[3:]))
    raise ValueError(f"reference is {reference!r}; expected pin.LOCAL, pin.WORLD or pin.LOCAL_WORLD_ALIGNED")


def _frame(robot: Robot, name: str) -> Frames:
    return frames(robot, [name], few=True)
