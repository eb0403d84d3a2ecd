"""distance: the origins of A and B are as far apart as a rod is long."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.kind import CarriedVector, ClosureKind, RelativeMotions, RelativePoses, no_angle
from eurdf.closures.se3 import IDENTITY_ROTATION, dot, norm, outer, turned, velocity_of_origin
from eurdf.mechanism.constraint import Unit, key

_ONES = np.ones(3)


@dataclass(frozen=True, slots=True)
class DistanceClosure(ClosureKind):
    """EU-CLO-015: the origins of A and B are at a fixed distance: a massless rod between two ball joints.

    r = |p| - length, m, with p = ᴬp_B. At p = 0, where r has no derivative, u = p / |p| is taken along x of A.

    Attributes:
        length: The distance, m; positive.
    """

    type: ClassVar[str] = "distance"
    units: ClassVar[tuple[Unit, ...]] = ("m",)
    text: ClassVar[str] = "the origins of frames A and B are at a fixed distance, as those of the ball joints of a rod"
    called: ClassVar[str] = "rod bar link strut rope tendon"
    summary: ClassVar[str] = "Two frames whose origins are at a fixed distance."
    length: float = key(
        "Length", "Distance between the origins of A and B, m, at least 0.0001.", least=1e-4, example=0.155
    )

    @classmethod
    def prepare(cls, closures: Sequence[DistanceClosure]) -> Vector:
        """The lengths (k,)."""
        return np.array([closure.length for closure in closures])

    @staticmethod
    def of_distance(p: Matrix, velocity: Matrix, fixed: Vector) -> tuple[Vector, Matrix, Vector]:
        """|p| - length, u, and (|ṗ|² - (u · ṗ)²) / |p|; not finite at p = 0."""
        distance = np.sqrt((p * p).dot(_ONES))  # for few, sooner than by `dot`
        u = p / distance[:, None]
        along = (u * velocity).dot(_ONES)
        return distance - fixed, u, ((velocity * velocity).dot(_ONES) - along * along) / distance

    @staticmethod
    def residual(poses: RelativePoses, fixed: Vector) -> Matrix:
        """|p| - length (EU-CLO-015)."""
        return (poses.once(_direction, fixed)[1] - fixed)[..., None]

    @staticmethod
    def jacobian(poses: RelativePoses, fixed: Vector) -> Matrix:
        """[uᵀ, 0]: u is across ω × p."""
        u, _ = poses.once(_direction, fixed)
        return np.concatenate((u, np.zeros_like(u)), axis=-1)[..., None, :]

    @staticmethod
    def drift(motions: RelativeMotions, fixed: Vector) -> Matrix:
        """u · p̈ + (|ṗ|² - (u · ṗ)²) / |p|."""
        u, distance = motions.poses.once(_direction, fixed)
        velocity = motions.velocity
        across = dot(velocity, velocity) - dot(u, velocity) ** 2
        if not distance.all():
            across, distance = np.where(distance > 0.0, across, 0.0), np.where(distance > 0.0, distance, 1.0)
        return np.asarray(dot(u, motions.acceleration) + across / distance)[..., None]

    @staticmethod
    def jacobian_derivative(poses: RelativePoses, fixed: Vector) -> Matrix:
        """That of |p|, whose second derivative is Π / |p| with Π = 1 - u uᵀ."""
        return _carried(poses, fixed).jacobian_derivative()

    @staticmethod
    def bend_derivative(poses: RelativePoses, fixed: Vector, twist: Matrix) -> Matrix:
        """That of ṗᵀ Π ṗ / |p| + u · (ω × ṗ)."""
        return _carried(poses, fixed).bend_derivative(twist)

    @staticmethod
    def opening(poses: RelativePoses, fixed: Vector) -> tuple[Vector, Vector]:
        """|r|; the angle is free."""
        return no_angle(np.abs(poses.once(_direction, fixed)[1] - fixed))


KIND = DistanceClosure


def _carried(poses: RelativePoses, fixed: Vector) -> CarriedVector:
    """|p| as a function of p; at p = 0 without further derivatives."""
    u, distance = poses.once(_direction, fixed)
    inverse = np.divide(1.0, distance, out=np.zeros_like(distance), where=distance > 0.0)[..., None]
    bend = inverse[..., None] * (IDENTITY_ROTATION - outer(u, u))

    def third(rate: Matrix) -> Matrix:
        """-(2 (u · ṗ) Π ṗ + (ṗᵀ Π ṗ) u) / |p|²."""
        across = turned(bend, rate)
        found = 2.0 * dot(u, rate)[..., None] * across + dot(rate, across)[..., None] * u
        return np.asarray(-inverse * found)[..., None, :]

    return CarriedVector(velocity_of_origin(poses.position), u[..., None, :], bend[..., None, :, :], third)


def _direction(poses: RelativePoses, fixed: Vector) -> tuple[Matrix, Vector]:
    """u (…, 3) and |p| (…)."""
    p = poses.position
    distance = norm(p)
    if distance.all():
        return p / distance[..., None], distance
    u = np.zeros_like(p)
    u[..., 0] = 1.0
    np.divide(p, distance[..., None], out=u, where=distance[..., None] > 0.0)
    return u, distance
