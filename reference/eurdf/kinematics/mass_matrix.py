"""The mass matrix of the spanning tree, with or without mimic joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.assembly import start
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.named import Named

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@overflow_refused("the mass matrix")
def mass_matrix(robot: Robot, q: Named, *, data: Any = None) -> Matrix:
    """Mass matrix M(q) of the spanning tree, the armature included: its kinetic energy is ½ vᵀ M v.

    It is computed by `pin.crba`, except for robots with mimic joints: up to Pinocchio 4.1, `pin.crba` has wrong entries
    if a mimic joint carries several branches. Their M is computed from the inverse dynamics, column by column:
    M eᵢ = rnea(q, 0, eᵢ) - rnea(q, 0, 0).

    Source: Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapter 6.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed or open.
        data: A `pin.Data` of the model to compute in; by default a new one is created, or none for more than 130
            velocities.

    Returns:
        M (nv, nv), symmetric, in kg between two velocities in m/s, kg·m between m/s and rad/s, kg·m² between two in
        rad/s.

    Raises:
        ValueError: ``q`` is not a configuration, or ``data`` is of another model.
        NumericalOverflow: M is not finite.
    """
    tree = robot.tree
    M = tree.mass_times(start(robot, q, "q"), np.eye(tree.nv), tree.memory(data))
    symmetric = np.asarray(0.5 * (M + M.T))
    finite("the mass matrix", symmetric)
    return symmetric
