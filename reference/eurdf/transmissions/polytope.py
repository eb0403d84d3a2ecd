"""Bounded polytopes in a few dimensions, as the sets of torques and velocities that motors allow, and boxes in them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import combinations, product

import numpy as np

from eurdf.array import Mask, Matrix, Vector

# By how much, relative to its bound, a point may violate a half-space and count as inside.
_INSIDE = 1e-9

_MOST_STEPS = 100
# Bound of what the largest box exceeds this one by, as the logarithm of the ratio of the products of their sides. Where
# thousands of half-spaces are alike, the slacks at a gap of 1e-12 are rounding, and further steps leave the solution.
_GAP = 1e-10


@dataclass(frozen=True, eq=False, repr=False)
class Polytope:
    """The points x (n,) with A x ≤ b.

    Attributes:
        A: Normals (m, n) of its half-spaces.
        b: Their bounds (m,).
        candidates: Returns points (c, n) among which are all vertices.
    """

    A: Matrix
    b: Vector
    candidates: Callable[[], Matrix]

    @cached_property
    def vertices(self) -> Matrix:
        """(k, n); in two dimensions in counterclockwise order."""
        return _ordered(_extreme(self.candidates(), self.A, self.b))

    def contains(self, x: Matrix, tolerance: float = _INSIDE) -> Mask:
        """Whether points (..., n) are inside, to a tolerance relative to the size of the polytope."""
        return np.asarray((np.asarray(x) @ self.A.T <= self.b + tolerance * np.abs(self.b)).all(axis=-1))

    @property
    def axes(self) -> Matrix:
        """Smallest and largest value (n, 2) of each coordinate while the others are zero; zero must be inside."""
        with np.errstate(divide="ignore"):
            upper = np.where(self.A > 0.0, self.b[:, None] / self.A, np.inf).min(axis=0)
            lower = np.where(self.A < 0.0, self.b[:, None] / self.A, -np.inf).max(axis=0)
        return np.stack((lower, upper), axis=1)

    def __repr__(self) -> str:
        return f"<Polytope: {len(self.b)} half-spaces in {self.A.shape[1]} dimensions>"


def image_of_box(G: Matrix, lower: Vector, upper: Vector) -> Polytope:
    """{Gᵀ x : lower ≤ x ≤ upper}, for G (m, n) of rank n: a zonotope."""
    A, b = _supporting(G, lower, upper)
    return Polytope(A, b, partial(_images_of_corners, G, lower, upper))


def preimage_of_box(G: Matrix, bound: Vector) -> Polytope:
    """{x : |G x| ≤ bound}, for G (m, n) of rank n."""
    A, b = np.vstack((G, -G)), np.concatenate((bound, bound))
    return Polytope(A, b, partial(_corners, G, bound))


def _images_of_corners(G: Matrix, lower: Vector, upper: Vector) -> Matrix:
    """Gᵀ x (2ᵐ, n) of the corners x of a box."""
    return np.array(list(product(*zip(lower.tolist(), upper.tolist(), strict=True)))) @ G


def _corners(G: Matrix, bound: Vector) -> Matrix:
    """The points (c, n) at which n independent rows of |G x| ≤ bound are tight."""
    n = G.shape[1]
    points = []
    for rows in combinations(range(len(G)), n):
        own = G[list(rows)]
        if np.linalg.matrix_rank(own / np.linalg.norm(own, axis=1, keepdims=True), tol=_INSIDE) == n:
            signs = np.array(list(product((-1.0, 1.0), repeat=n)))
            points.append(np.linalg.solve(own, (signs * bound[list(rows)]).T).T)
    return np.vstack(points)


def _supporting(G: Matrix, lower: Vector, upper: Vector) -> tuple[Matrix, Vector]:
    """The half-spaces of a zonotope, two for each pair of parallel facets.

    With as many x as coordinates, a row and its bound are those of one x: x = G⁻ᵀ y.
    """
    m, n = G.shape
    if m == n:
        inverse = np.linalg.inv(G.T)
        return np.vstack((inverse, -inverse)), np.concatenate((upper, -lower))
    normals = np.array(list(_facets(G)))
    A = np.vstack((normals, -normals))
    along = A @ G.T
    return A, np.maximum(along * lower, along * upper).sum(axis=1)


def _facets(G: Matrix) -> Iterator[Vector]:
    """Unit normals of the facets: each is perpendicular to n - 1 independent generators."""
    m, n = G.shape
    for rows in combinations(range(m), n - 1):
        _, values, right = np.linalg.svd(G[list(rows)].reshape(n - 1, n))
        if n == 1 or values[-1] > _INSIDE * np.linalg.norm(G, axis=1).max():
            yield right[-1]


def _extreme(points: Matrix, A: Matrix, b: Vector) -> Matrix:
    """The different ones of these points that are vertices: inside, and with n independent half-spaces tight."""
    size = np.abs(A) @ np.abs(points).max(axis=0)
    slack = (b - points @ A.T) / size
    found: list[Vector] = []
    for point, own in zip(points[(slack >= -_INSIDE).all(axis=1)], slack[(slack >= -_INSIDE).all(axis=1)], strict=True):
        tight = A[own <= _INSIDE]
        scaled = tight / np.linalg.norm(tight, axis=1, keepdims=True)
        new = all(np.abs(A @ (point - other) / size).max() > _INSIDE for other in found)
        if new and np.linalg.matrix_rank(scaled, tol=_INSIDE) == points.shape[1]:
            found.append(point)
    return np.array(found)


def _ordered(vertices: Matrix) -> Matrix:
    if vertices.shape[1] != 2:
        return vertices
    around = (vertices - vertices.mean(axis=0)) / np.abs(vertices).max(axis=0)
    return np.asarray(vertices[np.argsort(np.arctan2(around[:, 1], around[:, 0]))])


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
