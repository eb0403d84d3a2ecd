"""3d: the origin of B is at the origin of A: a ball joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.kind import ClosureKind, Contact, RelativeMotions, RelativePoses, no_angle
from eurdf.closures.se3 import skew, velocity_of_origin
from eurdf.mechanism.constraint import Unit


@dataclass(frozen=True, slots=True)
class PointClosure(ClosureKind):
    """EU-CLO-009: the origin of B is at the origin of A: a ball joint. r = p, m, with p = ᴬp_B."""

    type: ClassVar[str] = "3d"
    units: ClassVar[tuple[Unit, ...]] = ("m",) * 3
    text: ClassVar[str] = "the origins of frames A and B coincide"
    called: ClassVar[str] = "ball point point_to_point connect position spherical"
    since: ClassVar[Literal["1", "2.1"]] = "1"

    def contacts(self) -> tuple[Contact]:
        """The origins."""
        return (Contact(),)

    @staticmethod
    def residual(poses: RelativePoses, fixed: Any) -> Matrix:
        """The origin of B in A."""
        return poses.position

    @staticmethod
    def jacobian(poses: RelativePoses, fixed: Any) -> Matrix:
        """[1, -skew(p)]."""
        return velocity_of_origin(poses.position)

    @staticmethod
    def drift(motions: RelativeMotions, fixed: Any) -> Matrix:
        """p̈."""
        return motions.acceleration

    @staticmethod
    def jacobian_derivative(poses: RelativePoses, fixed: Any) -> Matrix:
        """That of ω × ṗ, linear in p."""
        p = poses.position
        return np.asarray((p @ _TURNED + _TURNED_AT_ZERO).reshape(*p.shape, 6, 6))

    @staticmethod
    def bend_derivative(poses: RelativePoses, fixed: Any, twist: Matrix) -> Matrix:
        """That of ω × ṗ: ω × (ω × δp)."""
        W = skew(twist[..., 3:])
        return np.asarray(W @ (W @ velocity_of_origin(poses.position)))

    @staticmethod
    def opening(poses: RelativePoses, fixed: Any) -> tuple[Vector, Vector]:
        """|p|; the angle is free."""
        return no_angle(np.hypot.reduce(poses.position, axis=-1))


KIND = PointClosure


# The derivative of ω × ṗ: entry m of ω times e_m × [1, -skew(p)], at the origin, and what each entry of p adds.
_EACH = np.zeros((4, 3, 6, 6))
_EACH[:, :, 3:] = np.einsum("mij,pjk->pimk", skew(np.eye(3)), velocity_of_origin(np.eye(4, 3, k=-1)))
_TURNED_AT_ZERO = _EACH[0].ravel()
_TURNED = _EACH[1:].reshape(3, -1) - _TURNED_AT_ZERO
