"""Vectors, rotations and rigid motions, over any leading dimensions: (…, 3), (…, 3, 3).

A rotation vector ω has the matrix W = [ω]ₓ, and t = |ω|². The left and the right Jacobian of exp3, and their inverses,
have the form 1 + a(t) W + b(t) W²; that of exp6 is the same over dual numbers: its block beside the diagonal is the
derivative of the block on the diagonal along the linear part.
"""

from __future__ import annotations

import math

import numpy as np

from eurdf.array import Matrix, Vector

_NEXT, _LAST = [1, 2, 0], [2, 0, 1]
_EACH = np.arange(3)
_ONE = np.eye(3)


def cross(a: Matrix, b: Matrix) -> Matrix:
    """a × b (…, 3); `numpy.cross` takes several times as long."""
    return np.asarray(a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT])


def dot(a: Matrix, b: Matrix) -> Vector:
    """a · b (…)."""
    return np.asarray(np.einsum("...i,...i->...", a, b))


def norm(a: Matrix) -> Vector:
    """|a| (…)."""
    return np.asarray(np.sqrt(dot(a, a)))


def skew(a: Matrix) -> Matrix:
    """The matrices (…, 3, 3) that multiply b to a × b."""
    S = np.zeros((*a.shape, 3))
    S[..., _LAST, _NEXT], S[..., _NEXT, _LAST] = a, -a
    return S


def turned(R: Matrix, a: Matrix) -> Matrix:
    """R a (…, 3)."""
    return np.asarray((R @ a[..., None])[..., 0])


def transposed(R: Matrix) -> Matrix:
    """Rᵀ (…, 3, 3)."""
    return np.swapaxes(R, -1, -2)


def outer(a: Matrix, b: Matrix) -> Matrix:
    """a bᵀ (…, 3, 3)."""
    return np.asarray(a[..., :, None] * b[..., None, :])


def velocity_of_origin(p: Matrix) -> Matrix:
    """[1, -skew(p)] (…, 3, 6): ṗ over the twist of B against A, seen from A, where the origin of B is at p (…, 3)."""
    rows = np.zeros((*p.shape, 6))
    rows[..., _EACH, _EACH] = 1.0
    rows[..., 3:] = -skew(p)
    return rows


def plane_across(a: Vector) -> Matrix:
    """E (3, 2): what the shortest rotation that takes z to the unit vector a makes of x and y (EU-CLO-014).

    Of an axis within 1e-9 of -z, it is the half turn about x.
    """
    x, y, z = a
    if z < -1.0 + 1e-9 and math.hypot(x, y) < 1e-9:
        return np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])
    above = 1.0 + z if z > 0.0 else (x * x + y * y) / (1.0 - z)  # 1 + z, which rounding makes 0 near -z
    turn = skew(np.array([-y, x, 0.0]))
    return np.asarray((_ONE + turn + turn @ turn / above)[:, :2])


# -- quaternions x, y, z, w -------------------------------------------------------------------------------------------


def rotation_of(quaternion: Matrix) -> Matrix:
    """The rotations (…, 3, 3) of unit quaternions (…, 4)."""
    D = 2.0 * outer(quaternion, quaternion)
    xx, yy, zz = D[..., 0, 0], D[..., 1, 1], D[..., 2, 2]
    R = np.empty((*quaternion.shape[:-1], 3, 3))
    R[..., 0, 0], R[..., 1, 1], R[..., 2, 2] = 1.0 - (yy + zz), 1.0 - (xx + zz), 1.0 - (xx + yy)
    R[..., 0, 1], R[..., 1, 0] = D[..., 0, 1] - D[..., 2, 3], D[..., 0, 1] + D[..., 2, 3]
    R[..., 0, 2], R[..., 2, 0] = D[..., 0, 2] + D[..., 1, 3], D[..., 0, 2] - D[..., 1, 3]
    R[..., 1, 2], R[..., 2, 1] = D[..., 1, 2] - D[..., 0, 3], D[..., 1, 2] + D[..., 0, 3]
    return R


