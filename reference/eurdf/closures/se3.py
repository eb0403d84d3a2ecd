"""Vectors, rotations and rigid motions, over any leading dimensions: (…, 3), (…, 3, 3).

A rotation vector ω has the matrix W = [ω]ₓ, and t = |ω|². The left and the right Jacobian of exp3, and their inverses,
have the form 1 + a(t) W + b(t) W²; that of exp6 is the same over dual numbers: its block beside the diagonal is the
derivative of the block on the diagonal along the linear part.
"""

from __future__ import annotations

import math

import numpy as np

from eurdf.array import Matrix, Vector

_NEXT, _LAST, _SWAPPED = np.array((1, 2, 0)), np.array((2, 0, 1)), np.array((3, 4, 5, 0, 1, 2))
_EACH = np.arange(3)
IDENTITY_ROTATION = np.eye(3)
# Linear maps are one product with a vector: it is faster than to set entries one by one.
_SKEW = np.cross(IDENTITY_ROTATION[:, None], IDENTITY_ROTATION).transpose(0, 2, 1).reshape(3, 9)
_OF_ORIGIN = np.concatenate((np.zeros((3, 3, 3)), -_SKEW.reshape(3, 3, 3)), axis=2).reshape(3, 18)
_OF_ZERO = np.eye(3, 6).ravel()
_UNIT = np.eye(6)
_AD = np.zeros((6, 36))  # of a motion r the matrix of r ×
for _rows, _columns, _of in ((0, 0, 3), (3, 3, 3), (0, 3, 0)):
    _AD.reshape(6, 6, 6)[_of : _of + 3, _rows : _rows + 3, _columns : _columns + 3] = _SKEW.reshape(3, 3, 3)

_AD_OF_FORCE = -_AD.reshape(6, 6, 6).transpose(1, 2, 0).reshape(6, 36)


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
    return np.asarray((a @ _SKEW).reshape(*a.shape, 3))


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
    return np.asarray((p @ _OF_ORIGIN + _OF_ZERO).reshape(*p.shape, 6))


def plane_across(a: Vector) -> Matrix:
    """E (3, 2): what the shortest rotation that takes z to the unit vector a makes of x and y (EU-CLO-014).

    Of an axis within 1e-9 of -z, it is the half turn about x.
    """
    x, y, z = a
    if z < -1.0 + 1e-9 and math.hypot(x, y) < 1e-9:
        return np.array([[1.0, 0.0], [0.0, -1.0], [0.0, 0.0]])
    above = 1.0 + z if z > 0.0 else (x * x + y * y) / (1.0 - z)  # 1 + z, which rounding makes 0 near -z
    turn = skew(np.array([-y, x, 0.0]))
    return np.asarray((IDENTITY_ROTATION + turn + turn @ turn / above)[:, :2])


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

# Coefficients cₙ of tⁿ, n > 0, in 1 - (θ/2) cot(θ/2), t = θ², from the differential equation that it satisfies.
_COTANGENT: list[float] = []
for _n in range(1, 10):
    _sum = sum(a * b for a, b in zip(_COTANGENT, reversed(_COTANGENT), strict=True))
    _COTANGENT.append(((_n == 1) / 4.0 + _sum) / (2.0 * _n + 1.0))
_NEAR = 0.25  # below this t the series counts; its terms shrink by t / 4π²


def _beta(turn: Matrix, order: int = 0) -> list[Vector]:
    """β(t) = 1/t - cot(θ/2) / 2θ (…, 1), and its derivatives up to an order of at most 3.

    The inverse of the right Jacobian of exp3 is 1 + W/2 + β W².
    """
    t = dot(turn, turn)[..., None]
    most = float(np.maximum.reduce(t, axis=None, initial=0.0))
    if most < _NEAR:
        return _series(t, most, order)
    small = t < _NEAR
    far = np.where(small, 1.0, t)
    half = 0.5 * np.sqrt(far)
    h = half / np.tan(half)
    h_slope = (h - h * h - 0.25 * far) / (2.0 * far)
    h_bend = (h_slope * (1.0 - 2.0 * h) - 0.25 - 2.0 * h_slope) / (2.0 * far)
    found = [(1.0 - h) / far]
    found.append(-(h_slope + found[0]) / far)
    found.append(-(h_bend + 2.0 * found[1]) / far)
    h_third = (h_bend * (1.0 - 2.0 * h) - 2.0 * h_slope * h_slope - 4.0 * h_bend) / (2.0 * far)
    found.append(-(h_third + 3.0 * found[2]) / far)
    near = _series(np.where(small, t, 0.0), _NEAR, order)
    return [np.where(small, one, other) for one, other in zip(near, found, strict=False)]


