"""The equation of motion of a robot, or of a limb of it, by Pinocchio's solver.

Where Pinocchio has no constraint model for some rows, J a = b, it gives the terms of the equation. Then the forces
follow from J (a₁ + X f) = b, where a₁ is the acceleration without constraints, and X = M⁻¹ Jᵀ.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.closures.coupling import Couplings
from eurdf.kinematics.evaluate import Evaluator
from eurdf.kinematics.independence import Independence, norm
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.rank import inverses, solutions
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED_FOR_FORCES, FORCES_SOLVED
from eurdf.mechanism.constraint import Coupling
from eurdf.pinocchio.constrained_dynamics import ConstrainedDynamics, ConstrainedMotion, Gains, rows_of_contacts

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
        modelled = [index for index in constraints if rows_of_contacts(robot.constraints[index])]
        others = [index for index in constraints if not rows_of_contacts(robot.constraints[index])]
        order = [*modelled, *others]
        rows = [row for index in order for row in range(loops[index].rows.start, loops[index].rows.stop)]
        self.rows: Indices = np.array(rows, dtype=np.intp)
        self._order: Indices | None = None if rows == sorted(rows) else np.argsort(self.rows)
        self._independence = Independence(spaces.row_scale[self.rows], spaces.scale[limb.velocities])
        self._solver = ConstrainedDynamics(limb.model, [robot.constraints[index] for index in modelled], limb.site)
        self._modelled = None if len(modelled) == len(robot.constraints) else modelled
        self._is_whole, self._solves = limb.is_whole, self._solver.solves and not others
        self._others = _OtherRows(robot, others, limb.velocities) if others else None
        self._q = np.empty(0)  # where it was last
        # M⁻¹, and of the combinations that hold J, X, J X and what they are, if it solved by these.
        self._schur: tuple[Matrix, Matrix, Matrix, Matrix, Matrix | None] | None = None

    def solve(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: Any, is_own: bool
    ) -> ConstrainedMotion | None:
        """The solution at a state of the robot, which may be wrong or not finite; None if a rank is in doubt.

        Args:
            q: Configuration (nq,) of the robot.
            v: Its velocity (nv,).
            force: Generalized force τ of the limb's own velocities.
            gains: Baumgarte gains of each constraint of the robot.
            data: Memory of the limb's model.
            is_own: Whether no other solver of constrained dynamics uses this memory.
        """
        self._q = q
        if self._solves:
            self._schur = None
            return self._solver.solve(*self._own(q, v, force, gains), data, is_own)
        J, target = self._terms(q, v, force, gains, data, is_own)
        if not self._independence.has_certain_rank(J):
            return None
        a, f = self._combined(q, force, data, J, target, self._independence.combinations())
        return ConstrainedMotion(a, f, J, target)

    def acceleration(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: Any, is_own: bool
    ) -> Vector | None:
        """Only the a of `solve`, near a state whose rank was judged; None if Pinocchio's solver is not sure.

        Combinations of redundant rows hold. Where the constraints do not quite hold, redundant rows contradict each
        other: Pinocchio's solver would lock the mechanism.
        """
        chosen = self._independence.combinations() if len(self.rows) else None
        if self._solves and chosen is None:
            self._schur = None
            a = self._solver.acceleration(*self._own(q, v, force, gains), data, is_own)
            return a if self._solver.is_solved() else None
        return self._combined(q, force, data, *self._terms(q, v, force, gains, data, is_own), chosen)[0]

    def _own(self, q: Vector, v: Vector, force: Vector, gains: list[Gains]) -> tuple[Vector, Vector, Vector, Any]:
        """What concerns the limb and its solver."""
        if self._modelled is not None:
            gains = [gains[index] for index in self._modelled]
        if self._is_whole:
            return q, v, force, gains
        return self.limb.part_of_q(q), self.limb.part_of_v(v), force, gains

    def _terms(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: Any, is_own: bool
    ) -> tuple[Matrix, Vector]:
        """J (m, n) and the target (m,) of all rows."""
        J, target = self._solver.terms(*self._own(q, v, force, gains), data, is_own)
        if self._others is None:
            return J, target
        other, other_target = self._others.terms(q, v, self.limb.part_of_v(v), gains)
        return np.concatenate((J, other)), np.concatenate((target, other_target))

    def _combined(
        self, q: Vector, force: Vector, data: Any, J: Matrix, target: Vector, chosen: Matrix | None
    ) -> tuple[Vector, Vector]:
        """The a (n,) in which the rows hold, or combinations of them, and f (m,): X = M⁻¹ Jᵀ, f = (J X)⁻¹ (b - J a)."""
        inverse_mass = self._solver.inverse_mass(self.limb.part_of_q(q), data)
        if chosen is not None:
            J, target = chosen.dot(J), chosen.dot(target)
        X, a = inverse_mass.dot(J.T), inverse_mass.dot(force - data.nle)
        S = J.dot(X)
        self._schur = inverse_mass, J, X, S, chosen
        f = solutions(S, target - J.dot(a))
        return a + X.dot(f), f if chosen is None else f.dot(chosen)

    def respond(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """The changes of a and of all f by generalized forces (n, k) on the limb, where it was last."""
        if self._schur is None:
            return self._solver.respond(forces)
        inverse_mass, J, X, S, chosen = self._schur
        a = inverse_mass.dot(forces)
        f = -inverses(S).dot(J.dot(a))
        return a + X.dot(f), f if chosen is None else chosen.T.dot(f)

    def in_order(self, values: Vector) -> Vector:
        """Values (m, …) of the rows, in the order of the robot's."""
        return values if self._order is None else values[self._order]

    def least_forces(self, J: Matrix, on_a: Vector) -> Vector | None:
        """The f of least norm with the same Jᵀ f as that of `solve`; None if the rank of J is in doubt."""
        if self._schur is not None:
            return on_a
        return self._independence.least_forces(J, on_a) if len(on_a) else on_a

    def is_closed(self, J: Matrix, v: Vector) -> bool:
        """Whether the constraints hold, and so do their rates, where `solve` was last, of the robot's v (nv,)."""
        if not self._solver.closed_to(CLOSED_FOR_FORCES):
            return False
        if self._others is not None and not norm(self._others.closures(self._q)[0]) <= CLOSED_FOR_FORCES:
            return False
        own = v if self._is_whole else self.limb.part_of_v(v)
        return norm(J.dot(own)) <= CLOSED_FOR_FORCES * (1.0 + norm(own))

    def closures(self, q: Vector, data: Any) -> tuple[Vector, Matrix]:
        """The residual (m,) at q (nq,), and K (m, n), which is its derivative where the closures are closed."""
        r, K = self._solver.closures(self.limb.part_of_q(q), data)
        if self._others is None:
            return r, K
        own, own_K = self._others.closures(q)
        return np.concatenate((r, own)), np.concatenate((K, own_K))


