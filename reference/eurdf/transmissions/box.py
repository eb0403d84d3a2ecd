"""The largest box, symmetric about zero, that satisfies half-spaces."""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix, Vector

_MOST_STEPS = 100
# Bound of what the largest box exceeds this one by, as the logarithm of the ratio of the products of their sides. Where
# thousands of half-spaces are alike, the slacks at a gap of 1e-12 are rounding, and further steps leave the solution.
_GAP = 1e-10


def largest_box(A: Matrix, b: Vector) -> Vector:
    """The half sides y (n,) with |A| y ≤ b and the largest product.

    It maximizes Σ log yⱼ, which is concave, by a primal-dual interior-point method (Boyd, Vandenberghe, *Convex
    Optimization*, 2004, section 11.7).

    Args:
        A: (m, n); no column is zero.
        b: (m,), positive.
    """
    P = np.abs(A) / b[:, None]
    unit = 1.0 / P.max(axis=0)  # the largest side of each coordinate alone
    P = P * unit
    m, n = P.shape
    y = np.full(n, 0.5 / n)
    s = 1.0 - P @ y
    lambdas = 1.0 / s
    for _ in range(_MOST_STEPS):
        gap = float(lambdas @ s)
        dual, primal = P.T @ lambdas - 1.0 / y, P @ y + s - 1.0
        if gap <= _GAP and np.abs(y * dual).max() <= _GAP:
            break
        centre = lambdas * s - 0.1 * gap / m
        matrix = np.diag(1.0 / (y * y)) + (P.T * (lambdas / s)) @ P
        dy = np.linalg.solve(matrix, -dual - P.T @ ((lambdas * primal - centre) / s))
        ds = -primal - P @ dy
        dl = (-centre - lambdas * ds) / s
        step = min(_longest(y, dy), _longest(s, ds), _longest(lambdas, dl))
        y, s, lambdas = y + step * dy, s + step * ds, lambdas + step * dl
    return np.asarray(unit * y / (P @ y).max())


def box_along(A: Matrix, b: Vector, ratio: Vector) -> Vector:
    """The largest half sides y = t · ratio (n,) with |A| y ≤ b."""
    return np.asarray(ratio / (np.abs(A) @ ratio / b).max())


def _longest(x: Vector, dx: Vector) -> float:
    """The step that keeps x positive, at most 1."""
    falls = dx < 0.0
    return float(min(1.0, 0.99 * np.min(-x[falls] / dx[falls], initial=np.inf)))
