"""A turn about one axis that is held: of no file, but of a ball joint that may not turn about some of its axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.closures.frame import FrameClosure
from eurdf.closures.kind import ClosureKind, RelativeMotions, RelativePoses
from eurdf.mechanism.constraint import Unit


@dataclass(frozen=True, slots=True)
class HeldTurn(ClosureKind):
    """B is turned against A about axes across one: r = eᵀ log3(ᴬR_B), rad, with the unit vector e in the axes of both.

    The rotation is then a swing without a twist about e. The rows are those of `FrameClosure`, whose origins coincide.

    Attributes:
        axis: Number of the axis e: 0 for x, 1 for y, 2 for z.
    """

    type: ClassVar[str] = "turn"
    units: ClassVar[tuple[Unit, ...]] = ("rad",)
    text: ClassVar[str] = "frame B is not turned against frame A about one axis"
    axis: int

    @classmethod
    def prepare(cls, closures: Sequence[HeldTurn]) -> Matrix:
        """Which of the rows of `FrameClosure` is theirs, (k, 1, 6)."""
        return np.eye(6)[[[3 + closure.axis] for closure in closures]]

    @staticmethod
    def residual(poses: RelativePoses, fixed: Matrix) -> Matrix:
        """eᵀ log3(ᴬR_B)."""
        return (fixed @ FrameClosure.residual(poses, None)[..., None])[..., 0]

    @staticmethod
    def jacobian(poses: RelativePoses, fixed: Matrix) -> Matrix:
        """Its derivative."""
        return fixed @ FrameClosure.jacobian(poses, None)

    @staticmethod
    def drift(motions: RelativeMotions, fixed: Matrix) -> Matrix:
        """Its second derivative."""
        return (fixed @ FrameClosure.drift(motions, None)[..., None])[..., 0]

    @staticmethod
    def jacobian_derivative(poses: RelativePoses, fixed: Matrix) -> Matrix:
        """Its rows of those of `FrameClosure`."""
        return np.asarray(np.einsum("krs,...ksij->...krij", fixed, FrameClosure.jacobian_derivative(poses, None)))

    @staticmethod
    def bend_derivative(poses: RelativePoses, fixed: Matrix, twist: Matrix) -> Matrix:
        """Its rows of those of `FrameClosure`."""
        return np.asarray(fixed @ FrameClosure.bend_derivative(poses, None, twist))

    @staticmethod
    def opening(poses: RelativePoses, fixed: Matrix) -> tuple[Vector, Vector]:
        """|r|; lengths are free."""
        turns = np.abs(HeldTurn.residual(poses, fixed)[..., 0])
        return np.zeros_like(turns), turns