class _OtherRows:
    """Rows of constraints that are no combinations of those of contacts: couplings, and kinds that do not state it."""

    def __init__(self, robot: Robot, indices: Sequence[int], velocities: Indices) -> None:
        """Take the indices of the constraints, and those in v of the columns."""
        constraints = [robot.constraints[index] for index in indices]
        couplings = [each for each in constraints if isinstance(each, Coupling)]
        self._couplings: Couplings | None = None
        if len(couplings) == len(constraints):
            self._couplings = Couplings(couplings, robot.tree.coordinate, velocities)
            self._fixed = -self._couplings.K, np.zeros(len(couplings))
        self._evaluator = Evaluator(robot.tree, constraints, velocities, few=True)
        self._indices, self._rows = indices, [each.rows for each in constraints]

    def closures(self, q: Vector) -> tuple[Vector, Matrix]:
        """Their residual and K at q (nq,)."""
        if self._couplings is not None:
            return self._couplings.residual(q[None])[0], self._couplings.K
        at = self._evaluator.at(q[None])
        return self._evaluator.residual(at)[0], self._evaluator.jacobian(at)[0]

    def terms(self, q: Vector, v: Vector, own_v: Vector, gains: list[Gains]) -> tuple[Matrix, Vector]:
        """Minus K, and K̇ v + kd K v + kp r, at q (nq,) and v (nv,), of which ``own_v`` (n,) are the columns."""
        own_gains = [gains[index] for index in self._indices]
        if self._couplings is not None and not any(map(any, own_gains)):
            return self._fixed
        r, K = self.closures(q)
        (target,) = self._evaluator.drift(q[None], v[None])
        kp, kd = np.array(own_gains).repeat(self._rows, axis=0).T
        target += kd * K.dot(own_v) + kp * r
        return -K, target


def keeps(a: Vector, J: Matrix, target: Vector) -> bool:
    """Whether J a is the target, to rounding."""
    missed = norm(J.dot(a) - target)  # by dot, which takes half the time of @ for small matrices
    return is_rounding(missed, norm(target)) or is_rounding(missed, norm(J.ravel()) * norm(a))


def is_rounding(error: float, terms: float) -> bool:
    """Whether an error is rounding of terms."""
    return error <= FORCES_SOLVED * terms < math.inf
