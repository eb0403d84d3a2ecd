"""The joint types: how joints move their children, for arrays of coordinates (EU-JNT-015 to -018, EU-JNT-025).

Components come first and elements last, as in `eurdf.kinematics.batch.rigid`. Coordinates and velocities are those of
Pinocchio: an angle without limits is (cos, sin), and the velocity of planar, spherical and floating joints is that of
the moving frame, in its own axes (EU-JNT-026).
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.batch import rigid
from eurdf.mechanism.joint import Joint


class Motion(ABC):
    """How a joint moves its child's frame.

    Attributes:
        nq: Number of coordinates.
        nv: Number of velocities.
    """

    nq: int
    nv: int

    @abstractmethod
    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """Rotation (3, 3, B) and translation (3, B), m, of the moving frame in the frame at rest."""

    @abstractmethod
    def twists(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """Linear and angular parts (3, nv, B) of the twists for unit velocities, in the axes of the moving frame."""

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """The coordinates (nq, B) that the velocities (nv, B) lead to in unit time."""
        return q + v

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """The velocities (nv, B) that lead from q to the other coordinates in unit time."""
        return other - q

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        """Derivative (nv, nv, B) of `difference` by the motion of the other coordinates."""
        return _repeated(np.eye(self.nv), q)

    def normalized(self, q: Matrix) -> Matrix:
        """The coordinates with quaternions, or cosine and sine, of unit length."""
        return q


class Screw(Motion):
    """Revolute, prismatic, helical, and continuous with an unwrapped angle: one number along one axis."""

    nq = nv = 1

    def __init__(self, axis: Vector, turn: float, advance: float) -> None:
        """``axis`` is a unit vector; the joint turns by ``turn`` rad and advances by ``advance`` m per unit."""
        self._turn, self._advance = turn * axis, advance * axis
        self._rotation = _Rotation(axis) if turn else None

    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        turn = self._rotation
        R = _repeated(np.eye(3), q) if turn is None else turn(np.cos(q[0]), np.sin(q[0]))
        return R, self._advance[:, None] * q[0]

    def twists(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return _repeated(self._advance[:, None], q), _repeated(self._turn[:, None], q)


class Continuous(Motion):
    """A turn about an axis, as (cos, sin)."""

    nq, nv = 2, 1

    def __init__(self, axis: Vector) -> None:
        self._axis = axis
        self._rotation = _Rotation(axis)

    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return self._rotation(q[0], q[1]), np.zeros((3, q.shape[1]))

    def twists(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return np.zeros((3, 1, q.shape[1])), _repeated(self._axis[:, None], q)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """See `Motion`."""
        return _complex_product(q, np.concatenate((np.cos(v), np.sin(v))))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """See `Motion`."""
        return _angle_between(q, other)[None]

    def normalized(self, q: Matrix) -> Matrix:
        """See `Motion`."""
        return np.asarray(q / np.hypot(q[0], q[1]))


class Planar(Motion):
    """x and y, m, and a turn about z as (cos, sin)."""

    nq, nv = 4, 3

    def __init__(self) -> None:
        self._rotation = _Rotation(np.array([0.0, 0.0, 1.0]))

    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return self._rotation(q[2], q[3]), np.concatenate((q[:2], np.zeros((1, q.shape[1]))))

    def twists(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return _repeated(np.eye(6)[:3, [0, 1, 5]], q), _repeated(np.eye(6)[3:, [0, 1, 5]], q)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """See `Motion`."""
        along, across = _turning(v[2])
        step = np.stack((along * v[0] - across * v[1], across * v[0] + along * v[1]))
        angle = _complex_product(q[2:], np.stack((np.cos(v[2]), np.sin(v[2]))))
        return np.concatenate((q[:2] + _complex_product(q[2:], step), angle))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """See `Motion`."""
        angle = _angle_between(q[2:], other[2:])
        back = np.stack((q[2], -q[3]))
        along, across = _turning(angle)
        step = _complex_product(back, other[:2] - q[:2])
        move = _complex_product(np.stack((along, -across)), step) / (along**2 + across**2)
        return np.concatenate((move, angle[None]))

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        """See `Motion`: the block of Jlog6 for motions in the plane."""
        return _of_pose_difference(self, q, other)[np.ix_([0, 1, 5], [0, 1, 5])]

    def normalized(self, q: Matrix) -> Matrix:
        """See `Motion`."""
        return np.concatenate((q[:2], q[2:] / np.hypot(q[2], q[3])))


class Spherical(Motion):
    """A unit quaternion, x, y, z, w."""

    nq, nv = 4, 3

    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return rigid.of_quaternion(q), np.zeros((3, q.shape[1]))

    def twists(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return np.zeros((3, 3, q.shape[1])), _repeated(np.eye(3), q)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """See `Motion`."""
        return rigid.quaternion_product(q, rigid.quaternion_exp(v))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """See `Motion`."""
        return rigid.log_of_quaternion(rigid.quaternion_product(rigid.conjugate(q), other))

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        """See `Motion`."""
        return rigid.jacobian_log3(self.difference(q, other))

    def normalized(self, q: Matrix) -> Matrix:
        """See `Motion`."""
        return np.asarray(q / rigid.norm(q))


class Floating(Motion):
    """A position x, y, z, m, and a unit quaternion x, y, z, w."""

    nq, nv = 7, 6

    def pose(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return rigid.of_quaternion(q[3:]), q[:3]

    def twists(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """See `Motion`."""
        return _repeated(np.eye(6)[:3], q), _repeated(np.eye(6)[3:], q)

    def integrate(self, q: Matrix, v: Matrix) -> Matrix:
        """See `Motion`."""
        p = q[:3] + rigid.turned(rigid.of_quaternion(q[3:]), rigid.translation_exp(v[:3], v[3:]))
        return np.concatenate((p, rigid.quaternion_product(q[3:], rigid.quaternion_exp(v[3:]))))

    def difference(self, q: Matrix, other: Matrix) -> Matrix:
        """See `Motion`."""
        return np.concatenate(rigid.log6(*_relative(self, q, other)))

    def difference_derivative(self, q: Matrix, other: Matrix) -> Matrix:
        """See `Motion`."""
        return _of_pose_difference(self, q, other)

    def normalized(self, q: Matrix) -> Matrix:
        """See `Motion`."""
        return np.concatenate((q[:3], q[3:] / rigid.norm(q[3:])))


def motions(joint: Joint, *, unwrapped: bool) -> list[Motion]:
    """How a joint that is not fixed moves: its motions in series.

    Args:
        joint: The joint.
        unwrapped: Whether the coordinate of a continuous joint is an unwrapped angle instead of (cos, sin).
    """
    kind = joint.type
    if kind.moving_frame:
        return [Planar() if kind.quaternion is None else Floating() if kind.slides else Spherical()]
    if not kind.limited and not unwrapped:
        return [Continuous(np.array(joint.motions[0].axis))]
    return [Screw(np.array(axis), float(turns), advance) for axis, turns, advance in joint.motions]


class _Rotation:
    """Rotations about one unit axis: a aᵀ + c (1 - a aᵀ) + s [a]ₓ."""

    def __init__(self, axis: Vector) -> None:
        along = np.outer(axis, axis)
        self._parts = tuple(part[:, :, None] for part in (along, np.eye(3) - along, rigid.skew(axis)))

    def __call__(self, cosine: Vector, sine: Vector) -> Matrix:
        """Of angles with these cosines and sines (B,)."""
        along, across, around = self._parts
        return np.asarray(along + across * cosine + around * sine)


def _repeated(constant: Matrix, q: Matrix) -> Matrix:
    """A constant, once for each element of q; read only."""
    return np.broadcast_to(constant[..., None], (*constant.shape, q.shape[1]))


def _complex_product(a: Matrix, b: Matrix) -> Matrix:
    """Products of numbers a + b i, (2, B)."""
    return np.stack((a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]))


def _angle_between(a: Matrix, b: Matrix) -> Vector:
    return np.asarray(np.arctan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]))


def _turning(angle: Vector) -> tuple[Vector, Vector]:
    """Sin θ / θ and (1 - cos θ) / θ."""
    return np.sinc(angle / np.pi), 0.5 * angle * np.sinc(0.5 * angle / np.pi) ** 2


def _relative(joint: Motion, q: Matrix, other: Matrix) -> tuple[Matrix, Matrix]:
    """Poses of the other coordinates, seen from those of q."""
    (R, p), (R_other, p_other) = joint.pose(q), joint.pose(other)
    return rigid.product(rigid.transposed(R), R_other), rigid.turned_back(R, p_other - p)


def _of_pose_difference(joint: Motion, q: Matrix, other: Matrix) -> Matrix:
    return rigid.jacobian_log6(*_relative(joint, q, other))
