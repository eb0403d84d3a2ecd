"""Linear systems of many elements at once; matrices (n, n, B) have elements last."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix, Vector

# Above this size LAPACK, element by element, is faster than column by column for all elements.
_MOST_COLUMNS = 60
# Above this number of rows BLAS, element by element, is faster than a sum over all elements.
_MOST_ROWS = 14


def gram(A: Matrix) -> Matrix:
    """A Aᵀ (m, m, B) of (m, n, B)."""
    if len(A) <= _MOST_ROWS:
        return np.asarray(np.einsum("inb,jnb->ijb", A, A))
    first = np.ascontiguousarray(np.moveaxis(A, -1, 0))
    return np.moveaxis(first @ np.swapaxes(first, 1, 2), 0, -1)


def times(A: Matrix, x: Matrix) -> Matrix:
    """A x (m, B) of (m, n, B) and (n, B)."""
    return np.asarray(np.einsum("inb,nb->ib", A, x))


def times_back(A: Matrix, y: Matrix) -> Matrix:
    """Aᵀ y (n, B) of (m, n, B) and (m, B)."""
    return np.asarray(np.einsum("inb,ib->nb", A, y))


def solve(G: Matrix, b: Matrix) -> tuple[Matrix, Vector]:
    """Solve G x = b for symmetric positive definite G by Cholesky factors.

    Args:
        G: (n, n, B).
        b: (n, B), or several columns (n, k, B).

    Returns:
        x, as b; and (B,) the smallest pivot of G relative to its largest diagonal entry. It is 0, and x is
        meaningless, where G is not positive definite or not finite.
    """
    n, _, B = G.shape
    if n == 0:
        return np.array(b), np.ones(B)
    if b.ndim == 2:
        x, ratio = solve(G, b[:, None])
        return x[:, 0], ratio
    largest = np.einsum("iib->ib", G).max(axis=0)
    fine = np.isfinite(G).all(axis=(0, 1)) & (largest > 0.0)
    if n > _MOST_COLUMNS:
        return _solve_each(np.where(fine, G, np.eye(n)[:, :, None]), b, largest, fine)
    L = np.where(fine, G, np.eye(n)[:, :, None])
    x, smallest = np.array(b), np.full(B, np.inf)
    for column in range(n):
        pivot = L[column, column]
        smallest = np.minimum(smallest, pivot)
        root = np.sqrt(np.where(pivot > 0.0, pivot, 1.0))
        below = L[column + 1 :, column] / root
        L[column, column] = root
        L[column + 1 :, column] = below
        x[column] /= root
        x[column + 1 :] -= below[:, None] * x[column]
        for row in range(column + 1, n):
            L[row, column + 1 : row + 1] -= below[row - column - 1] * below[: row - column]
    for column in reversed(range(n)):
        x[column] -= (L[column + 1 :, column, None] * x[column + 1 :]).sum(axis=0)
        x[column] /= L[column, column]
    positive = fine & (smallest > 0.0)
    return x, np.where(positive, smallest / np.where(positive, largest, 1.0), 0.0)


def _solve_each(G: Matrix, b: Matrix, largest: Vector, fine: Vector) -> tuple[Matrix, Vector]:
    each = np.ascontiguousarray(np.moveaxis(G, -1, 0))
    ratio = np.zeros(len(each))
    try:
        L = np.linalg.cholesky(each)
        x = np.moveaxis(np.linalg.solve(each, np.moveaxis(b, -1, 0)), 0, -1)
        ratio = np.square(np.diagonal(L, axis1=1, axis2=2)).min(axis=1) / np.where(fine, largest, 1.0)
    except np.linalg.LinAlgError:  # some element is not positive definite
        x = np.zeros_like(b)
        for element, own in enumerate(each):
            try:
                pivots = np.square(np.diagonal(np.linalg.cholesky(own)))
                x[..., element] = np.linalg.solve(own, b[..., element])
                ratio[element] = pivots.min() / largest[element] if fine[element] else 0.0
            except np.linalg.LinAlgError:
                ratio[element] = 0.0
    return np.asarray(x, dtype=np.float64), np.where(fine, ratio, 0.0)