def _series(t: Vector, most: float, order: int) -> list[Vector]:
    """β and its derivatives by their series, of as many terms as the largest t needs."""
    count = min(len(_COTANGENT), 2 + order + int(39.0 / math.log(39.0 / max(most, 1e-300))))
    coefficients, found = _COTANGENT[:count], []
    for _ in range(order + 1):
        value = np.zeros(t.shape)
        for coefficient in reversed(coefficients):
            value *= t
            value += coefficient
        found.append(value)
        coefficients = [n * coefficient for n, coefficient in enumerate(coefficients)][1:]
    return found


def log3(R: Matrix) -> Matrix:
    """The rotation vectors (…, 3), rad."""
    return quaternion_log(quaternion_of(R))


def log3_derivative(turn: Matrix) -> Matrix:
    """The derivative (…, 3, 3) of log3 by the angular velocity in the axes that turn, of rotation vectors (…, 3)."""
    return _inverse_jacobian(turn, *_beta(turn))


def _inverse_jacobian(w: Matrix, beta: Vector) -> Matrix:
    """1 + W/2 + β W²."""
    return skew(0.5 * w) + outer(beta * w, w) + _scalar(1.0 - beta * _along(w, w))


def log6(R: Matrix, p: Matrix) -> Matrix:
    """log6 (…, 6) of poses: linear, m, and angular, rad."""
    turn = log3(R)
    across = cross(turn, p)
    (beta,) = _beta(turn)
    return np.concatenate((p - 0.5 * across + beta * cross(turn, across), turn), axis=-1)


def log6_derivative(r: Matrix) -> Matrix:
    """The derivative (…, 6, 6) of log6 by the twist in the axes of the moved frame, of logarithms (…, 6)."""
    v, w = r[..., :3], r[..., 3:]
    beta, slope = _beta(w, 1)
    along = 2.0 * _along(w, v)
    # The derivative of 1 + W/2 + β W² along v, where W² = w wᵀ - t and t changes by 2 w · v.
    beside = skew(0.5 * v) + outer(beta * v + slope * along * w, w) + outer(beta * w, v)
    beside += _scalar(-along * (beta + slope * _along(w, w)))
    return _blocks(_inverse_jacobian(w, beta), beside)


def log6_second(r: Matrix, twist: Matrix, change: Matrix) -> Matrix:
    """r̈ (…, 6) of logarithms r (…, 6) of frames that move with a twist in their own axes, which changes.

    With ad the matrix of r ×, J = 1 + ad/2 + B ad² has ṙ = J ξ, where B is β over dual numbers; r̈ = J ξ̇ + J̇ ξ.
    """
    w, swapped = r[..., 3:], r[..., _SWAPPED]
    beta, slope, bend = _beta(w, 2)
    ad, along = (r @ _AD).reshape(*r.shape, 6), _along(r, swapped)
    once = turned(ad, twist)
    twice = turned(ad, once)
    rate = twist + 0.5 * once + _dual(beta, slope * along, twice)
    ad_rate, along_rate = (rate @ _AD).reshape(*r.shape, 6), 2.0 * _along(w, rate[..., 3:])
    both = turned(ad, change) + turned(ad_rate, twist)
    second = change + 0.5 * both + _dual(beta, slope * along, turned(ad, both) + turned(ad_rate, once))
    along_second = 2.0 * _along(rate, swapped)
    return second + _dual(slope * along_rate, bend * along_rate * along + slope * along_second, twice)


