"""Vectors of three numbers, k at once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from eurdf.kinematics.array import Matrix, Vector

_AFTER, _BEFORE = [1, 2, 0], [2, 0, 1]
_EACH = np.arange(3)


def cross(a: Matrix, b: Matrix) -> Matrix:
    """Cross products (…, 3); `numpy.cross` takes several times as long."""
    return np.asarray(a[..., _AFTER] * b[..., _BEFORE] - a[..., _BEFORE] * b[..., _AFTER])


def dot(a: Matrix, b: Matrix) -> Vector:
    """A · b (…)."""
    return np.asarray((a * b).sum(axis=-1))


def skew(a: Matrix) -> Matrix:
    """The matrices (k, 3, 3) that multiply b to a × b, of vectors (k, 3)."""
    x, y, z = a.T
    matrices = np.zeros((len(a), 3, 3))
    matrices[:, 2, 1], matrices[:, 1, 2] = x, -x
    matrices[:, 0, 2], matrices[:, 2, 0] = y, -y
    matrices[:, 1, 0], matrices[:, 0, 1] = z, -z
    return matrices


def plane_across(a: Vector) -> Matrix:
    """E (3, 2): what the shortest rotation that takes z to the unit vector a makes of x and y (EU-CLO-014).

    Of an axis within 1e-9 of -z, it is the half turn about x.
    """
    x, y, z = a
    if z < -1.0 + 1e-9 and math.hypot(x, y) < 1e-9:
        return np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])
    above = 1.0 + z if z > 0.0 else (x * x + y * y) / (1.0 - z)  # 1 + z, which rounding makes 0 near -z
    (turn,) = skew(np.array([[-y, x, 0.0]]))
    return np.asarray((np.eye(3) + turn + turn @ turn / above)[:, :2])


def origins(placements: Sequence[Any]) -> Matrix:
    """The translations (k, 3) of poses."""
    return np.array([placement.translation for placement in placements]).reshape(-1, 3)


def velocity_of_origin(p: Matrix) -> Matrix:
    """[1, -skew(p)] (k, 3, 6): ṗ over the twist of B against A, seen from A, where the origin of B is at p (k, 3)."""
    rows = np.zeros((len(p), 3, 6))
    rows[:, _EACH, _EACH] = 1.0
    rows[:, :, 3:] = -skew(p)
    return rows
