"""The mass matrix of the spanning tree, with or without mimic joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import start

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def mass_matrix(robot: Robot, q: Vector, *, data: Any = None) -> Matrix:
    """Mass matrix M(q) of the spanning tree, the armature included: its kinetic energy is ½ vᵀ M v.

    It is computed by `pin.crba`, except for robots with mimic joints: up to Pinocchio 4.1, `pin.crba` has wrong entries
    if a mimic joint carries several branches. Their M is computed from the inverse dynamics, column by column:
    M eᵢ = rnea(q, 0, eᵢ) - rnea(q, 0, 0).

    Source: Featherstone, *Rigid Body Dynamics Algorithms*, 2008, chapter 6.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed or open.
        data: A `pin.Data` of the model to compute in; by default a new one is created.

    Returns:
        M (nv, nv), symmetric, in kg between two velocities in m/s, kg·m between m/s and rad/s, kg·m² between two in
        rad/s.

    Raises:
        ValueError: ``q`` is not a configuration.
    """
    model = robot.model
    M = mass_times(model, model.createData() if data is None else data, start(robot, q), np.eye(model.nv))
    return np.asarray(0.5 * (M + M.T))


def mass_times(model: Any, data: Any, q: Vector, motions: Matrix) -> Matrix:
    """M(q) times the columns (nv, n) of accelerations; ``data`` is a `pin.Data` of the model to compute in."""
    if not len(model.mimicking_joints):
        M = np.triu(pin.crba(model, data, q))
        return np.asarray((M + np.triu(M, 1).T) @ motions)
    still = np.zeros(model.nv)
    gravity = np.array(pin.rnea(model, data, q, still, still))
    return np.array([pin.rnea(model, data, q, still, a) - gravity for a in motions.T]).reshape(motions.T.shape).T
