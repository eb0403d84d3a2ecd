"""Which rows of K are independent beyond doubt."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.tolerances import ZERO

#: Up to this condition number of the dimensionless K Kᵀ, in Frobenius' norm, the rows of K are independent beyond
#: doubt. The smallest singular value of K is then at least 1e-3 of the largest one, and
#: `eurdf.kinematics.rank.numerical_rank` counts all values if none is below 3e-5 of it.
INDEPENDENT = 1e6

# If each singular value is below `ZERO` or at least 1e-3 of the largest one, `numerical_rank` counts the latter.


class _Kept(NamedTuple):
    """A decomposed K, which others are compared with.

    Attributes:
        K: (nc, nv).
        size: Frobenius' norm of the dimensionless A.
        bound: Its smallest singular value that is not zero, or a bound of it from below.
        null: Orthonormal basis (nc, k) of its left null space: the combinations of rows that are redundant.
        chosen: Orthonormal rows (rank, nc), which span the other combinations, times the factors of the rows.
    """

    K: Matrix
    size: float
    bound: float
    null: Matrix
    chosen: Matrix


class Independence:
    """Judges the K of one robot at one configuration after the other, by one thread at a time.

    The last K that was decomposed is kept. Singular values change by no more than the norm of a change of the matrix
    (Weyl), so that near it no other decomposition is needed to know that one would find the same rank. So what is found
    does not depend on what is kept.
    """

    def __init__(self, row_scale: Vector, velocity_scale: Vector) -> None:
        """Take the factors (nc,) of the rows and (nv,) of the columns that make K dimensionless."""
        self._row_scale = row_scale
        self._scale = row_scale[:, None] * velocity_scale
        self._largest_scale = float(self._scale.max(initial=0.0))
        self._kept: _Kept | None = None

    def is_shown(self, K: Matrix) -> bool:
        """Whether ‖A Aᵀ‖ ‖(A Aᵀ)⁻¹‖ is at most `INDEPENDENT`, with A the dimensionless K (nc, nv)."""
        kept = self._kept
        if kept is not None and not kept.null.shape[1] and self._is_near(kept, K):
            return True
        A = K * self._scale
        square = A @ A.T
        try:
            inverse = norm(np.linalg.inv(square).ravel())
        except np.linalg.LinAlgError:
            return False
        if not norm(square.ravel()) * inverse <= INDEPENDENT:
            return False
        self._kept = _Kept(
            np.array(K), norm(A.ravel()), 1.0 / math.sqrt(inverse), np.empty((len(K), 0)), np.empty((0, 0))
        )
        return True

    def least_forces(self, K: Matrix, lambdas: Vector) -> Vector | None:
        """The λ (nc,) of least norm, in units of the characteristic length, with the same Kᵀ λ.

        They are None if the rank of K (nc, nv) is in doubt.
        """
        if not self.has_certain_rank(K):
            return None
        kept = self._kept
        return self._without(kept.null, lambdas) if kept is not None and kept.null.shape[1] else lambdas

    def has_certain_rank(self, K: Matrix) -> bool:
        """Whether the rank of K (nc, nv) is beyond doubt, so that `combinations` are those of K."""
        kept = self._kept
        if kept is None or not kept.null.shape[1]:
            if len(K) <= K.shape[1] and self.is_shown(K):
                return True
            A = K * self._scale
        else:
            A = K * self._scale
            if _annihilates(kept, A) and self._is_near(kept, K):
                return True
        try:
            left, values, _ = np.linalg.svd(A)
        except np.linalg.LinAlgError:
            return False
        largest = float(values.max(initial=0.0))
        rank = int(np.count_nonzero(values > ZERO * largest))
        if not 0.0 < largest < math.inf or values[rank - 1] ** 2 * INDEPENDENT < largest**2:
            return False
        chosen = left[:, :rank].T * self._row_scale
        self._kept = _Kept(np.array(K), norm(A.ravel()), float(values[rank - 1]), left[:, rank:], chosen)
        return True

    def combinations(self) -> Matrix | None:
        """Combinations (rank, nc) of the rows that are independent in the K judged last; None if all rows are."""
        kept = self._kept
        return kept.chosen if kept is not None and kept.null.shape[1] else None

    def _is_near(self, kept: _Kept, K: Matrix) -> bool:
        """Whether K has at least the rank of the kept one beyond doubt."""
        change = K - kept.K
        # A bound of the norm of the scaled change, and only if that does not suffice the norm itself.
        if _is_small(self._largest_scale * norm(change.ravel()), kept):
            return True
        change *= self._scale
        return _is_small(norm(change.ravel()), kept)

    def _without(self, null: Matrix, lambdas: Vector) -> Vector:
        """The λ without its part in the left null space."""
        scaled = lambdas / self._row_scale
        return np.asarray(self._row_scale * (scaled - null.dot(null.T.dot(scaled))))


def _is_small(change: float, kept: _Kept) -> bool:
    """Whether a change of so much of the kept A, in Frobenius' norm, leaves its rank at least as it is."""
    least, most = kept.bound - change, kept.size + change
    return least > 0.0 and math.sqrt(len(kept.K)) * most * most <= INDEPENDENT * least * least


def _annihilates(kept: _Kept, A: Matrix) -> bool:
    """Whether the combinations of rows that are redundant in the kept A are so in this one, beyond doubt."""
    # The largest singular value of A is at least its norm over √nc.
    return norm(kept.null.T.dot(A).ravel()) * math.sqrt(len(A)) <= ZERO * norm(A.ravel())


def norm(values: Any) -> float:
    """The Euclidean norm of values (n,); infinite if a square overflows."""
    return math.sqrt(values.dot(values))
