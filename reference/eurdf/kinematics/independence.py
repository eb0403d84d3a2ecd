"""Which rows of K are independent beyond doubt."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from eurdf.kinematics.array import Matrix, Vector

#: Up to this condition number of the dimensionless K Kᵀ, in Frobenius' norm, the rows of K are independent beyond
#: doubt. The smallest singular value of K is then at least 1e-3 of the largest one, and
#: `eurdf.kinematics.rank.numerical_rank` counts all values if none is below 3e-5 of it.
INDEPENDENT = 1e6

#: Singular values of the dimensionless K below this, relative to the largest one, are zero beyond doubt, as those of
#: redundant rows are. If each is zero or at least 1e-3 of the largest one, `numerical_rank` counts the latter.
_ZERO = 1e-12


class Independence:
    """Judges the K of one robot at one configuration after the other, by one thread at a time.

    The last K that was decomposed is kept. Singular values change by no more than the norm of a change of the matrix
    (Weyl), so that near it no other decomposition is needed to know that one would find the rows independent. So what
    is found does not depend on what is kept.
    """

    def __init__(self, row_scale: Vector, velocity_scale: Vector) -> None:
        """Take the factors (nc,) of the rows and (nv,) of the columns that make K dimensionless."""
        self._row_scale = row_scale
        self._scale = row_scale[:, None] * velocity_scale
        self._largest_scale = float(self._scale.max(initial=0.0))
        # A matrix K, the norm of its dimensionless A, and a bound of the smallest singular value of A from below.
        self._kept: tuple[Matrix, float, float] | None = None

    def is_shown(self, K: Matrix) -> bool:
        """Whether ‖A Aᵀ‖ ‖(A Aᵀ)⁻¹‖ is at most `INDEPENDENT`, with A the dimensionless K (nc, nv)."""
        if self._kept is not None:
            change = K - self._kept[0]
            # A bound of the norm of the scaled change, and only if that does not suffice the norm itself.
            if self._is_near(self._largest_scale * norm(change.ravel())):
                return True
            change *= self._scale
            if self._is_near(norm(change.ravel())):
                return True
        A = K * self._scale
        square = A @ A.T
        try:
            inverse = norm(np.linalg.inv(square).ravel())
        except np.linalg.LinAlgError:
            return False
        if not norm(square.ravel()) * inverse <= INDEPENDENT:
            return False
        self._kept = np.array(K), norm(A.ravel()), 1.0 / math.sqrt(inverse)
        return True

    def _is_near(self, change: float) -> bool:
        """Whether a change of so much of the kept A, in Frobenius' norm, leaves its rows independent beyond doubt."""
        assert self._kept is not None
        K, size, bound = self._kept
        least, most = bound - change, size + change
        return least > 0.0 and math.sqrt(len(K)) * most * most <= INDEPENDENT * least * least

    def least_forces(self, K: Matrix, lambdas: Vector) -> Vector | None:
        """The λ (nc,) of least norm, in units of the characteristic length, with the same Kᵀ λ.

        They are None if the rank of K (nc, nv) is in doubt.
        """
        if len(K) <= K.shape[1] and self.is_shown(K):
            return lambdas
        try:
            left, values, _ = np.linalg.svd(K * self._scale, full_matrices=False)
        except np.linalg.LinAlgError:
            return None
        largest = float(values.max(initial=0.0))
        rank = int(np.count_nonzero(values > _ZERO * largest))
        if not 0.0 < largest < math.inf or values[rank - 1] ** 2 * INDEPENDENT < largest**2:
            return None
        basis = left[:, :rank]
        return np.asarray(self._row_scale * (basis @ (basis.T @ (lambdas / self._row_scale))))


def norm(values: Any) -> float:
    """The Euclidean norm of values (n,); infinite if a square overflows."""
    return math.sqrt(values.dot(values))
