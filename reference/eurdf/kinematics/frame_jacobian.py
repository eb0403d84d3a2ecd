"""The Jacobian of a frame in the spanning tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pinocchio import LOCAL, LOCAL_WORLD_ALIGNED, WORLD

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.derived import borrowed
from eurdf.kinematics.evaluate import frames as evaluated_frames

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def frames_of(robot: Robot, *names: str) -> Any:
    """Evaluates frames with these names, for few elements.

    Raises:
        ValueError: A frame is unknown, or two different frames have this name.
    """
    return evaluated_frames(robot, names, few=True)


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
    with borrowed(robot, frames_of, frame) as frames:
        return in_reference(frames, q[None], checked_reference(reference))[0]


def checked_reference(reference: Any) -> Any:
    """The axes of a twist.

    Raises:
        ValueError: ``reference`` is none of the three.
    """
    if reference not in (LOCAL, WORLD, LOCAL_WORLD_ALIGNED):
        raise ValueError(f"reference is {reference!r}; expected pin.LOCAL, pin.WORLD or pin.LOCAL_WORLD_ALIGNED")
    return reference


def in_reference(frames: Any, q: Matrix, reference: Any) -> Matrix:
    """The Jacobians (B, 6, nv) of one frame at q (B, nq), in the axes of the reference."""
    at = frames.at(q)
    J = frames.jacobians(at)[:, 0]  # of the origin, in the axes of the world
    R, p = (part[:, 0] for part in frames.poses(at))
    if reference == LOCAL:
        inverse = R.swapaxes(1, 2)
        return np.concatenate((inverse @ J[:, :3], inverse @ J[:, 3:]), axis=1)
    if reference == WORLD:
        return np.concatenate((J[:, :3] + np.cross(p[:, :, None], J[:, 3:], axis=1), J[:, 3:]), axis=1)
    return np.asarray(J)
