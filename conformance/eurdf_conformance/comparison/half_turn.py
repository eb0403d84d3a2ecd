"""The two values that the residual of a 6d closure has where B is turned by half a turn against A.

A rotation vector ω of length π and −ω are the same rotation. The residual (v, ω) has then a twin (v′, ω′) that the
specification allows as well, and the constraint Jacobian goes with it: K′ = J(r′)⁻¹ J(r) K, where J(r) takes ṙ to
the velocity of B seen from B,

    J(r) = Σ (−1)ⁿ / (n + 1)! · ad(r)ⁿ ,      ad(v, ω) = [[ω]× [v]×; 0 [ω]×]

(Chirikjian, Stochastic Models, Information Theory, and Lie Groups, vol. 2, section 10.7; Pinocchio's Jexp6).
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Matrix: TypeAlias = NDArray[np.float64]

#: rad; nearer to π than this, the pose of B in A, which is itself known to some 1e-8, may be on either side.
NEARLY = 1e-7


def is_half_turn(residual: Matrix) -> bool:
    """Whether a residual (6,) has a twin."""
    return residual.shape == (6,) and abs(float(np.linalg.norm(residual[3:])) - math.pi) < NEARLY


def twin_residual(residual: Matrix) -> Matrix:
    """The other value (6,) of a residual (6,) at a half turn; m, rad."""
    v, w = residual[:3], residual[3:]
    angle = float(np.linalg.norm(w))
    other = w * (1.0 - 2.0 * math.pi / angle)
    return np.concatenate([np.linalg.solve(_left(other), _left(w) @ v), other])


def twin_rows(residual: Matrix, rows: Matrix) -> Matrix:
    """The rows (6, n) of K for the twin, from those for a residual (6,)."""
    return np.asarray(np.linalg.solve(_jexp6(twin_residual(residual)), _jexp6(residual) @ rows))


def _cross(w: Matrix) -> Matrix:
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def _left(w: Matrix) -> Matrix:
    """V(ω) of chapter Closures, for ω that is not small."""
    angle, cross = float(np.linalg.norm(w)), _cross(w)
    return np.asarray(
        np.eye(3) + (1 - math.cos(angle)) / angle**2 * cross + (angle - math.sin(angle)) / angle**3 * cross @ cross,
    )


def _jexp6(r: Matrix) -> Matrix:
    ad = np.zeros((6, 6))
    ad[:3, :3] = ad[3:, 3:] = _cross(r[3:])
    ad[:3, 3:] = _cross(r[:3])
    term = total = np.eye(6)
    for n in range(1, 40):  # |ω| is about π: the terms are below 1e-25 then
        term = term @ ad * (-1.0 / (n + 1))
        total = total + term
    return total
