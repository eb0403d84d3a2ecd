"""3d: the origin of B is at the origin of A: a ball joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.kind import ClosureKind, Contact, RelativeMotions, RelativePoses, no_angle
from eurdf.closures.se3 import velocity_of_origin
from eurdf.mechanism.constraint import Unit


@dataclass(frozen=True, slots=True)
class PointClosure(ClosureKind):
    """EU-CLO-009: the origin of B is at the origin of A: a ball joint. r = p, m, with p = ᴬp_B."""

    type: ClassVar[str] = "3d"
    units: ClassVar[tuple[Unit, ...]] = ("m",) * 3
    text: ClassVar[str] = "the origins of frames A and B coincide"
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
    def opening(poses: RelativePoses, fixed: Any) -> tuple[Vector, Vector]:
        """|p|; the angle is free."""
        return no_angle(np.hypot.reduce(poses.position, axis=-1))


KIND = PointClosure
