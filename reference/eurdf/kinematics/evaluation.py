"""Residual and Jacobian of one group of constraints, dimensionless, over and over."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.evaluate import evaluator
from eurdf.kinematics.loop import LoopGroup

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


# Cost of the residual and Jacobian of one closure, in multiplications.
_WORK_OF_A_CLOSURE = 3e5


class Evaluation:
    """The residual of a group of constraints and its derivative, at one configuration after the other.

    Attributes:
        group: The group.
        row_scale: Factors (m,) that make the rows of its residual dimensionless.
        unit: Unit (n,) of each of its velocities.
        work: Multiplications for the smaller of A Aᵀ and Aᵀ A, and for the evaluation of A.
    """

    def __init__(self, robot: Robot, group: LoopGroup, row_scale: Vector, velocity_scale: Vector) -> None:
        """Prepare a group.

        Args:
            robot: The robot.
            group: The group.
            row_scale: Factors (nc,) that make the rows of the residual of the whole robot dimensionless.
            velocity_scale: Unit (nv,) of each velocity of the robot.
        """
        self.group = group
        self.row_scale = row_scale[group.rows]
        self.unit = velocity_scale[group.velocities]
        self._evaluator = evaluator(robot, group.closures, group.velocities, few=True)
        m, n = len(group.rows), len(group.velocities)
        self.work = float(m) * n * min(m, n) + _WORK_OF_A_CLOSURE * len(group.closures)
        self._at = self._evaluator.at(robot.tree.neutral()[None])
        self._held: Vector | None = None

    def holding(self, direction: Vector) -> Evaluation:
        """The same group, whose `jacobian` is zero along a unit direction (n,): no step moves along it."""
        other = copy.copy(self)
        other._held = direction
        return other

    @cached_property
    def _scale(self) -> Matrix:
        """Factors (m, n) that make the derivative dimensionless."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.row_scale[:, None] * self.unit

    def residual(self, q: Vector) -> Vector:
        """Rows (m,) of the group at q (nq,), m and rad."""
        self._at = self._evaluator.at(q[None])
        return np.asarray(self._evaluator.residual(self._at)[0])

    def jacobian(self) -> Matrix:
        """Derivative (m, n) of the rows by the velocities, where `residual` last was, dimensionless."""
        A: Matrix = self._evaluator.jacobian(self._at)[0] * self._scale
        return A if self._held is None else A - np.outer(A @ self._held, self._held)

    def openings(self) -> list[tuple[float, float]]:
        """How far each constraint is open where `residual` last was, m and rad."""
        lengths, angles = self._evaluator.openings(self._at)
        return list(zip(lengths[0].tolist(), angles[0].tolist(), strict=True))


def evaluations(
    robot: Robot, groups: Sequence[LoopGroup], row_scale: Vector, velocity_scale: Vector
) -> list[Evaluation]:
    """An evaluation of each group; for the arguments see `Evaluation`."""
    return [Evaluation(robot, group, row_scale, velocity_scale) for group in groups]