def motion_cross(a: Matrix) -> Matrix:
    """The matrices (…, 6, 6) that multiply a motion b to a × b."""
    return np.asarray((a @ _AD).reshape(*a.shape, 6))


def force_cross(f: Matrix) -> Matrix:
    """The matrices (…, 6, 6) that multiply a motion a to a ×* f, where b · (a ×* f) = -(a × b) · f."""
    return np.asarray((f @ _AD_OF_FORCE).reshape(*f.shape, 6))


def log6_derivative_derivative(r: Matrix, J: Matrix) -> Matrix:
    """The derivative (…, 6, 6, 6), last index, of J = log6_derivative(-r) by a twist seen from the fixed frame.

    J (…, 6, 6) is the derivative of log6, whose value is r (…, 6), by this twist.
    """
    if _is_small(r):
        return np.asarray((r @ _TURNS_NEAR + _TURNS_AT_ZERO).reshape(*J.shape, 6))
    each = _by_logarithm(r[..., None, :], np.broadcast_to(_UNIT, (*r.shape, 6))) @ J[..., None, :, :]
    return np.swapaxes(each, -3, -2)


def log6_bend_derivative(r: Matrix, J: Matrix, twist: Matrix) -> Matrix:
    """The derivative (…, 6, 6) of J̇ η by a twist, at a constant twist η (…, 6); for r and J see above.

    With U = ∂(J η)/∂r, J̇ η = U J η, and this is (H + U²) J with H = ∂(U ṙ)/∂r at constant ṙ = J η.
    """
    rate = turned(J, twist)
    R, Y = motion_cross(rate), motion_cross(twist)
    turning = turned(R, twist)
    both, U = R @ Y + motion_cross(turning), _by_logarithm(r, twist)
    if _is_small(r):
        return np.asarray((U @ U - both / 12.0) @ J)
    w, swapped = r[..., 3:], r[..., _SWAPPED]
    beta, slope, bend, third = _beta(w, 3)
    X = motion_cross(r)
    once = turned(X, twist)
    # Dual numbers as (real, dual): β and its derivatives by t, and those of t by r and along ṙ.
    along = _along(r, swapped)
    b, b_slope, b_bend = (beta, slope * along), (slope, bend * along), (bend, third * along)
    by_r, by_both = (_angular(2.0 * w), 2.0 * swapped), (_angular(2.0 * rate[..., 3:]), 2.0 * rate[..., _SWAPPED])
    by_rate = 2.0 * _along(w, rate[..., 3:]), 2.0 * _along(swapped, rate)
    bent = _dual_product(_dual_product(b_bend, by_rate), by_r), _dual_product(b_slope, by_both)
    H = _dual_outer(bent[0], turned(X, once)) + _dual_outer(bent[1], turned(X, once))
    H -= _dual_times(_dual_product(b_slope, by_rate), motion_cross(once) + X @ Y)
    H += _dual_outer(_dual_product(b_slope, by_r), turned(R, once) + turned(X, turning))
    return np.asarray((H - _dual_times(b, both) + U @ U) @ J)


def _by_logarithm(r: Matrix, x: Matrix) -> Matrix:
    """The derivative (…, 6, 6) of (1 - ad/2 + B ad²) x by r, at constant x (…, 6); see `log6_second`."""
    X, Y = motion_cross(r), motion_cross(x)
    once = turned(X, x)
    twice = motion_cross(once) + X @ Y
    if _is_small(r):
        return np.asarray(0.5 * Y - twice / 12.0)
    w, swapped, along = r[..., 3:], r[..., _SWAPPED], _along(r, r[..., _SWAPPED])
    beta, slope, bend = _beta(w, 2)[:3]
    by_r = _dual_product((slope, bend * along), (_angular(2.0 * w), 2.0 * swapped))
    return np.asarray(0.5 * Y - _dual_times((beta, slope * along), twice) + _dual_outer(by_r, turned(X, once)))


def _is_small(r: Matrix) -> bool:
    """Whether series in r of the first order are exact to rounding, since loops are closed (EU-CLO-005)."""
    return bool(np.vdot(r, r) <= 1e-12)


