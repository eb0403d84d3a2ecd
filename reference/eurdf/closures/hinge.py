"""hinge: the origin of B is at the origin of A, and an axis of B along an axis of A: a revolute joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.kind import CarriedVector, ClosureKind, Contact, RelativeMotions, RelativePoses
from eurdf.closures.point import PointClosure
from eurdf.closures.se3 import cross, dot, norm, outer, plane_across, skew, transposed, turned, velocity_of_origin
from eurdf.mechanism.constraint import ClosureKey, Form, Unit, key
from eurdf.mechanism.pose import Vector3, direction

# Distance of the second contact from the origin, m.
_ON_AXIS = 0.1

# The sine of θ near half a turn, where the shortest rotation has no derivative, is taken as no less than this.
_LEAST_SINE = 1e-9
_MOST_STRETCH = np.pi / _LEAST_SINE

# Added to an angle or a length that can be 0 and divides; to what is not 0, it adds nothing.
_TINY = 1e-300

# The coordinates of a vector in a plane, swapped, times these are those of the vector turned by a quarter.
_QUARTER_TURN = np.array((-1.0, 1.0))

# Coefficients of the series of θ / sin θ in powers of cos θ - 1, for angles below _SMALL rad, where the quotients of
# the second derivative are of small numbers: each is -(n + 1) / (2n + 3) of the one before.
_SERIES = np.poly1d(np.cumprod([1.0, *(-(n + 1.0) / (2.0 * n + 3.0) for n in range(9))])[::-1])
_SLOPES = _SERIES.deriv(), _SERIES.deriv(2), _SERIES.deriv(3)
_SMALL = 0.1


class Axes(NamedTuple):
    """The axes of k hinges, of unit length.

    Attributes:
        a: Axis (k, 3) in A.
        b: Axis (k, 3) in B.
        plane: Eᵀ (k, 2, 3), whose rows span the plane across a.
        onto: F = (Eᵀ [a]ₓ; aᵀ) (k, 3, 3), a rotation.
        onto_by_rotation: Fβ over the entries of ᴬR_B (k, 9, 3).
    """

    a: Matrix
    b: Matrix
    plane: Matrix
    onto: Matrix
    onto_by_rotation: Matrix


class _Turn(NamedTuple):
    """How k hinges are turned.

    Attributes:
        theta: The angle θ (…, k, 1) from a to β, in [0, π].
        n: Eᵀ n (…, k, 2) of the unit vector n about which it turns.
    """

    theta: Matrix
    n: Matrix


@dataclass(frozen=True, slots=True)
class HingeClosure(ClosureKind):
    """EU-CLO-014: the origin of B is at the origin of A, and an axis of B is along an axis of A: a revolute joint.

    r = (p, Eᵀ s), m and rad. s is the shortest rotation vector that takes axis a of A to β, axis b of B seen from A: of
    the angle θ, with c = cos θ = a · β and g = θ / sin θ, s = g a × β = θ n. E (3, 2) spans the plane across a. Where
    β = -a, s is half a turn about the first column of E, as the logarithm of a half turn is one of two.

    Attributes:
        axes: The axis in A and the axis in B, of any length but zero.
    """

    type: ClassVar[str] = "hinge"
    units: ClassVar[tuple[Unit, ...]] = ("m",) * 3 + ("rad",) * 2
    text: ClassVar[str] = "the origin of frame B is held on that of A, and an axis of B along an axis of A"
    called: ClassVar[str] = "pin revolute rotary rotational continuous"
    axes: tuple[Vector3, Vector3] = key(
        "Axes",
        "The axis in frame A, and the axis in frame B: vectors of any length but zero, no unit.",
        example=[[0, 0, 1], [0, 1, 0]],
    )

    @classmethod
    def forms(cls) -> tuple[Form, Form]:
        """With ``axis`` where A and B have the same one, else with ``axes``."""
        axis = ClosureKey(
            "Axis",
            "The axis in frame A and in frame B: a vector of any length but zero, no unit.",
            [0, 1, 0],
            type="Vector3",
            default=(0.0, 0.0, 1.0),
        )
        about_two = "A hinge that holds an axis of frame B along an axis of frame A."
        return (
            Form("Hinge", "Hinge closure", "A hinge about one axis, which both frames have.", {"axis": axis}),
            Form("HingeAboutTwo", "Hinge closure with two axes", about_two, cls.keys()),
        )

    @classmethod
    def values_of(cls, stated: Mapping[str, Any]) -> Mapping[str, Any]:
        """The axes."""
        return {"axes": (stated["axis"], stated["axis"])} if "axis" in stated else stated

    def stated(self) -> dict[str, Any]:
        """``axis`` or ``axes``."""
        one, other = self.axes
        return {"axis": one} if one == other else {"axes": self.axes}

    def with_orientation_free(self) -> PointClosure:
        """The 3d closure of the same frames."""
        return PointClosure(self.name, self.a, self.b)

    def contacts(self) -> tuple[Contact, Contact]:
        """The origin, and a point on the axis."""
        a, b = ((_ON_AXIS * x, _ON_AXIS * y, _ON_AXIS * z) for x, y, z in map(direction, self.axes))
        return Contact(), Contact("/axis", a=a, b=b)

    def forces_of_contacts(self) -> Matrix:
        """The force is the sum of both; the moment Eᵀ (x × f) is that of the force f at x on the axis."""
        axis = np.array(direction(self.axes[0]))
        L = np.zeros((5, 6))
        L[:3, :3] = L[:3, 3:] = np.eye(3)
        L[3:, 3:] = plane_across(axis).T @ skew(_ON_AXIS * axis)
        return L

    @classmethod
    def prepare(cls, closures: Sequence[HingeClosure]) -> Axes:
        """The axes, made unit vectors."""
        axes = np.array([closure.axes for closure in closures], dtype=np.float64)
        axes /= np.abs(axes).max(axis=2, keepdims=True)  # of any length, also of one whose square is out of range
        axes /= norm(axes)[..., None]
        a, b = axes[:, 0], axes[:, 1]
        plane = np.array([plane_across(each).T for each in a])
        onto = np.concatenate((plane @ skew(a), a[:, None]), axis=1)
        return Axes(a, b, plane, onto, np.einsum("kri,kj->kijr", onto, b).reshape(-1, 9, 3))

    @staticmethod
    def residual(poses: RelativePoses, fixed: Axes) -> Matrix:
        """p and Eᵀ s."""
        theta, n = poses.once(_turn, fixed)
        return np.concatenate((poses.position, theta * n), axis=-1)

    @staticmethod
    def jacobian(poses: RelativePoses, fixed: Axes) -> Matrix:
        """[1, -skew(p); 0, Eᵀ S], where ṡ = S ω = g a × (ω × β) + (1 - g c) (n · ω) n.

        With Eᵀ n = (n₁, n₂), Eᵀ S = Eᵀ + (-n₂, n₁)ᵀ ((1 - g c) n₁, (1 - g c) n₂, θ) F.
        """
        theta, n = poses.once(_turn, fixed)
        angle = theta + _TINY
        along = np.concatenate(((1.0 - np.maximum(angle / np.tan(angle), -_MOST_STRETCH)) * n, theta), axis=-1)
        rows = np.zeros((*n.shape[:-1], 5, 6))
        rows[..., :3, :] = velocity_of_origin(poses.position)
        rows[..., 3:, 3:] = fixed.plane + (n[..., ::-1] * _QUARTER_TURN)[..., None] * (along[..., None, :] @ fixed.onto)
        return rows

    @staticmethod
    def drift(motions: RelativeMotions, fixed: Axes) -> Matrix:
        """p̈ and Eᵀ s̈, with s̈ = g a × β̈ + 2 g' ċ a × β̇ + (g' c̈ + g'' ċ²) a × β."""
        a = fixed.a
        beta = turned(motions.poses.rotation, fixed.b)
        g, slope, bend, _ = _profile(motions.poses.once(_turn, fixed).theta)
        omega = motions.omega
        rate = cross(omega, beta)
        second = cross(motions.alpha, beta) + cross(omega, rate)
        c_rate, c_second = dot(a, rate)[..., None], dot(a, second)[..., None]
        s = g * cross(a, second) + 2.0 * slope * c_rate * cross(a, rate)
        s += (slope * c_second + bend * c_rate**2) * cross(a, beta)
        return np.concatenate((motions.acceleration, turned(fixed.plane, s)), axis=-1)

    @staticmethod
    def jacobian_derivative(poses: RelativePoses, fixed: Axes) -> Matrix:
        """That of p, and of Eᵀ s as a function of β."""
        of_point = PointClosure.jacobian_derivative(poses, None)
        return np.concatenate((of_point, _carried(poses, fixed).jacobian_derivative()), axis=-3)

    @staticmethod
    def bend_derivative(poses: RelativePoses, fixed: Axes, twist: Matrix) -> Matrix:
        """That of p, and of Eᵀ s as a function of β."""
        of_point = PointClosure.bend_derivative(poses, None, twist)
        return np.concatenate((of_point, _carried(poses, fixed).bend_derivative(twist)), axis=-2)

    @staticmethod
    def opening(poses: RelativePoses, fixed: Axes) -> tuple[Vector, Vector]:
        """|p| and θ."""
        return np.hypot.reduce(poses.position, axis=-1), poses.once(_turn, fixed).theta[..., 0]


KIND = HingeClosure


def _turn(poses: RelativePoses, axes: Axes) -> _Turn:
    R = poses.rotation
    seen = (R.reshape(*R.shape[:-2], 1, 9) @ axes.onto_by_rotation)[..., 0, :]  # Eᵀ (a × β), and a · β
    seen[..., 0] += _TINY  # where sin θ is 0, n is the first column of E
    sine = np.hypot(seen[..., :1], seen[..., 1:2])
    return _Turn(np.arctan2(sine, seen[..., 2:]) - _TINY, seen[..., :2] / sine)


def _carried(poses: RelativePoses, axes: Axes) -> CarriedVector:
    """Eᵀ s = g(c) Eᵀ (a × β), with c = a · β, as a function of β."""
    beta = turned(poses.rotation, axes.b)
    theta, n = poses.once(_turn, axes)
    g, slope, bend, third = (each[..., None] for each in _profile(theta))
    across, a, normal = axes.onto[..., :2, :], axes.a[..., None, :], (np.sin(theta) * n)[..., None]
    along = outer(axes.a, axes.a)[..., None, :, :]
    mixed = across[..., :, None] * a[..., None, :]
    second = slope[..., None] * (mixed + transposed(mixed)) + (bend * normal)[..., None] * along

    def along_rates(rate: Matrix) -> Matrix:
        c = dot(axes.a, rate)[..., None, None]
        both = c * c * across + 2.0 * c * (across @ rate[..., None]) * a
        return np.asarray(bend * both + third * c * c * normal * a)

    by_twist = np.zeros((*beta.shape, 6))
    by_twist[..., 3:] = -skew(beta)
    return CarriedVector(by_twist, g * across + slope * normal * a, second, along_rates)


def _profile(theta: Vector) -> tuple[Vector, Vector, Vector, Vector]:
    """g = θ / sin θ, and its derivatives by c = cos θ up to the third.

    They satisfy (1 - c²) g′ = c g - 1, (1 - c²) g″ = 3 c g′ + g and (1 - c²) g‴ = 5 c g″ + 4 g′.
    """
    angle, c = theta + _TINY, np.cos(theta)
    g = np.minimum(angle / np.sin(angle), _MOST_STRETCH)
    squares = np.maximum(np.sin(theta), _LEAST_SINE) ** 2
    slope = (c * g - 1.0) / squares
    bend = (3.0 * c * slope + g) / squares
    third = (5.0 * c * bend + 4.0 * slope) / squares
    small, away = theta < _SMALL, -2.0 * np.sin(0.5 * theta) ** 2  # cos θ - 1
    found = zip(_SLOPES, (slope, bend, third), strict=True)
    return g, *(np.where(small, series(away), quotient) for series, quotient in found)  # type: ignore[return-value]
