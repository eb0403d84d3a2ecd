"""Metrics on the space of velocities."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.pinocchio.arguments import checked_array


def metric(weights: Vector | Matrix | None, nv: int) -> Matrix:
    """The matrix W (nv, nv) of the norm |v|² = vᵀ W v.

    Args:
        weights: W itself, such as the mass matrix; its diagonal (nv,); or None for the identity, in which
            1 rad/s and 1 m/s have the same norm.
        nv: Number of velocities.

    Raises:
        ValueError: The weights have a wrong shape, or W is not symmetric and positive definite.
    """
    if weights is None:
        return np.eye(nv)
    given = checked_array("weights", weights, (nv,), (nv, nv))
    W = np.diag(given) if given.ndim == 1 else given
    if np.abs(W - W.T).max(initial=0.0) > 1e-9 * np.abs(W).max(initial=0.0):
        raise ValueError("weights are not a symmetric matrix")
    try:
        np.linalg.cholesky(W)
    except np.linalg.LinAlgError:
        raise ValueError("weights are not positive definite") from None
    return W


def orthonormal(basis: Matrix, W: Matrix) -> Matrix:
    """Orthonormal bases in the metric, Zᵀ W Z = 1, of the spans of Z (…, nv, m)."""
    across = basis.swapaxes(-1, -2)
    lower = np.linalg.cholesky(across @ W @ basis)
    return np.asarray(np.linalg.solve(lower, across).swapaxes(-1, -2))


def nearest(basis: Matrix, W: Matrix, v: Vector) -> Vector:
    """The v' = Z y (nv,) nearest to v in the metric: Z (Zᵀ W Z)⁻¹ Zᵀ W v."""
    return np.asarray(basis @ np.linalg.solve(basis.T @ W @ basis, basis.T @ (W @ v)), dtype=np.float64)
