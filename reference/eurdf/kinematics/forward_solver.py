"""The acceleration of the closed mechanism: by Pinocchio's solver if that is beyond doubt, else by elimination."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.equation_of_motion import Acceleration, EquationOfMotion
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.independence import INDEPENDENT, norm
from eurdf.kinematics.limb_solver import LimbSolver, is_rounding, keeps
from eurdf.kinematics.limbs import find_limbs
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.rank import inverses, solutions
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.pinocchio.constrained_dynamics import Gains, StatedGains
from eurdf.pinocchio.limbs import Limb, LimbsDynamics
from eurdf.pinocchio.tree_dynamics import MOST_VELOCITIES_WITH_DATA, TreeDynamics

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class ForwardSolver:
    """Solves the equation of motion of one robot at one state after the other, by one thread at a time.

    Attributes:
        gains: The Baumgarte gains that the constraint models have.
        names: Of each constraint its name.
        rows: And its rows.
    """

    def __init__(self, robot: Robot) -> None:
        # No reference to the robot: the cache would keep it alive.
        self._tree = robot.tree
        self._size = sum(constraint.rows for constraint in robot.constraints), robot.tree.nv
        self.gains = StatedGains(robot)
        self.names = tuple(constraint.name for constraint in robot.constraints)
        self.rows = tuple(loop.rows for loop in find_loops(robot))
        self._whole: LimbSolver | None = None
        self._limbs: list[LimbSolver] = []
        self._combinations: Matrix | None = None  # of redundant rows, as many as are independent
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
                self._joints.append((own, at, np.eye(len(limb.velocities))[:, own]))
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
        self,
        robot: Robot,
        q: Vector,
        v: Vector,
        force: Vector,
        gains: list[Gains],
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
        gains: list[Gains],
        dynamics: TreeDynamics,
        *,
        nearly_closed: bool = False,
        within_step: bool = False,
    ) -> Acceleration | None:
        """The solution by Pinocchio's solver, as `solve`; None if it has none, or if the solution is in doubt.

        It is, unless the constraints hold, the rank of K is certain, and the solution satisfies both equations.
        """
        is_own, solver = dynamics is self._own, self._whole
        if is_own and self._limbs:
            return self._by_limbs(q, v, force, gains, dynamics, nearly_closed)
        if solver is None or dynamics.data is None:
            return None
        found = solver.solve(q, v, force, gains, dynamics.data, is_own)
        if not within_step:
            self._combinations = None
        elif self._combinations is not None:
            return solver.by_combinations(found, force, dynamics.data, self._combinations)
        a, on_a, J, target = found
        if not nearly_closed and not solver.is_closed(J, v):
            return None
        if not keeps(a, J, target) or not _balances(dynamics, q, v, a, force, on_a.dot(J)):
            return None
        least = solver.least_forces(J, on_a)
        if least is None:
            return None
        self._combinations = solver.combinations()
        return Acceleration(a, solver.in_order(-least))

    def _by_limbs(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], dynamics: TreeDynamics, nearly_closed: bool
    ) -> Acceleration | None:
        """With each limb alone, and then with the forces w between the limbs that give all the same trunk.

        Of a limb the velocities of the trunk have the acceleration b alone, and b + A w with w. With the same for all,
        and the sum of all w zero, it is (Σ A⁻¹)⁻¹ Σ A⁻¹ b.
        """
        shared = force / self._shares
        alone, joined = [], []
        inertia, needed = np.zeros((self._trunk, self._trunk)), np.zeros(self._trunk)
        for solver, (own, at, unit) in zip(self._limbs, self._joints, strict=True):
            limb = solver.limb
            found = solver.solve(q, v, limb.part_of_v(shared), gains, limb.dynamics.data, True)
            if not nearly_closed and not solver.is_closed(found.J, v):
                return None
            alone.append(found)
            if len(own):
                response, change = solver.respond(unit)
                inverse = inverses(response[own])
                if found.J[:, own].any() and not norm(response[own].ravel()) * norm(inverse.ravel()) <= INDEPENDENT:
                    return None  # it may hold the trunk as another limb does
                joined.append((response, change, inverse))
                inertia[at[:, None], at] += inverse
                needed[at] += inverse.dot(found.a[own])
        trunk = solutions(inertia, needed)
        a, lambdas, carried = np.zeros(len(v)), np.zeros(self._size[0]), np.zeros(len(v))
        responses = iter(joined)
        for solver, (own, at, _), (own_a, on_a, J, target) in zip(self._limbs, self._joints, alone, strict=True):
            velocities = solver.limb.velocities
            if len(own):
                response, change, inverse = next(responses)
                w = inverse.dot(trunk[at] - own_a[own])
                own_a, on_a = own_a + response.dot(w), on_a + change.dot(w)
            if not keeps(own_a, J, target):
                return None
            a[velocities] = own_a
            carried[velocities] += on_a.dot(J)
            least = solver.least_forces(J, on_a)
            if least is None:
                return None
            lambdas[solver.rows] = -least
        return Acceleration(a, lambdas) if _balances(dynamics, q, v, a, force, carried) else None

    def closures(self, robot: Robot, q: Vector) -> tuple[Vector, Matrix]:
        """The residual (nc,) at q (nq,), and K (nc, nv), which is its derivative where the closures are closed."""
        return self.closures_of_tree(q, self.own) or residual_and_jacobian(robot, q)

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
            r[solver.rows], K[np.ix_(solver.rows, limb.velocities)] = solver.closures(q, limb.dynamics.data)
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
