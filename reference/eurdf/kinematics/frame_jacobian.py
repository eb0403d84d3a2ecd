"""The Jacobian of a frame in the spanning tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pinocchio import LOCAL, LOCAL_WORLD_ALIGNED, WORLD

from eurdf.array import Matrix, Vector
from eurdf.kinematics.evaluate import Frames, frames
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def frames_of(robot: Robot, *names: str) -> Frames:
    """Frames for few configurations; see `eurdf.kinematics.evaluate.frames`."""
    return frames(robot, names, few=True)


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
    with working_memory(robot, frames_of, frame) as found:
        J: Matrix = in_reference(found, q[None], checked_reference(reference))[0]
        return J


def checked_reference(reference: Any) -> Any:
    """The axes of a twist.

    Raises:
        ValueError: ``reference`` is none of the three.
    """
    if reference not in (LOCAL, WORLD, LOCAL_WORLD_ALIGNED):
        raise ValueError(f"reference is {reference!r}; expected pin.LOCAL, pin.WORLD or pin.LOCAL_WORLD_ALIGNED")
    return reference


def in_reference(found: Frames, q: Matrix, reference: Any) -> Matrix:
    """The Jacobians (B, 6, nv) of one frame at q (B, nq), in the axes of the reference."""
    at = found.at(q)
    if reference == LOCAL_WORLD_ALIGNED:
        return found.jacobians(at)[:, 0]
    return found.rows(at, at.twist_in_b() if reference == LOCAL else np.broadcast_to(np.eye(6), (len(q), 1, 6, 6)))
