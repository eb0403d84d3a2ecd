"""The equation of motion of a robot, or of a limb of it, by Pinocchio's solver.

Rows that Pinocchio has no constraint model for, J₂ a = b₂, are added to its solution a₁. Their forces f₂ change the
acceleration by X f₂, which the same decomposition gives, and f₂ follows from J₂ (a₁ + X f₂) = b₂.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.kinematics.evaluate import Evaluator
from eurdf.kinematics.independence import Independence, norm
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.rank import inverses, solutions
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED_FOR_FORCES, FORCES_SOLVED
from eurdf.pinocchio.constrained_dynamics import ConstrainedDynamics, ConstrainedMotion, Gains
from eurdf.pinocchio.constraint import contacts_of
from eurdf.pinocchio.tree_dynamics import whole_matrix

if TYPE_CHECKING:
    from eurdf.pinocchio.limbs import Limb
    from eurdf.pinocchio.robot import Robot


class LimbSolver:
    """Solves the equation of motion of one limb at one state after the other, by one thread at a time.

    Attributes:
        limb: The limb.
        rows: Indices of the rows of its constraints in the residual of the robot.
    """

    def __init__(self, robot: Robot, limb: Limb, constraints: Sequence[int]) -> None:
        """Take a limb and the indices of its constraints."""
        self.limb = limb
        loops, spaces = find_loops(robot), robot.cached(TangentSpaces)
        modelled = [index for index in constraints if contacts_of(robot.constraints[index])]
        others = [index for index in constraints if not contacts_of(robot.constraints[index])]
        order = [*modelled, *others]
        rows = [row for index in order for row in range(loops[index].rows.start, loops[index].rows.stop)]
        self.rows: Indices = np.array(rows, dtype=np.intp)
        self._order: Indices | None = None if rows == sorted(rows) else np.argsort(self.rows)
        self._independence = Independence(spaces.row_scale[self.rows], spaces.scale[limb.velocities])
        self._solver = ConstrainedDynamics(limb.model, [robot.constraints[index] for index in modelled], limb.site)
        self._modelled, self._others = modelled, others
        self._evaluator: Evaluator | None = None
        if others:
            related = [robot.constraints[index] for index in others]
            self._evaluator = Evaluator(robot.tree, related, limb.velocities, few=True)
            self._own_rows = np.array([each.rows for each in related])
        self._is_plain = limb.is_whole and not others
        self._is_closed = True
        self._other = (np.empty((0, 0)),) * 4  # J₂, X, the changes of f₁, and the inverse of J₂ X

    def solve(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: Any, is_own: bool
    ) -> ConstrainedMotion:
        """The solution at a state of the robot, which may be wrong or not finite.

        Args:
            q: Configuration (nq,) of the robot.
            v: Its velocity (nv,).
            force: Generalized force τ of the limb's own velocities.
            gains: Baumgarte gains of each constraint of the robot.
            data: Memory of the limb's model.
            is_own: Whether no other solver of constrained dynamics uses this memory.
        """
        if self._is_plain:
            return self._solver.solve(q, v, force, gains, data, is_own)
        limb = self.limb
        modelled = gains if len(gains) == len(self._modelled) else [gains[index] for index in self._modelled]
        found = self._solver.solve(limb.part_of_q(q), limb.part_of_v(v), force, modelled, data, is_own)
        if self._evaluator is None:
            return found
        at = self._evaluator.at(q[None])
        (r,), (C,) = self._evaluator.residual(at), self._evaluator.jacobian(at)
        (target,) = self._evaluator.drift(q[None], v[None])
        own_gains = [gains[index] for index in self._others]
        if any(map(any, own_gains)):
            kp, kd = np.array(own_gains).repeat(self._own_rows, axis=0).T
            target += kd * C.dot(limb.part_of_v(v)) + kp * r
        self._is_closed = norm(r) <= CLOSED_FOR_FORCES
        J = -C
        X, change = self._solver.respond(J.T)
        inverse = inverses(J.dot(X))
        self._other = J, X, change, inverse
        f = inverse.dot(target - J.dot(found.a))
        return ConstrainedMotion(
            found.a + X.dot(f),
            np.concatenate((found.on_a + change.dot(f), f)),
            np.concatenate((found.J, J)),
            np.concatenate((found.target, target)),
        )

    def acceleration(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: Any, is_own: bool
    ) -> Vector | None:
        """Only the a of `solve`, if the constraints are Pinocchio's and its solver is sure of it; else None."""
        if self._others:
            return None
        if self._is_plain:
            a = self._solver.acceleration(q, v, force, gains, data, is_own)
        else:
            own = gains if len(gains) == len(self._modelled) else [gains[index] for index in self._modelled]
            a = self._solver.acceleration(self.limb.part_of_q(q), self.limb.part_of_v(v), force, own, data, is_own)
        return a if self._solver.is_solved() else None

    def respond(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """The changes of a and of all f by generalized forces (n, k) on the limb, where `solve` was last."""
        a, on_a = self._solver.respond(forces)
        if self._evaluator is None:
            return a, on_a
        J, X, change, inverse = self._other
        f = -inverse.dot(J.dot(a))
        return a + X.dot(f), np.concatenate((on_a + change.dot(f), f))

    def in_order(self, values: Vector) -> Vector:
        """Values (m, …) of the rows, in the order of the robot's."""
        return values if self._order is None else values[self._order]

    def least_forces(self, J: Matrix, on_a: Vector) -> Vector | None:
        """The f of least norm with the same Jᵀ f; None if the rank of J is in doubt."""
        return self._independence.least_forces(J, on_a) if len(on_a) else on_a

    def combinations(self) -> Matrix | None:
        """Combinations of redundant rows, as many as are independent where forces were last; None if all rows are."""
        return self._independence.combinations() if len(self.rows) else None

    def by_combinations(self, found: ConstrainedMotion, force: Vector, data: Any, chosen: Matrix) -> Vector | None:
        """The a in which combinations (rank, m) of the rows hold; None if it misses an equation.

        Where the constraints do not quite hold, redundant rows contradict each other: Pinocchio's solver would lock the
        mechanism.
        """
        J, target, M = chosen.dot(found.J), chosen.dot(found.target), whole_matrix(data.M)
        n, given = len(M), np.concatenate((force - data.nle, target))
        equations = np.zeros((len(given), len(given)))
        equations[:n, :n], equations[:n, n:], equations[n:, :n] = M, -J.T, J
        x = solutions(equations, given)
        if not is_rounding(norm(equations.dot(x) - given), norm(given)):
            return None
        return x[:n]

    def is_closed(self, J: Matrix, v: Vector) -> bool:
        """Whether the constraints hold, and so do their rates, where `solve` was last, of the robot's v (nv,)."""
        if not (self._is_closed and self._solver.closed_to(CLOSED_FOR_FORCES)):
            return False
        own = v if self._is_plain else self.limb.part_of_v(v)
        return norm(J.dot(own)) <= CLOSED_FOR_FORCES * (1.0 + norm(own))

    def closures(self, q: Vector, data: Any) -> tuple[Vector, Matrix]:
        """The residual (m,) at q (nq,), and K (m, n), which is its derivative where the closures are closed."""
        r, K = self._solver.closures(self.limb.part_of_q(q), data)
        if self._evaluator is None:
            return r, K
        at = self._evaluator.at(q[None])
        (own,), (own_K,) = self._evaluator.residual(at), self._evaluator.jacobian(at)
        return np.concatenate((r, own)), np.concatenate((K, own_K))


def keeps(a: Vector, J: Matrix, target: Vector) -> bool:
    """Whether J a is the target, to rounding."""
    missed = norm(J.dot(a) - target)  # by dot, which takes half the time of @ for small matrices
    return is_rounding(missed, norm(target)) or is_rounding(missed, norm(J.ravel()) * norm(a))


def is_rounding(error: float, terms: float) -> bool:
    """Whether an error is rounding of terms."""
    return error <= FORCES_SOLVED * terms < math.inf
