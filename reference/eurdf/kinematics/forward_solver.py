"""The acceleration of the closed mechanism: by the tree's own solver if that is beyond doubt, else by elimination."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.equation_of_motion import Acceleration, EquationOfMotion
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.independence import Independence, norm
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.rank import solutions
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED_FOR_FORCES, FORCES_SOLVED
from eurdf.pinocchio.constrained_dynamics import (
    ConstrainedDynamics,
    ConstrainedMotion,
    StatedGains,
    build_constrained_dynamics,
)
from eurdf.pinocchio.tree_dynamics import TreeDynamics

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class ForwardSolver:
    """Solves the equation of motion of one robot at one state after the other, by one thread at a time.

    Attributes:
        gains: The Baumgarte gains that the constraint models have.
        rows: Of each constraint its rows.
    """

    def __init__(self, robot: Robot) -> None:
        # No reference to the robot: the cache would keep it alive.
        self._tree = robot.tree
        self._solver: ConstrainedDynamics | None = build_constrained_dynamics(robot)
        self.gains = StatedGains(robot)
        self.rows = tuple(loop.rows for loop in find_loops(robot))
        spaces = robot.cached(TangentSpaces)
        self._independence = Independence(spaces.row_scale, spaces.scale)
        self._combinations: Matrix | None = None  # of redundant rows, as many as are independent
        self._own: TreeDynamics | None = None

    @property
    def own(self) -> TreeDynamics:
        """The dynamics of the tree, in memory that is made on first use and kept."""
        if self._own is None:
            self._own = self._tree.dynamics()
        return self._own

    def dynamics(self, data: Any) -> TreeDynamics:
        """Those in the given `pin.Data`, or its own if there is none.

        Raises:
            ValueError: It is no `pin.Data`, or one of another model.
        """
        return self.own if data is None else self._tree.dynamics(data)

    def solve(
        self,
        robot: Robot,
        q: Vector,
        v: Vector,
        force: Vector,
        gains: list[tuple[float, float]],
        dynamics: TreeDynamics,
        *,
        nearly_closed: bool = False,
        within_step: bool = False,
    ) -> Acceleration:
        """Solve M a + h = τ + Kᵀ λ and K a + K̇ v = -kd K v - kp r.

        Args:
            robot: The robot.
            q: Normalized configuration (nq,).
            v: Velocity (nv,).
            force: τ (nv,).
            gains: Baumgarte gains of each constraint: kp, 1/s², and kd, 1/s.
            dynamics: Those of the tree.
            nearly_closed: Whether a drift will do that equals K̇ v only where the constraints hold and K v = 0, as
                between the steps of an integration, which start and end there.
            within_step: Whether the state is one between these steps, and the step began at the last one that was not.

        Raises:
            UndeterminedMotion: A joint without inertia can move.
            NumericalOverflow: The result is not finite.
        """
        solution = self.beyond_doubt(q, v, force, gains, dynamics, nearly_closed=nearly_closed, within_step=within_step)
        if solution is None:
            solution = _eliminated(robot, q, v, force, gains, dynamics)
        return solution

    def beyond_doubt(
        self,
        q: Vector,
        v: Vector,
        force: Vector,
        gains: list[tuple[float, float]],
        dynamics: TreeDynamics,
        *,
        nearly_closed: bool = False,
        within_step: bool = False,
    ) -> Acceleration | None:
        """The solution by the tree's own solver, as `solve`; None if it has none, or if the solution is in doubt.

        It is, unless the constraints hold, the rank of K is certain, and the solution satisfies both equations.
        """
        if self._solver is None:
            return None
        found = self._solver.solve(q, v, force, gains, dynamics.data, dynamics is self._own)
        if not within_step:
            self._combinations = None
        elif self._combinations is not None:
            return _by_combined_rows(found, force, self._combinations)
        # By dot, which takes half the time of @ for small matrices.
        a, on_a, J, target = found.a, found.on_a, found.J, found.target
        bound = CLOSED_FOR_FORCES
        if not nearly_closed and not (found.closed_to(bound) and norm(J.dot(v)) <= bound * (1.0 + norm(v))):
            return None
        missed = norm(J.dot(a) - target)
        if not (_is_small(missed, norm(target)) or _is_small(missed, norm(J.ravel()) * norm(a))):
            return None
        carried = on_a.dot(J)
        wrong = dynamics.inverse_dynamics(q, v, a)
        wrong -= force
        wrong -= carried
        error = norm(wrong)
        # Term by term: the first is nearly always enough.
        terms = norm(carried)
        if not (_is_small(error, terms) or _is_small(error, terms + norm(force)) or _is_small(error, norm(found.bias))):
            return None
        least = self._independence.least_forces(J, on_a)
        if least is None:
            return None
        self._combinations = self._independence.combinations()
        return Acceleration(a, -least)

    def closures(self, robot: Robot, q: Vector) -> tuple[Vector, Matrix]:
        """The residual (nc,) at q (nq,), and K (nc, nv), which is its derivative where the closures are closed."""
        return self.closures_of_tree(q, self.own) or residual_and_jacobian(robot, q)

    def closures_of_tree(self, q: Vector, dynamics: TreeDynamics) -> tuple[Vector, Matrix] | None:
        """The same by the tree's own solver; None if it has none."""
        return None if self._solver is None else self._solver.closures(q, dynamics.data)


@overflow_refused("the acceleration")
def _eliminated(
    robot: Robot, q: Vector, v: Vector, force: Vector, gains: list[tuple[float, float]], dynamics: TreeDynamics
) -> Acceleration:
    solution = EquationOfMotion(robot, q, v, dynamics).eliminate(force, gains)
    finite("the acceleration", *solution)
    return solution


def _is_small(error: float, terms: float) -> bool:
    return error <= FORCES_SOLVED * terms < math.inf


def _by_combined_rows(found: ConstrainedMotion, force: Vector, chosen: Matrix) -> Acceleration | None:
    """The solution in which independent combinations (rank, nc) of the rows hold; None if it misses an equation.

    Where the constraints do not quite hold, redundant rows contradict each other: Pinocchio's solver would lock the
    mechanism.
    """
    J, target, M = chosen.dot(found.J), chosen.dot(found.target), found.mass
    n, given = len(M), np.concatenate((force - found.bias, target))
    equations = np.zeros((len(given), len(given)))
    equations[:n, :n], equations[:n, n:], equations[n:, :n] = M, -J.T, J
    x = solutions(equations, given)
    if not _is_small(norm(equations.dot(x) - given), norm(given)):
        return None
    return Acceleration(x[:n], -chosen.T.dot(x[n:]))
