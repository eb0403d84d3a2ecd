"""A damped least-squares step that has no part along motions without effect."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.least_solution import CERTAIN

# Singular values of A below this fraction of the largest are zero.
_ROUNDING = 1e-12
# Eigenvalues of A Aᵀ below this fraction of the largest are zero.
_ROUNDING_OF_SQUARES = 1e-15


def damped_step(A: Matrix, e: Vector, damping: float) -> Vector:
    """The y (m,) that minimises |A y + e|² + λ|y|².

    Unlike (AᵀA + λ 1)⁻¹ Aᵀ e, it has no part along motions that change no error, which would be amplified rounding.
    The eigenvalues of A Aᵀ give it, the squares of the singular values, if each is zero or above 1e-8 times the largest
    beyond doubt; else the singular value decomposition.
    """
    if 0 < len(A) <= A.shape[1]:
        # The eigenvalues of A Aᵀ are squares of singular values, where these are not too small.
        squares, axes = np.linalg.eigh(A.dot(A.T))
        largest = float(squares[-1])
        for zeros, square in enumerate(squares.tolist()):
            if square > CERTAIN * CERTAIN * largest:
                axes = axes[:, zeros:]
                along = axes.T.dot(e) / (squares[zeros:] + damping)
                return -np.asarray(axes.dot(along).dot(A), dtype=np.float64)
            if square > _ROUNDING_OF_SQUARES * largest:
                break
    left, values, right = np.linalg.svd(A, full_matrices=False)
    factors = np.where(values > _ROUNDING * values.max(initial=0.0), values / (values**2 + damping), 0.0)
    return -np.asarray(right.T @ (factors * (left.T @ e)), dtype=np.float64)
