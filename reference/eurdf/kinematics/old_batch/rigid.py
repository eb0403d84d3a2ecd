"""Rotations and rigid motions of many elements at once.

Components come first and elements last: a vector is (3, …), a matrix (3, 3, …), where … is any shape. NumPy is then
fast, since the elements of each component lie side by side.
"""

from __future__ import annotations

import numpy as np

from eurdf.kinematics.array import Matrix, Vector

# Below this angle, rad, series replace the quotients; the first term left out is below 1e-17.
_SMALL = 1e-2

_NEXT, _LAST = [1, 2, 0], [2, 0, 1]


def product(A: Matrix, B: Matrix) -> Matrix:
    """A B, of (i, j, …) and (j, k, …)."""
    return np.asarray(np.einsum("ij...,jk...->ik...", A, B))


def turned(R: Matrix, a: Matrix) -> Matrix:
    """R a (i, …), of (i, j, …) and (j, …)."""
    return np.asarray(np.einsum("ij...,j...->i...", R, a))


def turned_back(R: Matrix, a: Matrix) -> Matrix:
    """Rᵀ a (j, …), of (i, j, …) and (i, …)."""
    return np.asarray(np.einsum("ij...,i...->j...", R, a))


def transposed(R: Matrix) -> Matrix:
    """Rᵀ."""
    return np.swapaxes(R, 0, 1)


def cross(a: Matrix, b: Matrix) -> Matrix:
    """A × b (3, …)."""
    return np.asarray(a[_NEXT] * b[_LAST] - a[_LAST] * b[_NEXT])


def dot(a: Matrix, b: Matrix) -> Vector:
    """A · b (…)."""
    return np.asarray((a * b).sum(axis=0))


def norm(a: Matrix) -> Vector:
    """|a| (…)."""
    return np.asarray(np.sqrt(dot(a, a)))


def skew(a: Matrix) -> Matrix:
    """The matrices (3, 3, …) that multiply b to a × b."""
    S = np.zeros((3, *a.shape))
    S[2, 1], S[1, 2] = a[0], -a[0]
    S[0, 2], S[2, 0] = a[1], -a[1]
    S[1, 0], S[0, 1] = a[2], -a[2]
    return S


def of_quaternion(quaternion: Matrix) -> Matrix:
    """The rotations (3, 3, …) of unit quaternions (4, …), x, y, z, w."""
    x, y, z, w = quaternion
    R = np.empty((3, 3, *x.shape))
    R[0, 0] = 1.0 - 2.0 * (y * y + z * z)
    R[1, 1] = 1.0 - 2.0 * (x * x + z * z)
    R[2, 2] = 1.0 - 2.0 * (x * x + y * y)
    R[0, 1], R[1, 0] = 2.0 * (x * y - z * w), 2.0 * (x * y + z * w)
    R[0, 2], R[2, 0] = 2.0 * (x * z + y * w), 2.0 * (x * z - y * w)
    R[1, 2], R[2, 1] = 2.0 * (y * z - x * w), 2.0 * (y * z + x * w)
    return R


def quaternion_of(R: Matrix) -> Matrix:
    """The unit quaternions (4, …), x, y, z, w, of rotations (3, 3, …)."""
    # Four times the squares of x, y, z and w; the largest is at least 1 and decides the other three.
    squares = np.stack(
        (
            1.0 + R[0, 0] - R[1, 1] - R[2, 2],
            1.0 - R[0, 0] + R[1, 1] - R[2, 2],
            1.0 - R[0, 0] - R[1, 1] + R[2, 2],
            1.0 + R[0, 0] + R[1, 1] + R[2, 2],
        )
    )
    vector = np.stack((R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]))  # 4 w times x, y, z
    quaternion = np.concatenate((vector, squares[3:]))
    if not (squares[3] >= 1.0).all():
        xy, yz, zx = R[0, 1] + R[1, 0], R[1, 2] + R[2, 1], R[2, 0] + R[0, 2]
        x, y, z = vector
        others = (
            np.stack((squares[0], xy, zx, x)),
            np.stack((xy, squares[1], yz, y)),
            np.stack((zx, yz, squares[2], z)),
        )
        largest = np.argmax(squares[:3], axis=0)
        quaternion = np.where(squares[3] >= 1.0, quaternion, np.choose(largest, others))
    return np.asarray(quaternion / norm(quaternion))


