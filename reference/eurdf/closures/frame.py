"""6d: B is at A, in position and orientation: a weld."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.kind import ClosureKind, Contact, RelativeMotions, RelativePoses
from eurdf.closures.point import PointClosure
from eurdf.closures.se3 import log6_bend_derivative, log6_derivative_derivative, log6_second
from eurdf.mechanism.constraint import Unit


@dataclass(frozen=True, slots=True)
class FrameClosure(ClosureKind):
    """EU-CLO-008: B is at A in position and orientation: a weld. r = log6(ᴬM_B), linear and angular, m and rad."""

    type: ClassVar[str] = "6d"
    units: ClassVar[tuple[Unit, ...]] = ("m",) * 3 + ("rad",) * 3
    text: ClassVar[str] = "their orientations also agree"
    called: ClassVar[str] = "weld welded fixed lock rigid pose"
    since: ClassVar[Literal["1", "2.1"]] = "1"

    def with_orientation_free(self) -> PointClosure:
        """The 3d closure of the same frames."""
        return PointClosure(self.name, self.a, self.b)

    def contacts(self) -> tuple[Contact]:
        """The frames."""
        return (Contact(is_frame=True),)

    @staticmethod
    def residual(poses: RelativePoses, fixed: Any) -> Matrix:
        """log6(ᴬM_B)."""
        return poses.logarithm()

    @staticmethod
    def jacobian(poses: RelativePoses, fixed: Any) -> Matrix:
        """Jlog6(ᴮM_A)."""
        return poses.logarithm_by_twist()

    @staticmethod
    def drift(motions: RelativeMotions, fixed: Any) -> Matrix:
        """The second derivative of log6(ᴬM_B)."""
        return log6_second(motions.poses.logarithm(), motions.twist, motions.change)

    @staticmethod
    def jacobian_derivative(poses: RelativePoses, fixed: Any) -> Matrix:
        """That of Jlog6(ᴮM_A)."""
        return log6_derivative_derivative(poses.logarithm(), poses.logarithm_by_twist())

    @staticmethod
    def bend_derivative(poses: RelativePoses, fixed: Any, twist: Matrix) -> Matrix:
        """That of the second derivative of log6(ᴬM_B) at a constant twist."""
        return log6_bend_derivative(poses.logarithm(), poses.logarithm_by_twist(), twist)

    @staticmethod
    def opening(poses: RelativePoses, fixed: Any) -> tuple[Vector, Vector]:
        """|p| and the angle of ᴬR_B."""
        return np.hypot.reduce(poses.position, axis=-1), np.hypot.reduce(poses.logarithm()[..., 3:], axis=-1)


KIND = FrameClosure


def kind_of_target(is_pose: bool) -> type[ClosureKind]:
    """The closure that holds a frame at a target in the world: at a pose, or at a position."""
    return FrameClosure if is_pose else PointClosure
