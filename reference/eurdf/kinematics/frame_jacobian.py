"""The Jacobian of a frame in the spanning tree."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from pinocchio import LOCAL, LOCAL_WORLD_ALIGNED, WORLD

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.constraints.vector import origins, velocity_of_origin
from eurdf.kinematics.derived import borrowed
from eurdf.kinematics.tree_kinematics import PairMemory

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
    with borrowed(robot, _memory, frame) as memory:
        placements = memory.placements(q)
        return memory.jacobian(_rows(placements, reference), [0])


def _memory(robot: Robot, frame: str) -> PairMemory:
    return robot.tree.frames([frame]).memory()


def _rows(placements: Sequence[Any], reference: Any) -> Matrix:
    """The rows (1, 6, 6) of the motion in the axes of the reference over the twist in the world."""
    if reference == LOCAL:
        return np.asarray(placements[0].toActionMatrixInverse())[None]
    if reference == WORLD:
        return np.eye(6)[None]
    if reference == LOCAL_WORLD_ALIGNED:
        return np.concatenate((velocity_of_origin(origins(placements))[0], np.eye(3, 6, 3)))[None]
    raise ValueError(f"reference is {reference!r}; expected pin.LOCAL, pin.WORLD or pin.LOCAL_WORLD_ALIGNED")