def log_of_quaternion(quaternion: Matrix) -> Matrix:
    """The rotation vectors (3, …), rad, of at most half a turn, of unit quaternions (4, …)."""
    vector, w = quaternion[:3], quaternion[3]
    sine = norm(vector)
    angle = 2.0 * np.arctan2(sine, np.abs(w))
    factor = np.full_like(sine, 2.0)
    np.divide(angle, sine, out=factor, where=sine > 0.0)
    return np.asarray(np.where(w < 0.0, -factor, factor) * vector)


def log3(R: Matrix) -> Matrix:
    """The rotation vectors (3, …), rad."""
    return log_of_quaternion(quaternion_of(R))


def quaternion_exp(turn: Matrix) -> Matrix:
    """The unit quaternions (4, …) of rotation vectors (3, …), rad."""
    half = 0.5 * norm(turn)
    return np.concatenate((0.5 * np.sinc(half / np.pi) * turn, np.cos(half)[None]))


def quaternion_product(a: Matrix, b: Matrix) -> Matrix:
    """The quaternions (4, …) of the rotation by b followed by that by a."""
    u, v = a[:3], b[:3]
    vector = a[3] * v + b[3] * u + cross(u, v)
    return np.concatenate((vector, (a[3] * b[3] - dot(u, v))[None]))


def conjugate(quaternion: Matrix) -> Matrix:
    """The quaternions of the inverse rotations."""
    return np.concatenate((-quaternion[:3], quaternion[3:]))


def translation_exp(move: Matrix, turn: Matrix) -> Matrix:
    """The translations (3, …) of exp6, of linear parts (3, …), m, and rotation vectors (3, …), rad."""
    angle = norm(turn)
    square = angle * angle
    small = angle < _SMALL
    safe = np.where(small, 1.0, angle)
    # (1 - cos θ) / θ² and (θ - sin θ) / θ³.
    once = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    twice = np.where(
        small, 1.0 / 6.0 - square / 120.0 + square**2 / 5040.0, (safe - np.sin(safe)) / (safe * safe * safe)
    )
    across = cross(turn, move)
    return np.asarray(move + once * across + twice * cross(turn, across))


def _beta(turn: Matrix) -> tuple[Vector, Vector]:
    """β(θ) = 1/θ² - cot(θ/2) / 2θ, and β′(θ)/θ."""
    angle = norm(turn)
    square = angle * angle
    small = angle < 0.1
    safe = np.where(small, 1.0, angle)
    half = 0.5 * safe
    cotangent = np.cos(half) / np.sin(half)
    beta = np.where(
        small,
        1.0 / 12.0 + square / 720.0 + square**2 / 30240.0 + square**3 / 1209600.0 + square**4 / 47900160.0,
        1.0 / safe**2 - cotangent / (2.0 * safe),
    )
    slope = np.where(
        small,
        1.0 / 360.0 + square / 7560.0 + square**2 / 201600.0 + square**3 / 5987520.0,
        (-2.0 / safe**3 + cotangent / (2.0 * safe**2) + 1.0 / (4.0 * safe * np.sin(half) ** 2)) / safe,
    )
    return beta, slope


def log6(R: Matrix, p: Matrix) -> tuple[Matrix, Matrix]:
    """The linear and angular parts (3, …) of log6 of poses, m and rad."""
    turn = log3(R)
    beta, _ = _beta(turn)
    return p - 0.5 * cross(turn, p) + beta * cross(turn, cross(turn, p)), turn


def jacobian_log3(turn: Matrix) -> Matrix:
    """The derivatives (3, 3, …) of log3 by the angular velocity in the moving axes, of rotation vectors (3, …)."""
    beta, _ = _beta(turn)
    J = 0.5 * skew(turn) + beta * turn[:, None] * turn[None, :]
    diagonal = 1.0 - beta * dot(turn, turn)
    for index in range(3):
        J[index, index] += diagonal
    return J


def jacobian_log6(R: Matrix, p: Matrix) -> Matrix:
    """The derivatives (6, 6, …) of log6 by the twist in the moving axes, of poses.

    With log6 = (V⁻¹ p, φ), V⁻¹ R = Jlog3 and φ̇ = Jlog3 ω, and the derivative of V⁻¹ p by φ at constant p.
    """
    turn = log3(R)
    beta, slope = _beta(turn)
    A = jacobian_log3(turn)
    along = dot(turn, p)
    bent = slope * (along * turn - dot(turn, turn) * p) - 2.0 * beta * p
    by_turn = 0.5 * skew(p) + bent[:, None] * turn[None, :] + beta * turn[:, None] * p[None, :]
    for index in range(3):
        by_turn[index, index] += beta * along
    J = np.zeros((6, 6, *turn.shape[1:]))
    J[:3, :3] = J[3:, 3:] = A
    J[:3, 3:] = product(by_turn, A)
    return J
