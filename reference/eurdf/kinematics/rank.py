"""Ranks of matrices with rounded entries (of arithmetic and of numbers in files), and solutions that depend on them.

`numerical_rank` and the singular value decomposition of all columns decide on ranks. They take several times as long as
a solution, which needs them only near a singular configuration. The inverse of A Aᵀ bounds the smallest singular value
s from below, 1/s² ≤ tr (A Aᵀ)⁻¹, so that most configurations are known to be far from singular.

Arrays have elements first; those without are of one element.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.linalg import _umath_linalg

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.tolerances import CERTAIN, FLOOR, MISSED, NOTHING, ZERO

# Eigenvalues of A Aᵀ below this fraction of the largest are zero.
_ROUNDING_OF_SQUARES = 1e-15


# -- numbers, one for each element ------------------------------------------------------------------------------------

#: What controls the steps of a solver: an array (B,) for many elements, a float or bool for a single one. The
#: expressions are the same; floats take a tenth of the time. Only the functions below distinguish the two.
Numbers = Any


def square(rows: Matrix) -> Numbers:
    """The squared Euclidean norm of each of (B, …)."""
    if len(rows) != 1:
        return squares(rows)
    row = rows.ravel()
    return float(row.dot(row))


def largest(rows: Matrix) -> Numbers:
    """The largest magnitude in each row (B, n), at least 0; NaN if one is."""
    found = np.abs(rows)
    return float(np.maximum.reduce(found[0], initial=0.0)) if len(rows) == 1 else found.max(axis=1, initial=0.0)


def total(rows: Matrix) -> Numbers:
    """The sum of each row (B, n)."""
    return sum(rows[0].tolist()) if len(rows) == 1 else np.add.reduce(rows, axis=1)


def numbers(count: int, value: float) -> Numbers:
    """The same number for each of so many elements."""
    return value if count == 1 else np.full(count, value)


def every(mask: Numbers) -> bool:
    """Whether a mask is true of every element."""
    return np.count_nonzero(mask) == mask.size if isinstance(mask, np.ndarray) else bool(mask)


def some(mask: Numbers) -> bool:
    """Whether a mask is true of at least one element."""
    return bool(np.count_nonzero(mask) if isinstance(mask, np.ndarray) else mask)


def choose(mask: Numbers, one: Any, other: Any) -> Numbers:
    """One number for the elements of a mask, the other for the rest."""
    if isinstance(mask, np.ndarray):
        return np.where(mask, one, other)
    return one if mask else other


def taken(number: Numbers, which: Any) -> Numbers:
    """The numbers of some elements."""
    return number[which] if isinstance(number, np.ndarray) else number


def as_numbers(values: Vector | Mask) -> Numbers:
    """The numbers of an array (B,)."""
    return values.item() if len(values) == 1 else values


def column(number: Numbers) -> Numbers:
    """The same numbers, as factors of rows (B, n)."""
    return number[:, None] if isinstance(number, np.ndarray) else number


def at_least(number: Numbers, least: Numbers) -> Numbers:
    """The larger number for each element."""
    if isinstance(number, np.ndarray) or isinstance(least, np.ndarray):
        return np.maximum(number, least)
    return max(number, least)


def product(A: Matrix, B: Matrix) -> Matrix:
    """A B (B, m, k), of (B, m, n) and (B, n, k)."""
    found: Matrix = A[0].dot(B[0])[None] if len(A) == len(B) == 1 else A @ B
    return found


def times(A: Matrix, x: Matrix) -> Matrix:
    """A x (B, m), of (B, m, n) and (B, n)."""
    found: Matrix = A[0].dot(x[0])[None] if len(A) == 1 else (A @ x[:, :, None])[:, :, 0]
    return found


def squares(rows: Matrix) -> Vector:
    """The squared Euclidean norms (B,) of (B, …)."""
    return np.asarray(np.add.reduce(rows * rows, axis=1 if rows.ndim == 2 else (1, 2)))


def norms(rows: Matrix) -> Vector:
    """The Euclidean norms (B,) of (B, …)."""
    found: Vector = np.sqrt(np.array(square(rows), ndmin=1))
    return found


# -- systems of equations ---------------------------------------------------------------------------------------------


def solutions(A: Matrix, b: Matrix) -> Matrix:
    """The x (B, n) with A x = b, of (B, n, n) and (B, n); NaN where A is singular to the last digit.

    `numpy.linalg.solve` raises if one of many matrices is singular. What it calls does not, and takes half of its time
    for a small one.
    """
    x: Matrix = _umath_linalg.solve1(A, b)
    return x


def inverses(A: Matrix) -> Matrix:
    """The inverses (B, n, n) of (B, n, n); NaN where A is singular to the last digit, as for `solutions`."""
    with np.errstate(invalid="ignore"):
        return np.asarray(_umath_linalg.inv(A), dtype=np.float64)


def are_finite(matrices: Matrix) -> Mask:
    """Which (B,) of the matrices (B, m, n) are finite."""
    return np.asarray(np.isfinite(matrices).all(axis=(1, 2)))


def diagonals(matrices: Matrix) -> Matrix:
    """The diagonals (B, n) of (B, n, n), to read and to change."""
    B, n, _ = matrices.shape
    return matrices.reshape(B, n * n)[:, :: n + 1]


def numerical_rank(singular_values: Vector, reference: float | None = None) -> int:
    """Number of singular values before the widest gap.

    A fixed threshold would have to separate the rounding of numbers in files (an angle given as 1.5708 turns an axis by
    4e-6) from the small singular values of short levers. Instead, the values relative to ``reference``, clipped to
    `FLOOR` from below, are placed between 1 and `FLOOR`, and those before the largest ratio of two consecutive values
    count. A single small value therefore counts if it is above about 3e-5 = √FLOOR.

    Args:
        singular_values: In descending order, of a matrix scaled to one unit.
        reference: The largest singular value of the matrix that it is a part of; by default that of its own.
    """
    return int(numerical_ranks(singular_values[None], None if reference is None else np.array([reference]))[0])


def singular_values(A: Matrix) -> Vector:
    """The singular values of A, the largest first."""
    return np.asarray(np.linalg.svd(A, compute_uv=False), dtype=np.float64)


def null_space(A: Matrix) -> Matrix:
    """Orthonormal basis (k, n) of the null space of A (m, n), one vector a row."""
    _, values, right = np.linalg.svd(A, full_matrices=True)
    return np.asarray(right[numerical_rank(values) :], dtype=np.float64)


def numerical_ranks(values: Matrix, reference: Vector | None = None) -> Indices:
    """`numerical_rank` of the singular values (…, k) of several matrices; by default relative to the first of each."""
    if values.shape[-1] == 0:
        return np.zeros(values.shape[:-1], dtype=np.intp)
    most = values[..., :1] if reference is None else reference[..., None]
    ladder = np.empty((*values.shape[:-1], values.shape[-1] + 2))
    ladder[..., 0], ladder[..., -1] = 1.0, FLOOR
    ladder[..., 1:-1] = np.minimum(np.maximum(values / np.maximum(most, NOTHING), FLOOR), 1.0)
    widest: Indices = (ladder[..., :-1] / ladder[..., 1:]).argmax(axis=-1)
    return widest * (most[..., 0] > NOTHING)


def certain_inverse(gram: Matrix, norm: Vector) -> tuple[Matrix, Mask]:
    """The inverses of A Aᵀ (B, m, m), and for which (B,) the rows of A are independent beyond doubt.

    Args:
        gram: A Aᵀ.
        norm: A norm (B,) that the singular values of A are compared with, at least its Frobenius norm.
    """
    inverse = inverses(gram)
    trace = total(diagonals(inverse))
    norm = as_numbers(norm)
    return inverse, np.array((trace > 0.0) & (CERTAIN * CERTAIN * norm * norm * trace < 1.0), ndmin=1)


def least_solution(A: Matrix, b: Matrix, norm: Vector) -> tuple[Matrix, Mask]:
    """The x (B, n, k) with A x = b that have the least norm; and where (B,) there is one and the rank is certain.

    Args:
        A: (B, m, n), dimensionless.
        b: (B, m, k).
        norm: As in `certain_inverse`.
    """
    B, m, n = A.shape
    if m > n:
        x, sure = np.zeros((B, n, b.shape[2])), np.zeros(B, dtype=bool)
    else:
        x, sure = least_by_squares(A, b, norm)
        if every(sure):
            return x, sure
    doubtful = ~sure & np.isfinite(norm)  # and with it A
    if not some(doubtful):
        return x, sure
    which = slice(None) if every(doubtful) else np.flatnonzero(doubtful)
    A, b = A[which], b[which]
    left, values, right = np.linalg.svd(A, full_matrices=False)
    counts = values > CERTAIN * norm[which, None]
    inverse = np.divide(1.0, values, out=np.zeros(values.shape), where=counts)
    own = product(right.swapaxes(1, 2), inverse[:, :, None] * product(left.swapaxes(1, 2), b))
    missed = largest((product(A, own) - b).reshape(len(A), -1))
    certain = missed <= MISSED * largest(b.reshape(len(A), -1))
    redundant = values <= ZERO * values[:, :1]
    x[which], sure[which] = own, certain & (counts | redundant).all(axis=1)
    return x, sure


def least_by_squares(A: Matrix, b: Matrix, norm: Vector) -> tuple[Matrix, Mask]:
    """As `least_solution`, from A Aᵀ; and where (B,) the rows of A are independent for certain. Else x is arbitrary."""
    transposed = A.swapaxes(1, 2)
    gram = product(A, transposed)
    inverse, sure = certain_inverse(gram, norm)
    if not some(sure):
        return np.zeros((len(A), A.shape[2], b.shape[2])), sure
    y = product(inverse, b)
    y += product(inverse, b - product(gram, y))
    return product(transposed, y), sure


def least_by_values(A: Matrix, b: Matrix) -> Matrix:
    """A⁺ b (B, n, k) with the `numerical_ranks` of A."""
    left, values, right = np.linalg.svd(A, full_matrices=False)
    most = values[:, :1]
    counts = values > np.maximum(CERTAIN * most, NOTHING)
    if np.count_nonzero(values > ZERO * most) > np.count_nonzero(counts):  # else the gap between them is the widest
        counts = np.arange(values.shape[1]) < numerical_ranks(values)[:, None]
    values[~counts] = np.inf
    return product(right.swapaxes(1, 2), product(left.swapaxes(1, 2), b) / values[:, :, None])


def damped_step(A: Matrix, e: Matrix, damping: Vector) -> Matrix:
    """The y (B, n) that minimise |A y + e|² + λ|y|².

    Unlike (AᵀA + λ 1)⁻¹ Aᵀ e, they have no part along motions that change no error, which would be amplified rounding.
    The eigenvalues of A Aᵀ give them, the squares of the singular values, if each is zero or above 1e-8 times the
    largest beyond doubt; else the singular value decomposition.

    Args:
        A: (B, m, n).
        e: (B, m).
        damping: λ of each element.
    """
    m, n = A.shape[1:]
    if not 0 < m <= n:
        return _damped_by_values(A, e, np.array(damping, ndmin=1))
    back = A.swapaxes(1, 2)
    gram = product(A, back)
    if not every(np.isfinite(total(diagonals(gram)))):
        gram = np.where(are_finite(gram)[:, None, None], gram, 0.0)
    squared, axes = _umath_linalg.eigh_lo(gram)  # as for `solutions`
    highest = squared[:, -1:]
    counts = squared > CERTAIN * CERTAIN * highest
    inverse = 1.0 / (squared + column(damping))
    sure = np.count_nonzero(counts) == counts.size
    if not sure:
        inverse = np.where(counts, inverse, 0.0)
    y: Matrix = -times(back, times(axes, inverse * times(axes.swapaxes(1, 2), e)))
    if sure:
        return y
    doubtful = (counts != (squared > _ROUNDING_OF_SQUARES * highest)).any(axis=1) | ~(highest[:, 0] > 0.0)
    if np.count_nonzero(doubtful):
        y[doubtful] = _damped_by_values(A[doubtful], e[doubtful], np.broadcast_to(damping, len(A))[doubtful])
    return y


def _damped_by_values(A: Matrix, e: Matrix, damping: Vector) -> Matrix:
    """`damped_step` by singular values."""
    A = np.where(are_finite(A)[:, None, None], A, 0.0)
    left, values, right = np.linalg.svd(A, full_matrices=False)
    counts = values > ZERO * values.max(axis=1, initial=0.0)[:, None]
    factors = np.divide(values, values**2 + damping[:, None], out=np.zeros_like(values), where=counts)
    return np.asarray(-((factors[:, None] * (e[:, None] @ left)) @ right)[:, 0])
