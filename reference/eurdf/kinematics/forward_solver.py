"""The acceleration of the closed mechanism: by Pinocchio's solver if that is beyond doubt, else by elimination."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.equation_of_motion import Acceleration, EquationOfMotion
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.independence import norm
from eurdf.kinematics.limb_solver import LimbSolver, is_rounding, keeps
from eurdf.kinematics.limbs import find_limbs
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.rank import inverses, solutions
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.pinocchio.constrained_dynamics import Gains, StatedGains
from eurdf.pinocchio.limbs import Limb, LimbsDynamics
from eurdf.pinocchio.tree_dynamics import MOST_VELOCITIES_WITH_DATA, TreeDynamics
from eurdf.pinocchio.tree_few import as_slice

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
        self._size = sum(constraint.rows for constraint in robot.constraints), robot.tree.nv
        self.gains = StatedGains(robot)
        self.rows = tuple(loop.rows for loop in find_loops(robot))
        self._whole: LimbSolver | None = None
        self._limbs: list[LimbSolver] = []
        self._is_judged = False  # whether the last solution of `acceleration` that was judged is beyond doubt
        self._own: TreeDynamics | None = None
        if not robot.constraints or len(robot.model.mimicking_joints):
            return
        limbs = find_limbs(robot)
        if limbs:
            self._own = divided = LimbsDynamics(robot.tree, [limb.joints for limb in limbs])
            self._limbs = [
                LimbSolver(robot, limb, of.constraints) for limb, of in zip(divided.limbs, limbs, strict=True)
            ]
            self._shares, self._trunk = divided.shares, len(divided.trunk)
            # Of each limb the velocities of the trunk among its own, the same in the trunk, and unit forces on them.
            self._joints = []
            for limb in divided.limbs:
                own, at = np.nonzero(limb.velocities[:, None] == divided.trunk)
                self._joints.append((as_slice(own), as_slice(at), np.ix_(at, at), np.eye(len(limb.velocities))[:, own]))
        if robot.tree.nv <= MOST_VELOCITIES_WITH_DATA:
            self._whole = LimbSolver(robot, Limb(robot.tree), range(len(robot.constraints)))

    @property
    def own(self) -> TreeDynamics:
        """The dynamics of the tree, in memory that is made on first use and kept."""
        if self._own is None:
            self._own = self._tree.dynamics()
        elif self._limbs:
            self._own.update()
        return self._own

    def dynamics(self, data: Any) -> TreeDynamics:
        """Those in the given `pin.Data`, or its own if there is none.

        Raises:
            ValueError: It is no `pin.Data`, or one of another model.
        """
        return self.own if data is None else self._tree.dynamics(data)

    def solve(
        self, robot: Robot, q: Vector, v: Vector, force: Vector, gains: list[Gains], dynamics: TreeDynamics
    ) -> Acceleration:
        """Solve M a + h = τ + Kᵀ λ and K a + K̇ v = -kd K v - kp r.

        Args:
            robot: The robot.
            q: Normalized configuration (nq,).
            v: Velocity (nv,).
            force: τ (nv,).
            gains: Baumgarte gains of each constraint: kp, 1/s², and kd, 1/s.
            dynamics: Those of the tree.

        Raises:
            UndeterminedMotion: A joint without inertia can move.
            NumericalOverflow: The result is not finite.
        """
        solution = self.beyond_doubt(q, v, force, gains, dynamics)
        return _eliminated(robot, q, v, force, gains, dynamics) if solution is None else solution

    def acceleration(
        self, robot: Robot, q: Vector, v: Vector, force: Vector, gains: list[Gains], *, within_step: bool
    ) -> Vector:
        """The a (nv,) of `solve` in an integration, with the dynamics that are its own.

        Any drift will do that equals K̇ v where the constraints hold and K v = 0: its steps start and end there. The
        rank of K and the solution are judged at the start of a step, but not ``within_step``.
        """
        dynamics = self._own or self.own
        if within_step and self._is_judged:
            a = self._within_step(q, v, force, gains, dynamics.data)
            if a is not None:
                return a
        solution = self.beyond_doubt(q, v, force, gains, dynamics, nearly_closed=True)
        self._is_judged = solution is not None
        return (_eliminated(robot, q, v, force, gains, dynamics) if solution is None else solution).a

    def _within_step(self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: Any) -> Vector | None:
        """As `acceleration`, near a state that was judged; None if a solver is not sure."""
        if not self._limbs:
            return None if self._whole is None else self._whole.acceleration(q, v, force, gains, data, True)
        shared, alone = force / self._shares, []
        for solver in self._limbs:
            limb = solver.limb
            own_a = solver.acceleration(q, v, limb.part_of_v(shared), gains, limb.dynamics.data, True)
            if own_a is None:
                return None
            alone.append(own_a)
        a = np.zeros(len(v))
        for solver, (own_a, _) in zip(self._limbs, self._joined(alone), strict=True):
            a[solver.limb.velocities] = own_a
        return a

    def beyond_doubt(
        self,
        q: Vector,
        v: Vector,
        force: Vector,
        gains: list[Gains],
        dynamics: TreeDynamics,
        *,
        nearly_closed: bool = False,
    ) -> Acceleration | None:
        """The solution by Pinocchio's solver, as `solve`; None if it has none, or if the solution is in doubt.

        It is, unless the constraints hold, the rank of K is certain, and the solution satisfies both equations. With
        ``nearly_closed``, the constraints need not quite hold.
        """
        is_own, solver = dynamics is self._own, self._whole
        if is_own and self._limbs:
            return self._by_limbs(q, v, force, gains, dynamics, nearly_closed)
        if solver is None or dynamics.data is None:
            return None
        found = solver.solve(q, v, force, gains, dynamics.data, is_own)
        if found is None:
            return None
        a, on_a, J, target = found
        if not nearly_closed and not solver.is_closed(J, v):
            return None
        if not keeps(a, J, target) or not _balances(dynamics, q, v, a, force, on_a.dot(J)):
            return None
        least = solver.least_forces(J, on_a)
        if least is None:
            return None
        return Acceleration(a, solver.in_order(-least))

    def _by_limbs(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], dynamics: TreeDynamics, nearly_closed: bool
    ) -> Acceleration | None:
        shared, alone = force / self._shares, []
        for solver in self._limbs:
            limb = solver.limb
            found = solver.solve(q, v, limb.part_of_v(shared), gains, limb.dynamics.data, True)
            if found is None or (not nearly_closed and not solver.is_closed(found.J, v)):
                return None
            alone.append(found)
        a, lambdas, carried = np.zeros(len(v)), np.zeros(self._size[0]), np.zeros(len(v))
        joined = self._joined([found.a for found in alone])
        for solver, (own_a, change), (_, on_a, J, target) in zip(self._limbs, joined, alone, strict=True):
            velocities, on_a = solver.limb.velocities, on_a + change
            if not keeps(own_a, J, target):
                return None
            a[velocities] = own_a
            carried[velocities] += on_a.dot(J)
            least = solver.least_forces(J, on_a)
            if least is None:
                return None
            lambdas[solver.rows] = -least
        return Acceleration(a, lambdas) if _balances(dynamics, q, v, a, force, carried) else None

    def _joined(self, alone: list[Vector]) -> list[tuple[Vector, Any]]:
        """Of each limb the a, and the change of f, with the forces w between the limbs that give all the same trunk.

        Of a limb the velocities of the trunk have the acceleration b ``alone``, and b + A w with w. With the same for
        all, and the sum of all w zero, it is (Σ A⁻¹)⁻¹ Σ A⁻¹ b.
        """
        responses: list[tuple[Any, Any, Any]] = []
        inertia, needed = np.zeros((self._trunk, self._trunk)), np.zeros(self._trunk)
        for solver, (own, at, block, unit), a in zip(self._limbs, self._joints, alone, strict=True):
            if not unit.size:
                responses.append((0.0, 0.0, 0.0))
                continue
            response, change = solver.respond(unit)
            inverse = inverses(response[own])
            responses.append((response, change, inverse))
            inertia[block] += inverse
            needed[at] += inverse.dot(a[own])
        trunk = solutions(inertia, needed)
        found: list[tuple[Vector, Any]] = []
        for (own, at, _, _), a, (response, change, inverse) in zip(self._joints, alone, responses, strict=True):
            w = np.dot(inverse, trunk[at] - a[own])
            found.append((a + np.dot(response, w), np.dot(change, w)) if len(w) else (a, 0.0))
        return found

    def closures(self, robot: Robot, q: Vector) -> tuple[Vector, Matrix]:
        """The residual (nc,) at q (nq,), and K (nc, nv), which is its derivative where the closures are closed."""
        return self.closures_of_tree(q, self._own or self.own) or residual_and_jacobian(robot, q)

    def closures_of_tree(self, q: Vector, dynamics: TreeDynamics) -> tuple[Vector, Matrix] | None:
        """The same by Pinocchio's solver; None if it has none."""
        if not (dynamics is self._own and self._limbs):
            solver = self._whole
            if solver is None or dynamics.data is None:
                return None
            r, K = solver.closures(q, dynamics.data)
            return solver.in_order(r), solver.in_order(K)
        r, K = np.empty(self._size[0]), np.zeros(self._size)
        for solver in self._limbs:
            limb = solver.limb
            r[solver.rows], K[solver.rows[:, None], limb.velocities] = solver.closures(q, limb.dynamics.data)
        return r, K


@overflow_refused("the acceleration")
def _eliminated(
    robot: Robot, q: Vector, v: Vector, force: Vector, gains: list[Gains], dynamics: TreeDynamics
) -> Acceleration:
    solution = EquationOfMotion(robot, q, v, dynamics).eliminate(force, gains)
    finite("the acceleration", *solution)
    return solution


def _balances(dynamics: TreeDynamics, q: Vector, v: Vector, a: Vector, force: Vector, carried: Vector) -> bool:
    """Whether M a + h is the force and what the closures carry, (nv,) each, to rounding."""
    wrong = dynamics.inverse_dynamics(q, v, a)
    wrong -= force
    wrong -= carried
    error = norm(wrong)
    # Term by term: the first is nearly always enough.
    terms = norm(carried)
    if is_rounding(error, terms) or is_rounding(error, terms + norm(force)):
        return True
    return is_rounding(error, norm(dynamics.inverse_dynamics(q, v, np.zeros(len(v)))))
