"""The Jacobian of a frame in the spanning tree."""

from __future__ import annotations

from typing import Any

import numpy as np
from pinocchio import LOCAL, LOCAL_WORLD_ALIGNED, WORLD

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.constraints.vector import origins, velocity_of_origin
from eurdf.kinematics.tree_kinematics import TreeKinematics


def frame_jacobian(tree: TreeKinematics, q: Vector, frame: str, reference: Any) -> Matrix:
    """The derivative (6, nv) of a frame's motion by the velocities: linear, then angular rows.

    Args:
        tree: The spanning tree.
        q: Configuration (nq,).
        frame: Name of a link, a joint (its frame on the child side), or a frame of the description.
        reference: The axes of the twist: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.

    Raises:
        ValueError: The frame is unknown or ambiguous, or ``reference`` is none of the three.
    """
    memory = tree.frames([frame]).memory()
    placements = memory.placements(q)
    if reference == LOCAL:
        rows = placements[0].toActionMatrixInverse()
    elif reference == WORLD:
        rows = np.eye(6)
    elif reference == LOCAL_WORLD_ALIGNED:
        rows = np.concatenate((velocity_of_origin(origins(placements))[0], np.eye(3, 6, 3)))
    else:
        raise ValueError(f"reference is {reference!r}; expected pin.LOCAL, pin.WORLD or pin.LOCAL_WORLD_ALIGNED")
    return memory.jacobian(rows[None], [0])
