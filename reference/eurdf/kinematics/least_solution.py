"""The solution of A x = b with the least norm, where there is no doubt about the rank of A.

`numerical_rank` and the singular value decomposition of all columns decide on ranks. They take several times as long as
a solution, which needs them only near a singular configuration. Here the inverse of A Aᵀ bounds the smallest singular
value s from below, 1/s² ≤ tr (A Aᵀ)⁻¹, so that most configurations are known to be far from singular.
"""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix

#: A singular value above this fraction of the norm of the matrix counts for certain: `numerical_rank` counts all above
#: 3.2e-5. The normal equations then lose half of the digits, and one refinement regains them.
CERTAIN = 1e-4

#: A singular value below this fraction of the largest one is zero for certain, as of a redundant row.
_ZERO = 1e-12

#: Largest part of b, relative to it, that A x may miss, if its rows are redundant.
_MISSED = 1e-10


def least_solution(A: Matrix, b: Matrix, norm: float) -> Matrix | None:
    """The x (n, …) with A x = b that has the least norm; None if the rank of A is in doubt, or there is none.

    Args:
        A: (m, n), dimensionless.
        b: (m, …).
        norm: A norm that the singular values of A are compared with, at least its Frobenius norm.
    """
    rows, columns = A.shape
    if rows <= columns:
        gram = A @ A.T
        inverse = certain_inverse(gram, norm)
        if inverse is not None:
            y = inverse @ b
            y += inverse @ (b - gram @ y)
            return np.asarray(A.T @ y)
    if not np.isfinite(A).all():
        return None
    left, values, right = np.linalg.svd(A, full_matrices=False)
    rank = int(np.count_nonzero(values > CERTAIN * norm))
    if (values[rank:] > _ZERO * values.max(initial=0.0)).any():
        return None
    x = right[:rank].T @ ((left[:, :rank].T @ b).T / values[:rank]).T
    missed = np.abs(A @ x - b).max(initial=0.0)
    return np.asarray(x) if missed <= _MISSED * np.abs(b).max(initial=0.0) else None


def certain_inverse(gram: Matrix, norm: float) -> Matrix | None:
    """The inverse of A Aᵀ (m, m); None if it is in doubt that the rows of A are independent.

    Args:
        gram: A Aᵀ.
        norm: As in `least_solution`.
    """
    try:
        inverse = np.asarray(np.linalg.inv(gram), dtype=np.float64)
    except np.linalg.LinAlgError:  # singular to the last digit
        return None
    trace = float(inverse.trace())
    return inverse if trace > 0.0 and CERTAIN * CERTAIN * norm * norm * trace < 1.0 else None
