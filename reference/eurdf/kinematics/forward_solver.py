"""The acceleration of the closed mechanism: by the tree's own solver where it is beyond doubt, else by elimination."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.derived import derived
from eurdf.kinematics.equation_of_motion import Acceleration, EquationOfMotion
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tree_kinematics import ConstrainedDynamics, ConstrainedMotion
from eurdf.pinocchio.constrained_dynamics import build_constrained_dynamics

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Up to this condition number of the dimensionless K Kᵀ, the rows of K are independent beyond doubt. The smallest
#: singular value of K is then at least 1e-3 of the largest one, and `eurdf.kinematics.rank.numerical_rank` counts all
#: values that are above 3e-5 of it.
INDEPENDENT = 1e6

#: Residuals (m, rad) and their rates, relative to 1 plus the largest velocity, up to which the solver's drift is exact
#: to 1e-9.
CLOSED = 1e-11

#: Accepted error of the solver in either equation, relative to the largest term.
SOLVED = 1e-9


class ForwardSolver:
    """Solves the equation of motion of one robot at one state after the other, by one thread at a time."""

    def __init__(self, robot: Robot) -> None:
        # No reference to the robot: the cache would keep it alive.
        self._tree = robot.tree
        self._solver: ConstrainedDynamics | None = build_constrained_dynamics(robot)
        self._scale = derived(robot, TangentSpaces).dimensionless

    @cached_property
    def data(self) -> Any:
        """Memory of the whole tree."""
        return self._tree.memory()

    def solve(
        self,
        robot: Robot,
        q: Vector,
        v: Vector,
        force: Vector,
        gains: Sequence[tuple[float, float]],
        data: Any = None,
        *,
        nearly_closed: bool = False,
    ) -> Acceleration:
        """Solve M a + h = τ + Kᵀ λ and K a + K̇ v = -kd K v - kp r.

        Args:
            robot: The robot.
            q: Normalized configuration (nq,).
            v: Velocity (nv,).
            force: τ (nv,).
            gains: Baumgarte gains of each constraint: kp, 1/s², and kd, 1/s.
            data: Memory of the whole tree; by default its own.
            nearly_closed: Whether a drift will do that equals K̇ v only where the constraints hold and K v = 0, as
                between the steps of an integration, which start and end there.

        Raises:
            UndeterminedMotion: A joint without inertia can move.
        """
        data = self.data if data is None else data
        if self._solver is not None:
            found = self._solver.solve(q, v, force, gains, data)
            if self._is_beyond_doubt(found, q, v, force, data, nearly_closed):
                return Acceleration(found.a, found.lambdas)
        return EquationOfMotion(robot, q, v, data).eliminate(force, gains)

    def _is_beyond_doubt(
        self, found: ConstrainedMotion, q: Vector, v: Vector, force: Vector, data: Any, nearly_closed: bool
    ) -> bool:
        """Whether the constraints hold, their rows are independent, and the solution satisfies both equations."""
        a, K, carried = found.a, found.K, found.K.T @ found.lambdas
        if not (nearly_closed or (_largest(found.r) <= CLOSED and _largest(K @ v) <= CLOSED * (1.0 + _largest(v)))):
            return False
        if not _condition(K * self._scale) <= INDEPENDENT:
            return False
        wrong = self._tree.inverse_dynamics(q, v, a, data) - force - carried
        if not _largest(wrong) <= SOLVED * max(_largest(found.bias), _largest(force), _largest(carried)):
            return False
        terms = np.abs(K) @ np.abs(a) + np.abs(found.target)
        return _largest(K @ a - found.target) <= SOLVED * _largest(terms)


def _largest(values: Vector) -> float:
    return float(np.abs(values).max(initial=0.0))


def _condition(A: Matrix) -> float:
    """A bound of the condition number of A Aᵀ from above: ‖A Aᵀ‖ ‖(A Aᵀ)⁻¹‖ in Frobenius' norm."""
    square = A @ A.T
    try:
        inverse = np.linalg.inv(square).ravel()
    except np.linalg.LinAlgError:
        return math.inf
    square = square.ravel()
    return math.sqrt(square @ square) * math.sqrt(inverse @ inverse)
