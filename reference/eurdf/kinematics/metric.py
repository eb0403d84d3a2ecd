"""Metrics of velocities: what a projection makes least."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Matrix
from eurdf.kinematics.named import Named, velocity_of
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def metric(robot: Robot, weights: Named | Matrix | None) -> Matrix:
    """The matrix W of the norm |v|² = vᵀ W v: (nv, nv), or its diagonal (nv,) if it is diagonal.

    Args:
        robot: The robot.
        weights: W itself, such as the mass matrix; its diagonal (nv,), also by joint, where one that is not named has
            the weight 1; or None for the identity, in which 1 rad/s and 1 m/s have the same norm.

    Raises:
        ValueError: The weights have a wrong shape, or W is not symmetric and positive definite.
    """
    nv = robot.tree.nv
    if weights is None:
        return np.ones(nv)
    if isinstance(weights, Mapping):
        weights = velocity_of(robot, weights, "weights", others=1.0)
    W = checked_array("weights", weights, (nv,), (nv, nv))
    if W.ndim == 2 and np.count_nonzero(W) <= nv and W.diagonal().all():
        W = np.array(W.diagonal())
    if W.ndim == 1:
        if not (W > 0.0).all():
            raise ValueError("weights are not positive definite")
        return W
    if np.abs(W - W.T).max(initial=0.0) > 1e-9 * np.abs(W).max(initial=0.0):
        raise ValueError("weights are not a symmetric matrix")
    try:
        np.linalg.cholesky(W)
    except np.linalg.LinAlgError:
        raise ValueError("weights are not positive definite") from None
    return W


def weighted(W: Matrix, motions: Matrix) -> Matrix:
    """W times the columns of motions (…, nv, m)."""
    return W[:, None] * motions if W.ndim == 1 else W @ motions


def orthonormal(basis: Matrix, W: Matrix) -> Matrix:
    """Orthonormal bases in the metric, Zᵀ W Z = 1, of the spans of Z (…, nv, m)."""
    across = basis.swapaxes(-1, -2)
    lower = np.linalg.cholesky(across @ weighted(W, basis))
    return np.asarray(np.linalg.solve(lower, across).swapaxes(-1, -2))