def quaternion_of(R: Matrix) -> Matrix:
    """The unit quaternions (…, 4) of rotations (…, 3, 3)."""
    x, y, z = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    # Four times the squares of x, y, z and w; the largest is at least 1 and decides the other three.
    squares = np.stack((1.0 + x - y - z, 1.0 - x + y - z, 1.0 - x - y + z, 1.0 + x + y + z), axis=-1)
    vector = R[..., _LAST, _NEXT] - R[..., _NEXT, _LAST]  # 4 w times x, y, z
    quaternion = np.concatenate((vector, squares[..., 3:]), axis=-1)
    if not (squares[..., 3] >= 1.0).all():
        sums = R + transposed(R)
        others = np.concatenate((sums, vector[..., None]), axis=-1)  # a row for each of x, y, z as the largest
        others[..., _EACH, _EACH] = squares[..., :3]
        largest = np.argmax(squares[..., :3], axis=-1)[..., None, None]
        chosen = np.take_along_axis(others, largest, axis=-2)[..., 0, :]
        quaternion = np.where(squares[..., 3:] >= 1.0, quaternion, chosen)
    return np.asarray(quaternion / norm(quaternion)[..., None])


def quaternion_product(a: Matrix, b: Matrix) -> Matrix:
    """The quaternions (…, 4) of the rotation by b followed by that by a."""
    u, v, c, d = a[..., :3], b[..., :3], a[..., 3:], b[..., 3:]
    return np.concatenate((c * v + d * u + cross(u, v), c * d - dot(u, v)[..., None]), axis=-1)


def quaternion_exp(turn: Matrix) -> Matrix:
    """The unit quaternions (…, 4) of rotation vectors (…, 3), rad."""
    half = 0.5 * norm(turn)[..., None]
    return np.concatenate((0.5 * np.sinc(half / np.pi) * turn, np.cos(half)), axis=-1)


def quaternion_log(quaternion: Matrix) -> Matrix:
    """The rotation vectors (…, 3), rad, of at most half a turn, of unit quaternions (…, 4)."""
    vector, w = quaternion[..., :3], quaternion[..., 3]
    sine = norm(vector)
    factor = np.full_like(sine, 2.0)
    np.divide(2.0 * np.arctan2(sine, np.abs(w)), sine, out=factor, where=sine > 0.0)
    return np.asarray(np.where(w < 0.0, -factor, factor)[..., None] * vector)


# -- exponentials and logarithms --------------------------------------------------------------------------------------

# Terms cₙ tⁿ of 1 - (θ/2) cot(θ/2), t = θ², from the differential equation that it satisfies; for angles below 1 rad.
_SERIES = [0.0]
for _n in range(1, 12):
    _SERIES.append(((_n == 1) / 4.0 + sum(_SERIES[i] * _SERIES[_n - i] for i in range(1, _n))) / (2.0 * _n + 1.0))
_COTANGENT = np.polynomial.Polynomial(_SERIES[1:])
_COTANGENTS = _COTANGENT, _COTANGENT.deriv(), _COTANGENT.deriv(2)


def _beta(turn: Matrix) -> tuple[Vector, Vector, Vector]:
    """β(t) = 1/t - cot(θ/2) / 2θ (…, 1, 1), β′ and β″; the inverse of the right Jacobian is 1 + W/2 + β W²."""
    t = dot(turn, turn)[..., None, None]
    small = t < 1.0
    if small.all():
        series, slope, bend = _COTANGENTS
        return series(t), slope(t), bend(t)
    far = np.where(small, 1.0, t)
    half = 0.5 * np.sqrt(far)
    h = half / np.tan(half)
    h_slope = (h - h * h - 0.25 * far) / (2.0 * far)
    h_bend = (h_slope * (1.0 - 2.0 * h) - 0.25 - 2.0 * h_slope) / (2.0 * far)
    beta = (1.0 - h) / far
    slope_ = -(h_slope + beta) / far
    bend_ = -(h_bend + 2.0 * slope_) / far
    near = np.where(small, t, 0.0)
    found = zip(_COTANGENTS, (beta, slope_, bend_), strict=True)
    beta, slope_, bend_ = (np.where(small, series(near), value) for series, value in found)
    return beta, slope_, bend_


def log3(R: Matrix) -> Matrix:
    """The rotation vectors (…, 3), rad."""
    return quaternion_log(quaternion_of(R))


def log3_derivative(turn: Matrix) -> Matrix:
    """The derivative (…, 3, 3) of log3 by the angular velocity in the axes that turn, of rotation vectors (…, 3)."""
    W = skew(turn)
    return np.asarray(_ONE + 0.5 * W + _beta(turn)[0] * (W @ W))


def log6(R: Matrix, p: Matrix) -> Matrix:
    """log6 (…, 6) of poses: linear, m, and angular, rad."""
    turn = log3(R)
    across = cross(turn, p)
    return np.concatenate((p - 0.5 * across + _beta(turn)[0][..., 0] * cross(turn, across), turn), axis=-1)


