"""The closed pose at positions of some joints of the loops, near another pose, and the derivative of the others."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.errors import NotClosable, NoTransmission, TooFar, shown
from eurdf.kinematics.assembly import assemble, closed_start
from eurdf.kinematics.closing import start
from eurdf.kinematics.evaluate import evaluator
from eurdf.kinematics.loop import independent_groups, merged, moving_velocities
from eurdf.kinematics.named import Named
from eurdf.kinematics.path import Elements, follow
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import Numbers, least_solution, norms, numerical_rank
from eurdf.kinematics.residual import all_openings
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import (
    CLOSED,
    FOLLOWED,
    LEAST_CORRECTION,
    LONGEST_MOTION,
    MOST_CORRECTION,
    MOVES,
)
from eurdf.pinocchio.memory import working_memory
from eurdf.transmissions.selection import Selection, listed
from eurdf.transmissions.transmission import Transmission, at_one

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Bound of the substeps of a motion, with those that fail.
MOST_SUBSTEPS = 256
#: A singular value of K_x (or a pivot) below this fraction of the first one means a singular pose.
SINGULAR = 1e-6

#: Newton steps of a substep after the first one.
STEPS = 4

#: A closed pose (nq,), and the derivative (k, n) there, dimensionless; None where the rank of K_x is in doubt.
Found = tuple[Vector, Matrix | None]

# Bound of each row of the residual at the first pose, m or rad.
_AT_FIRST = 1e-13


class Drive:
    """Moves some joints, those given, and follows others, those asked for.

    Attributes:
        robot: The robot.
        given: The given joints.
        asked: The joints asked for.
        closures: Indices of the constraints that relate them.
        own: Indices (k,) in v of the joints that follow.
        groups: The constraints in groups, each of which closes without the others while the given joints are held.
        unit: Unit (k,) of their velocities.
        rows: Scales (m,) of the rows of the residual, which make them dimensionless.
        factors: Those (m, k + n) of K, whose columns are of these joints and of the given ones.
        rank: Rank of K_x, the columns of these joints, at the first pose.
    """

    def __init__(self, at: Transmission, given: Selection, asked: Selection) -> None:
        """Prepare the loops between given joints and those asked for.

        Args:
            at: The transmission at a pose.
            given: Its joints, or its motors.
            asked: The others.

        Raises:
            NoTransmission: The given joints do not determine the others at that pose, or depend on each other.
        """
        self.given, self.asked, self._by_joints = given, asked, given.names == at.joints
        robot = self.robot = at.robot
        self._tree = robot.tree
        self._held = tuple(dict.fromkeys(at.held))
        spaces = robot.cached(TangentSpaces)
        self.closures: tuple[int, ...] = ()
        self.own: Indices = np.zeros(0, np.intp)
        self._evaluator: Any = None
        self.rows, self.factors = np.zeros(0), np.zeros((0, len(given)))
        driven = given.velocities.tolist()
        groups = [
            group
            for group in independent_groups(robot, {*driven, *at.held_index.tolist()})
            if not moving_velocities(robot, group.closures).isdisjoint(driven)
        ]
        self.groups = tuple(groups)
        if groups:
            group = merged(groups)
            self.closures, self.own = group.closures, group.velocities
            columns = np.concatenate((group.velocities, given.velocities))
            self._evaluator = evaluator(robot, group.closures, columns, few=True)
            self.rows = spaces.row_scale[group.rows]
            self.factors = self.rows[:, None] * spaces.scale[columns]
        self.unit, self._given_unit = spaces.scale[self.own], spaces.scale[given.velocities]
        every = np.concatenate((self.own, given.velocities)).tolist()
        place = {velocity: index for index, velocity in enumerate(every)}
        if not set(asked.velocities.tolist()) <= set(place):
            raise self._refusal(at.q)
        #: Of each velocity asked for its place among those that follow and those given.
        self._asked = np.array([place[velocity] for velocity in asked.velocities.tolist()], np.intp)
        self._asked_unit = spaces.scale[asked.velocities]
        self.rank = 0
        self.rank = self._decomposed(at.q)[1]

    def move(self, q: Vector, positions: Vector) -> tuple[Vector, Matrix]:
        """Move the given joints from a closed pose.

        Args:
            q: The pose (nq,).
            positions: Where to move the given joints (n,), rad or m.

        Returns:
            The closed pose (nq,) there, and the derivative (m, n) of the joints asked for by the given ones.

        Raises:
            NotClosable: The loops cannot be closed at the positions.
            TooFar: They can, but not everywhere on the straight path.
            NoTransmission: The given joints do not determine the others there.
            ValueError: ``positions`` does not fit.
        """
        here, found = self.along(q, positions)
        if found is None:
            raise self._unreached(here, positions)
        return self.derived(found)

    def derived(self, found: Found) -> tuple[Vector, Matrix]:
        """A closed pose (nq,), and the derivative (m, n) there; the error is that of `__init__`."""
        there, D = found
        if D is None:
            D, _ = self._decomposed(there)
        every = np.concatenate((D, np.eye(len(self.given))))
        return there, self._asked_unit[:, None] * every[self._asked] / self._given_unit

    def derivative(self, q: Vector) -> Matrix:
        """The derivative (m, n) at a closed pose (nq,); the error is that of `__init__`."""
        return self.derived((q, None))[1]

    def along(self, q: Vector, positions: Vector) -> tuple[Vector, Found | None]:
        """As `near`, along the straight path from q (nq,), and the last pose (nq,) on it.

        A substep that fails is halved; after one that does not, the next one is twice as long.
        """
        first = self.given.read(q)
        path = self.given.nearest(positions, first) - first
        here, left, found = q, MOST_SUBSTEPS, None

        def advance(_: Elements, done: Numbers, h: Numbers) -> tuple[Numbers, Numbers]:
            nonlocal here, left, found
            left -= 1
            if left < 0:
                return 0.0, False
            to = done + h
            found = self.near(here, positions if to >= 1.0 else first + to * path)
            here = here if found is None else found[0]
            return h, found is not None

        done = follow(advance)[0]
        return here, found if done >= 1.0 else None

    def near(self, q: Vector, positions: Vector) -> Found | None:
        """The closed pose at the positions (n,), by one substep from a closed pose (nq,).

        None where the path has to be divided.
        """
        before = self.given.read(q)
        step = (self.given.nearest(positions, before) - before) / self._given_unit
        if self._evaluator is None or np.abs(step).max() <= LONGEST_MOTION:
            return self._newton(q, np.zeros(len(self.own)), positions, step)
        return None

    def predicted(self, reference: Vector, motion: Vector, positions: Vector, error: float) -> Found | None:
        """The closed pose at the positions (n,), next to a motion (k,), rad or m, from a reference pose (nq,).

        None where the motion errs by more than is given, dimensionless, or the pose is singular.
        """
        return self._newton(reference, motion / self.unit, positions, error)

    def _newton(self, q: Vector, motion: Vector, positions: Vector, bound: Vector | float) -> Found | None:
        """The closed pose at the positions, by Newton's method after a motion (k,), dimensionless, from q (nq,).

        The bound is that of the whole correction; or it is the motion (n,) of the given joints, dimensionless, and the
        corrections after the first one have to be small against both.
        """
        there, corrections = self._moved(q, motion, positions), [np.zeros(len(self.own))]
        if self._evaluator is None:
            return there, np.zeros((0, len(self.given)))
        for _ in range(1 + STEPS):
            at = self._evaluator.at(there[None])
            r = self._evaluator.residual(at)[0]
            solution, certain = self._solved(r, self._evaluator.jacobian(at)[0] * self.factors)
            if solution is None:
                return None
            motion = solution[:, 0]
            there = self._moved(there, motion, positions)
            corrections.append(motion)
            if len(corrections) == 2 and np.abs(motion).max() > LONGEST_MOTION:
                return None
            largest = np.abs(r).max()
            # Rounded numbers in files can make redundant rows contradict each other.
            if largest <= FOLLOWED or (largest <= CLOSED and np.abs(motion).max() <= FOLLOWED):
                if isinstance(bound, float):
                    small = np.abs(np.sum(corrections, axis=0)).max() <= bound
                else:
                    length = math.hypot(*corrections[1].tolist(), *bound.tolist())
                    later = np.sum([corrections[0], *corrections[2:]], axis=0)
                    small = math.hypot(*later.tolist()) <= max(MOST_CORRECTION * length, LEAST_CORRECTION)
                return (there, solution[:, 1:] if certain else None) if small else None
        return None

    def _solved(self, r: Vector, K: Matrix) -> tuple[Matrix | None, bool]:
        """K_x⁺ (-r, -K_g), dimensionless (k, 1 + n), where the residual is r, and whether its rank is certain.

        None at a singular pose.
        """
        count = len(self.own)
        b = np.empty((len(r), 1 + len(self.given)))
        b[:, 0] = -self.rows * r
        b[:, 1:] = -K[:, count:]
        A = K[:, :count]
        (solution,), (certain,) = least_solution(A[None], b[None], norms(K[None]))
        if certain:
            return solution, True
        if not np.isfinite(K).all():
            return None, True
        left, values, right = np.linalg.svd(A, full_matrices=False)
        rank = self.rank
        if (values[:rank] <= SINGULAR * values.max(initial=0.0)).any():
            return None, False
        return right[:rank].T @ (left[:, :rank].T @ b / values[:rank, None]), False

    def _moved(self, q: Vector, motion: Vector, positions: Vector) -> Vector:
        """The pose (nq,) after a motion (k,), dimensionless, with the given joints at their positions."""
        v = np.zeros(self._tree.nv)
        v[self.own] = self.unit * motion
        moved = self._tree.normalized(self._tree.integrate(q, v))
        self.given.write(positions, moved)
        return moved

    def _unreached(self, q: Vector, positions: Vector) -> NotClosable:
        """Why the given joints do not get from q (nq,) to the positions."""
        there = np.array(q)
        self.given.write(positions, there)
        anywhere = assemble(self.robot, there, hold=(*self.given.joints, *self._held))
        at = shown(zip(self.given.names, positions.tolist(), strict=True))
        if not anywhere.closes:
            return NotClosable(f"the loops cannot be closed at {at}", anywhere.open, anywhere.q)
        reason = (
            f"the loops can be closed at {at}, but a straight path does not lead there on this branch; "
            "give positions in between"
        )
        return TooFar(reason, all_openings(self.robot, there), there)

    def _decomposed(self, q: Vector) -> tuple[Matrix, int]:
        """The derivative (k, n), dimensionless, and the rank of K_x at a pose; the error is that of `__init__`."""
        if self._evaluator is None:
            return np.zeros((0, len(self.given))), 0
        A, count = self._evaluator.jacobian(self._evaluator.at(q[None]))[0] * self.factors, len(self.own)
        left, values, right = np.linalg.svd(A[:, :count])
        rank = numerical_rank(values, float(np.linalg.norm(A, 2)))
        opening = np.abs(left[:, rank:].T @ A[:, count:]).max(initial=0.0)
        remaining = np.concatenate((right[rank:].T, np.zeros((len(self.given), count - rank))))[self._asked]
        if rank < self.rank or max(opening, np.abs(remaining).max(initial=0.0)) > MOVES:
            raise self._refusal(q)
        return right[:rank].T @ ((left[:, :rank].T @ -A[:, count:]) / values[:rank, None]), rank

    def _refusal(self, q: Vector) -> NoTransmission:
        """Why the given joints do not determine the others at a pose."""
        given, asked = self.given, self.asked
        if self._by_joints:
            reason = at_one(self.robot, given, q, asked).reason
        else:
            reason = at_one(self.robot, asked, q, given).inverse_reason
        reason = reason or f"{listed(given.joints)} cannot move independently"
        return NoTransmission("G" if self._by_joints else "B_J", reason)


def closed_pose(robot: Robot, q: Named | None) -> Vector:
    """A configuration, with its loops closed.

    Raises:
        NotClosable: They cannot be closed there.
        ValueError: It is not a configuration.
    """
    first = start(robot, q, "q")
    with working_memory(robot, Problem) as problem:
        return closed_start(problem, first, _AT_FIRST, "q")