# `log6_derivative_derivative` at r = 0, and what each entry of r adds near it.
_CROSS = _AD.reshape(6, 6, 6)  # of a unit motion the matrix of its product
_TURNS_AT_ZERO = 0.5 * _CROSS.transpose(1, 0, 2).ravel()
_TURNS_NEAR = np.einsum("akl,ilj->akij", _CROSS, _CROSS) + np.einsum("ali,lkj->akij", _CROSS, _CROSS)
_TURNS_NEAR = (-_TURNS_NEAR / 12.0 - 0.25 * np.einsum("ikl,alj->akij", _CROSS, _CROSS)).reshape(6, 216)


def _angular(w: Matrix) -> Matrix:
    """Rows (…, 6) over the angular part of a motion."""
    return np.concatenate((np.zeros_like(w), w), axis=-1)


def _dual_product(a: tuple[Matrix, Matrix], b: tuple[Matrix, Matrix]) -> tuple[Matrix, Matrix]:
    return a[0] * b[0], a[0] * b[1] + a[1] * b[0]


def _dual_times(a: tuple[Vector, Vector], columns: Matrix) -> Matrix:
    """A dual number (…, 1) times motions that are columns (…, 6, n)."""
    found = a[0][..., None] * columns
    found[..., :3, :] += a[1][..., None] * columns[..., 3:, :]
    return found


def _dual_outer(rows: tuple[Matrix, Matrix], motion: Matrix) -> Matrix:
    """Dual numbers that depend linearly on a motion, as rows (…, 6), times a motion (…, 6): a matrix (…, 6, 6)."""
    found = motion[..., :, None] * rows[0][..., None, :]
    found[..., :3, :] += motion[..., 3:, None] * rows[1][..., None, :]
    return found


def _dual(real: Vector, dual: Vector, motion: Matrix) -> Matrix:
    """A dual number times a motion (…, 6)."""
    scaled = real * motion
    scaled[..., :3] += dual * motion[..., 3:]
    return scaled


def exp6(v: Matrix) -> tuple[Matrix, Matrix]:
    """The rotations (…, 3, 3) and translations (…, 3), m, that twists (…, 6) lead to in unit time."""
    move, turn = v[..., :3], v[..., 3:]
    (a, b), _ = _exponential(turn)
    across = cross(turn, move)
    return rotation_of(quaternion_exp(turn)), move + a * across + b * cross(turn, across)


def exp6_derivative(v: Matrix) -> Matrix:
    """The right Jacobian (…, 6, 6) of exp6: the twist in the axes of the moved frame over the change of v (…, 6)."""
    V, W = skew(v[..., :3]), skew(v[..., 3:])
    (a, b), (a_slope, b_slope) = ([value[..., None] for value in values] for values in _exponential(v[..., 3:]))
    square, along = W @ W, 2.0 * _along(v[..., 3:], v[..., :3])[..., None]
    return _blocks(
        IDENTITY_ROTATION - a * W + b * square,
        -a * V - along * a_slope * W + b * _both(W, V) + along * b_slope * square,
    )


def _exponential(turn: Matrix) -> tuple[tuple[Vector, Vector], tuple[Vector, Vector]]:
    """a = (1 - cos θ) / t and b = (θ - sin θ) / θ³ (…, 1), and a′(t), b′(t); the left Jacobian is 1 + a W + b W²."""
    t = _along(turn, turn)
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
    return np.asarray(np.polyval(terms[::-1], -t))


def _along(a: Matrix, b: Matrix) -> Vector:
    return dot(a, b)[..., None]


def _scalar(s: Vector) -> Matrix:
    """s (…, 1) times the identity."""
    return np.asarray(s[..., None] * IDENTITY_ROTATION)


def _both(A: Matrix, B: Matrix) -> Matrix:
    """The derivative A B + B A of a square."""
    return np.asarray(A @ B + B @ A)


def _blocks(diagonal: Matrix, beside: Matrix) -> Matrix:
    J = np.zeros((*diagonal.shape[:-2], 6, 6))
    J[..., :3, :3] = J[..., 3:, 3:] = diagonal
    J[..., :3, 3:] = beside
    return J