def log6_derivative(r: Matrix) -> Matrix:
    """The derivative (…, 6, 6) of log6 by the twist in the axes of the moved frame, of logarithms (…, 6)."""
    beta, slope, _ = _beta(r[..., 3:])
    V, W = skew(r[..., :3]), skew(r[..., 3:])
    square = W @ W
    along = _along(r[..., 3:], r[..., :3])
    return _blocks(_ONE + 0.5 * W + beta * square, 0.5 * V + beta * _both(W, V) + 2.0 * along * slope * square)


def log6_second_derivative(r: Matrix, rate: Matrix) -> Matrix:
    """The derivative (…, 6, 6) of `log6_derivative` while the logarithm r (…, 6) changes at a rate (…, 6)."""
    beta, slope, bend = _beta(r[..., 3:])
    v, w, dv, dw = r[..., :3], r[..., 3:], rate[..., :3], rate[..., 3:]
    V, W, dV, dW = (skew(each) for each in (v, w, dv, dw))
    square, along_v, along_w = W @ W, _along(w, v), _along(w, dw)
    turn = 0.5 * dW + beta * _both(W, dW) + 2.0 * slope * along_w * square
    moved = 0.5 * dV + beta * (_both(W, dV) + _both(dW, V)) + 2.0 * slope * along_w * _both(W, V)
    moved += 2.0 * slope * along_v * _both(W, dW)
    moved += (2.0 * slope * (_along(dw, v) + _along(w, dv)) + 4.0 * bend * along_w * along_v) * square
    return _blocks(turn, moved)


def exp6(v: Matrix) -> tuple[Matrix, Matrix]:
    """The rotations (…, 3, 3) and translations (…, 3), m, that twists (…, 6) lead to in unit time."""
    (a, b), _ = _exponential(v[..., 3:])
    move, turn = v[..., :3], v[..., 3:]
    across = cross(turn, move)
    position = move + a[..., 0] * across + b[..., 0] * cross(turn, across)
    return rotation_of(quaternion_exp(turn)), position


def exp6_derivative(v: Matrix) -> Matrix:
    """The right Jacobian (…, 6, 6) of exp6: the twist in the axes of the moved frame over the change of v (…, 6)."""
    (a, b), (a_slope, b_slope) = _exponential(v[..., 3:])
    V, W = skew(v[..., :3]), skew(v[..., 3:])
    square, along = W @ W, 2.0 * _along(v[..., 3:], v[..., :3])
    return _blocks(_ONE - a * W + b * square, -a * V - along * a_slope * W + b * _both(W, V) + along * b_slope * square)


def _exponential(turn: Matrix) -> tuple[tuple[Vector, Vector], tuple[Vector, Vector]]:
    """a = (1 - cos θ) / t and b = (θ - sin θ) / θ³, and a′(t), b′(t); the left Jacobian is 1 + a W + b W²."""
    t = dot(turn, turn)[..., None, None]
    angle = np.sqrt(t)
    a = 0.5 * np.sinc(0.5 * angle / np.pi) ** 2
    small = angle < 0.5
    far = np.where(small, 1.0, angle)
    near = np.where(small, t, 0.0)
    b = np.where(small, _taylor(near, 3), (far - np.sin(far)) / far**3)
    a_slope = np.where(small, -_taylor(near, 4, 1), (far * np.sin(far) - 2.0 * (1.0 - np.cos(far))) / (2.0 * far**4))
    b_slope = (a - 3.0 * b) / (2.0 * far * far)
    return (a, b), (a_slope, np.where(small, -_taylor(near, 5, 1), b_slope))


def _taylor(t: Matrix, first: int, factor: int = 0) -> Matrix:
    """Σ (-t)ⁿ / (first + 2 n)!, with the factor n + 1 of a derivative if that is asked for."""
    terms = [(n + 1) ** factor / math.factorial(first + 2 * n) for n in range(6)]
    return np.asarray(np.polynomial.polynomial.polyval(-t, terms))


def _along(a: Matrix, b: Matrix) -> Vector:
    return dot(a, b)[..., None, None]


def _both(A: Matrix, B: Matrix) -> Matrix:
    """The derivative A B + B A of a square."""
    return np.asarray(A @ B + B @ A)


def _blocks(diagonal: Matrix, beside: Matrix) -> Matrix:
    J = np.zeros((*diagonal.shape[:-2], 6, 6))
    J[..., :3, :3] = J[..., 3:, 3:] = diagonal
    J[..., :3, 3:] = beside
    return J
