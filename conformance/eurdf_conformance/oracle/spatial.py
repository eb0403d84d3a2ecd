"""Poses and twists: rotation matrices, homogeneous 4×4 matrices, and 6-vectors (linear, angular).

A pose aMb takes coordinates of a point in b to those in a. A twist is the velocity of a body, seen from a frame: the
velocity of the body's point at that frame's origin, and its angular velocity.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def pose(R: Array | None = None, p: Array | Sequence[float] | None = None) -> Array:
    """The pose (R, p), which takes c to R c + p; an omitted part is that of the identity."""
    M = np.eye(4)
    if R is not None:
        M[:3, :3] = R
    if p is not None:
        M[:3, 3] = p
    return M


def inverse(M: Array) -> Array:
    """The pose bMa = (Rᵀ, −Rᵀ p) of aMb = (R, p)."""
    R = M[:3, :3].T
    return pose(R, -R @ M[:3, 3])


def skew(w: Array) -> Array:
    """[w]×, for which [w]× c = w × c."""
    x, y, z = w
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def unit(a: Array) -> Array:
    """The direction of a vector of any length, EU-URD-035."""
    scaled = a / np.max(np.abs(a))  # else the squares of a very long or short vector would not be numbers
    return np.asarray(scaled / np.linalg.norm(scaled))


def rotation(a: Array, angle: float) -> Array:
    """R(a, θ) = 1 + sin θ [a]× + (1 − cos θ) [a]×², about the unit vector a, right-handed."""
    W = skew(a)
    return np.asarray(np.eye(3) + np.sin(angle) * W + 2.0 * np.sin(angle / 2.0) ** 2 * W @ W)


def from_rpy(rpy: Array) -> Array:
    """R_z(yaw) R_y(pitch) R_x(roll), EU-FRM-006."""
    x, y, z = np.eye(3)
    return rotation(z, rpy[2]) @ rotation(y, rpy[1]) @ rotation(x, rpy[0])


def from_quaternion(quaternion: Array) -> Array:
    """The rotation of a unit quaternion (x, y, z, w): 1 + 2 w [v]× + 2 [v]×², v = (x, y, z)."""
    V = skew(quaternion[:3])
    return np.asarray(np.eye(3) + 2.0 * quaternion[3] * V + 2.0 * V @ V)


def quaternion_product(a: Array, b: Array) -> Array:
    """The quaternion of R_a R_b."""
    v = a[3] * b[:3] + b[3] * a[:3] + np.cross(a[:3], b[:3])
    return np.array([*v, a[3] * b[3] - a[:3] @ b[:3]])


def adjoint(M: Array) -> Array:
    """The matrix that takes a twist seen from b to the same seen from a, M being aMb: [[R, [p]× R], [0, R]]."""
    R, p = M[:3, :3], M[:3, 3]
    X = np.zeros((6, 6))
    X[:3, :3] = X[3:, 3:] = R
    X[:3, 3:] = skew(p) @ R
    return X
