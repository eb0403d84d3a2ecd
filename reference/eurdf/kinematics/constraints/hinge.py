"""hinge: the origin of B is at the origin of A, and an axis of B is along an axis of A."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.constraints.kind import Closures
from eurdf.kinematics.constraints.relative_motion import RelativeMotions
from eurdf.kinematics.constraints.vector import cross, dot, origins, plane_across, skew, velocity_of_origin
from eurdf.kinematics.tree_kinematics import TreeKinematics
from eurdf.mechanism.constraint import HingeClosure

# Coefficients of the series of θ / sin θ in powers of cos θ - 1: each is -(n + 1) / (2n + 3) of the one before.
_SERIES = np.cumprod([1.0, *(-(n + 1.0) / (2.0 * n + 3.0) for n in range(17))])
_SMALL = 0.5  # rad: below it the series counts, whose last term is then below 1e-17

# The sine of θ near half a turn, where the shortest rotation has no derivative, is taken as no less than this.
_LEAST_SINE = 1e-9


class HingeClosures(Closures[HingeClosure]):
    """EU-CLO-014: r = (p, Eᵀ s), m and rad.

    s is the shortest rotation vector that takes axis a of A to β, axis b of B seen from A. With c = cos θ = a · β and
    g(c) = θ / sin θ, s = g(c) a × β. E (3, 2) spans the plane across a. Where β = -a, s is half a turn about the first
    column of E, as the logarithm of a half turn is one of two.
    """

    data = HingeClosure

    def __init__(
        self, constraints: Sequence[HingeClosure], pairs: Sequence[int], tree: TreeKinematics, velocities: Indices
    ) -> None:
        """See `Kind`."""
        super().__init__(constraints, pairs, tree, velocities)
        axes = np.array([constraint.axes for constraint in constraints], dtype=np.float64)
        axes /= np.abs(axes).max(axis=2, keepdims=True)  # of any length, also of one whose square is out of range
        axes /= np.linalg.norm(axes, axis=2, keepdims=True)
        self._a, self._b = axes[:, 0], axes[:, 1]
        self._across = np.array([plane_across(a) for a in self._a])

    def rows(self, placements: Sequence[Any]) -> Matrix:
        """P and Eᵀ s."""
        _, theta, axis = self._turn(_rotations(placements))
        return np.concatenate((origins(placements), _along(self._across, theta[:, None] * axis)), axis=1)

    def rows_of_twist(self, placements: Sequence[Any]) -> Matrix:
        """[1, -skew(p); 0, Eᵀ S], where ṡ = S ω, S = -g skew(a) skew(β) - g' (a × β)(a × β)ᵀ."""
        beta, theta, axis = self._turn(_rotations(placements))
        g, slope, _ = _profile(theta)
        normal = np.maximum(np.sin(theta), _LEAST_SINE)[:, None] * axis
        S = -g[:, None, None] * (skew(self._a) @ skew(beta))
        S -= slope[:, None, None] * (normal[:, :, None] * normal[:, None, :])
        rows = np.zeros((len(beta), 5, 6))
        rows[:, :3] = velocity_of_origin(origins(placements))
        rows[:, 3:, 3:] = np.swapaxes(self._across, 1, 2) @ S
        return rows

    def rows_of_motion(self, motions: RelativeMotions) -> Matrix:
        """p̈ and Eᵀ s̈, with s̈ = g a × β̈ + 2 g' ċ a × β̇ + (g' c̈ + g'' ċ²) a × β."""
        beta, theta, axis = self._turn(motions.rotation)
        g, slope, bend = (values[:, None] for values in _profile(theta))
        a, omega = self._a, motions.omega
        rate = cross(omega, beta)
        second = cross(motions.alpha, beta) + cross(omega, rate)
        c_rate, c_second = dot(a, rate)[:, None], dot(a, second)[:, None]
        s = g * cross(a, second) + 2.0 * slope * c_rate * cross(a, rate)
        s += (slope * c_second + bend * c_rate**2) * np.sin(theta)[:, None] * axis
        return np.concatenate((motions.acceleration, _along(self._across, s)), axis=1)

    def opening(self, aMb: Any, index: int) -> tuple[float, float]:
        """|p| and θ."""
        a, beta = self._a[index], aMb.rotation @ self._b[index]
        angle = math.atan2(float(np.linalg.norm(cross(a, beta))), float(a @ beta))
        return math.hypot(*aMb.translation), angle

    def _turn(self, rotations: Matrix) -> tuple[Matrix, Vector, Matrix]:
        """β (k, 3), the angle θ (k,) from a to β, in [0, π], and the axis (k, 3) about which it turns."""
        beta = np.einsum("kij,kj->ki", rotations, self._b)
        normal = cross(self._a, beta)
        sine = np.linalg.norm(normal, axis=1)
        theta = np.arctan2(sine, dot(self._a, beta))
        axis = np.array(self._across[:, :, 0])
        np.divide(normal, sine[:, None], out=axis, where=sine[:, None] > 0.0)
        return beta, theta, axis


def _rotations(placements: Sequence[Any]) -> Matrix:
    return np.array([placement.rotation for placement in placements])


def _along(across: Matrix, s: Matrix) -> Matrix:
    """Eᵀ s (k, 2)."""
    return np.asarray(np.einsum("kij,ki->kj", across, s))


def _profile(theta: Vector) -> tuple[Vector, Vector, Vector]:
    """G = θ / sin θ (k,), and its first and second derivative by c = cos θ.

    They satisfy (1 - c²) g' = c g - 1 and (1 - c²) g'' = 3 c g' + g.
    """
    away = -2.0 * np.sin(0.5 * theta) ** 2  # cos θ - 1
    series = np.polynomial.Polynomial(_SERIES)
    near = series(away), series.deriv()(away), series.deriv(2)(away)
    c, sine = np.cos(theta), np.maximum(np.sin(theta), _LEAST_SINE)
    g = theta / sine
    slope = (c * g - 1.0) / sine**2
    far = g, slope, (3.0 * c * slope + g) / sine**2
    small = theta < _SMALL
    g, slope, bend = (np.where(small, one, other) for one, other in zip(near, far, strict=True))
    return g, slope, bend
