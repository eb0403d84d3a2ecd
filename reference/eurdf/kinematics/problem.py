"""A robot as the solvers see it: its tree, and groups of its loops, for arrays of configurations (B, nq)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.evaluate import evaluator, few_tree, many_tree
from eurdf.kinematics.loop import LoopGroup, independent_groups, merged, moving_velocities
from eurdf.kinematics.rank import least_solution, norms, product
from eurdf.kinematics.stack import Stack
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import CLOSED, MANY_ALIKE, MOST_VELOCITIES_AT_ONCE, SMALL, WELL_CLOSED
from eurdf.pinocchio.memory import working_memory
from eurdf.pinocchio.tree_few import as_slice

if TYPE_CHECKING:
    from eurdf.kinematics.position_limit import PositionLimits
    from eurdf.pinocchio.robot import Robot

# Cost of the residual and Jacobian of one closure, in multiplications.
_WORK_OF_A_CLOSURE = 3e5


@dataclass(frozen=True, eq=False)
class Group:
    """Loops that are closed together, and the velocities that close them.

    Attributes:
        loops: The loops.
        by: Indices in v of the given velocities that move them.
        evaluator: Evaluates their constraints by their own velocities, followed by the given ones.
        row_scale: Factors (m,) that make their rows dimensionless.
        unit: Unit (n,) of each of their own velocities.
        spread: Ratio of the largest unit of all these velocities to the smallest.
        work: Multiplications for the smaller of A Aᵀ and Aᵀ A, and for the evaluation of A.
        own: Indices in v of the velocities that close them.
        held: A direction (n,) of unit length along which no step moves, or None.
    """

    loops: LoopGroup
    by: Indices
    evaluator: Any
    row_scale: Vector
    unit: Vector
    spread: float
    work: float
    own: slice | Indices
    held: Vector | None = None

    @cached_property
    def rows(self) -> slice | Indices:
        """Which rows of the robot's residual are theirs."""
        return as_slice(self.loops.rows)

    @cached_property
    def closures(self) -> slice | Indices:
        """Which of the robot's constraints are theirs."""
        return as_slice(np.array(self.loops.closures, dtype=np.intp))

    @cached_property
    def factors(self) -> Matrix:
        """Factors (m, n) that make K dimensionless."""
        with np.errstate(over="ignore", invalid="ignore"):
            return self.row_scale[:, None] * self.unit

    def residual(self, q: Matrix) -> Matrix:
        """Rows (B, m) at q (B, nq), m and rad."""
        return self.residual_of(self.evaluator.at(q))

    @cached_property
    def residual_of(self) -> Callable[[Any], Matrix]:
        """The same at configurations that the evaluator was given."""
        residual: Callable[[Any], Matrix] = self.evaluator.residual
        return residual

    @cached_property
    def at(self) -> Callable[[Matrix], Any]:
        """Their constraints at q (B, nq)."""
        at: Callable[[Matrix], Any] = self.evaluator.at
        return at

    def among(self, which: Mask) -> Group:
        """The same group, for some of its elements."""
        return self

    def room(self, q: Matrix, limits: PositionLimits) -> tuple[Matrix, Matrix]:
        """As `PositionLimits.room` of their own velocities."""
        return limits.room(q, self.own)

    def jacobian(self, at: Any) -> Matrix:
        """Their derivative (B, m, n) at configurations that the evaluator was given, dimensionless."""
        K = self.evaluator.jacobian(at)
        A: Matrix = (K[:, :, : len(self.unit)] if len(self.by) else K) * self.factors
        return A if self.held is None else A - (A @ self.held)[:, :, None] * self.held

    def jacobian_at(self, q: Matrix) -> Matrix:
        """The same at q (B, nq)."""
        return self.jacobian(self.evaluator.at(q))

    def following(self, q: Matrix, driven: Matrix | None, whole: Matrix | None = None) -> tuple[Matrix, Mask]:
        """Their own velocities (B, n, k) for given ones (B, g, k), and where (B,) these exist beyond doubt.

        They are the least ones, in rad/s and m/s, for each unit velocity if none are given. ``whole`` is
        K (B, nc, nv) of the robot, if it is known.
        """
        if whole is None:
            K = self.evaluator.jacobian(self.evaluator.at(q))
        else:
            K = whole[:, self.loops.rows[:, None], np.concatenate((self.loops.velocities, self.by))]
        K = K * self.row_scale[:, None]
        norm = self.spread * norms(K)
        own, by = K[:, :, : len(self.unit)], K[:, :, len(self.unit) :]
        return least_solution(own, -by if driven is None else -product(by, driven), norm)

    def holding(self, direction: Vector) -> Group:
        """The same group, whose derivative is zero along a direction (n,) of unit length: no step moves along it."""
        return replace(self, held=direction)


class Problem:
    """A robot, some velocities of which may be given: then only the others close the loops.

    For many elements at once it is plain data, which threads share and other processes can be sent. For few it has
    working memory, which one thread uses at a time: `working_memory` lends it.

    Attributes:
        tree: Its spanning tree.
        spaces: Its tangent spaces, with the units of rows and velocities.
        names: Names of its constraints.
        given: Indices (k,) in v of the given velocities.
        groups: Groups of its loops that share no joint that moves.
        work: Multiplications in a step of all groups.
        well_closed: Bound of the squared dimensionless residual of loops whose openings need not be measured.
        at_once: Whether all loops descend with one damping, before each group does by itself.
        together: The loops as they descend with one damping, if they do.
        stacks: Many groups of a large robot that are alike, for few elements.
        parts: The same loops as their constraints are evaluated fastest: all at once, in large robots those alike.
    """

    def __init__(self, robot: Robot, given: Sequence[int] = (), *, few: bool = True) -> None:
        """Take a robot and the indices in v of the given velocities."""
        # No reference to the robot: the cache would keep it alive.
        self.tree = few_tree(robot) if few else many_tree(robot)
        self.spaces = robot.cached(TangentSpaces)
        self.well_closed = (WELL_CLOSED / max(self.spaces.length, SMALL)) ** 2
        self.names = tuple(constraint.name for constraint in robot.constraints)
        self.given = np.array(given, dtype=np.intp)
        self._place = np.zeros(self.tree.nv, dtype=np.intp)  # of each velocity where it is among the given ones
        self._place[self.given] = np.arange(len(given))
        self._unit_motions = np.zeros((self.tree.nv, len(given)))  # of the given velocities
        self._unit_motions[self.given, self._place[self.given]] = 1.0
        loops = independent_groups(robot, given)
        self.groups = tuple(self._group(robot, each, few) for each in loops)
        self.work = sum(group.work for group in self.groups)
        small = self.tree.nv <= MOST_VELOCITIES_AT_ONCE
        self.at_once = small and len(loops) > 1
        self.stacks = self._stacks(robot) if few and not small else ()
        stacked = {member for stack in self.stacks for member in stack.members.tolist()}
        self.parts = tuple(stack.part for stack in self.stacks)
        self.parts += tuple(group for index, group in enumerate(self.groups) if index not in stacked)
        if len(loops) > 1 and (small or not few):
            self.parts = (self._group(robot, merged(loops), few),)
        # One matrix of all loops takes less time for one element; for many, small ones do.
        self.together = self.parts if few and small else self.groups
        self._followers = self.parts[len(self.stacks) :] if few else self.groups
        # But their K takes less time to evaluate at once.
        self._is_evaluated_whole = not few and len(self.parts) < len(self.groups)

    def _group(self, robot: Robot, loops: LoopGroup, few: bool) -> Group:
        moving = moving_velocities(robot, loops.closures)
        by = np.array([velocity for velocity in self.given.tolist() if velocity in moving], dtype=np.intp)
        velocities = np.concatenate((loops.velocities, by))
        rows, units = self.spaces.row_scale[loops.rows], self.spaces.scale[velocities]
        m, n = len(loops.rows), len(loops.velocities)
        return Group(
            loops,
            by,
            evaluator(robot, loops.closures, velocities, few=few),
            rows,
            units[:n],
            float(units.max() / units.min()) if len(units) else 1.0,
            float(m) * n * min(m, n) + _WORK_OF_A_CLOSURE * len(loops.closures),
            as_slice(loops.velocities),
        )

    def _stacks(self, robot: Robot) -> tuple[Stack, ...]:
        alike: dict[tuple[int, ...], list[int]] = {}
        for index, group in enumerate(self.groups):
            loops = group.loops
            if len(group.unit):
                size = len(loops.rows), len(loops.velocities), len(loops.coordinates), len(loops.closures)
                alike.setdefault((*size, len(group.by)), []).append(index)
        return tuple(
            Stack.of_groups(self.tree, members, groups, self._group(robot, merged([g.loops for g in groups]), True))
            for members in alike.values()
            if len(members) >= MANY_ALIKE
            for groups in [[self.groups[member] for member in members]]
        )

    @property
    def numbers(self) -> int:
        """Numbers that one element takes, roughly."""
        return sum(int(part.evaluator.numbers) for part in self.parts) + 10 * self.tree.nq

    def openings(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """How far each constraint is open at q (B, nq), m and rad, (B, c) each."""
        if len(self.parts) == 1:
            (part,) = self.parts
            found: tuple[Matrix, Matrix] = part.evaluator.openings(part.evaluator.at(q))
            return found
        lengths, angles = np.empty((2, len(q), len(self.names)))
        for part in self.parts:
            lengths[:, part.closures], angles[:, part.closures] = part.evaluator.openings(part.evaluator.at(q))
        return lengths, angles

    def residual(self, q: Matrix) -> Matrix:
        """The residual (B, nc), m and rad."""
        if len(self.parts) == 1:
            found: Matrix = self.parts[0].residual(q)
            return found
        r = np.empty((len(q), len(self.spaces.row_scale)))
        for part in self.parts:
            r[:, part.rows] = part.residual(q)
        return r

    def jacobian(self, q: Matrix) -> Matrix:
        """K (B, nc, nv)."""
        K = np.zeros((len(q), len(self.spaces.row_scale), self.tree.nv))
        for part in self.parts:
            block = part.evaluator.jacobian(part.evaluator.at(q))
            if len(self.parts) == 1 and not len(part.by):
                K[:, :, part.own] = block
                break
            K[:, part.loops.rows[:, None], np.concatenate((part.loops.velocities, part.by))] = block
        return K

    def closes(self, q: Matrix, tolerance: float = 0.0) -> Mask:
        """Whether (B,) every constraint is closed at q (B, nq); NaN is not.

        It is if it is open by at most `CLOSED`, less in small robots, or by the tolerance, m and rad.
        """
        lengths, angles = self.openings(q)
        short = lengths <= max(CLOSED * min(1.0, self.spaces.length / SMALL), tolerance)
        return np.asarray(np.logical_and.reduce(short & (angles <= max(CLOSED, tolerance)), axis=1))

    def exceeds(self, q: Matrix, groups: Sequence[Group], limits: PositionLimits) -> bool:
        """Whether a configuration (B, nq) to which groups have moved is beyond a limit."""
        return limits.are_exceeded(q)

    def moved(self, q: Matrix, groups: Sequence[Group], steps: Sequence[Matrix]) -> Matrix:
        """Configurations (B, nq) after steps (B, n) of groups; lengths are in characteristic lengths."""
        v = np.zeros((len(q), self.tree.nv))
        for group, step in zip(groups, steps, strict=True):
            v[:, group.own] = group.unit * step
        return np.asarray(self.tree.integrate(q, v))

    def velocity(self, q: Matrix, driven: Matrix) -> tuple[Matrix, Mask]:
        """The velocities (B, nv) at q (B, nq) with given ones (B, k), and where (B,) they exist beyond doubt.

        Of those that keep the loops closed, they are the least ones, in rad/s and m/s.
        """
        v, sure = np.zeros((len(q), self.tree.nv)), np.ones(len(q), dtype=bool)
        if len(q) > 1 and (q[1] == q[0]).all() and (q[2:] == q[0]).all():  # as where all elements start
            D, is_sure = self.derivative(q[:1])
            if is_sure[0]:
                return driven @ D[0].T, sure
        v[:, self.given] = driven
        whole = self.jacobian(q) if self._is_evaluated_whole else None
        for stack in self.stacks:
            drive = v[:, stack.by]
            if np.count_nonzero(drive):
                solutions, are_sure = stack.following(q, drive[..., None])
                v[:, stack.velocities] = solutions[..., 0]
                sure &= (are_sure | ~drive.any(axis=2)).all(axis=1)
        for group in self._followers:
            if len(group.by) and len(group.unit):
                drive = driven if len(group.by) == len(self.given) else v[:, group.by]
                if np.count_nonzero(drive):
                    solution, is_sure = group.following(q, drive[:, :, None], whole)
                    v[:, group.own] = solution[:, :, 0]
                    if np.count_nonzero(is_sure) < len(q):
                        sure &= is_sure | ~drive.any(axis=1)
        return v, sure

    def derivative(self, q: Matrix) -> tuple[Matrix, Mask]:
        """Their derivatives (B, nv, k) by the given velocities, and where (B,) they exist beyond doubt."""
        D, sure = np.empty((len(q), *self._unit_motions.shape)), np.ones(len(q), dtype=bool)
        D[:] = self._unit_motions
        whole = self.jacobian(q) if self._is_evaluated_whole else None
        for stack in self.stacks:
            if stack.by.shape[1]:
                solutions, are_sure = stack.following(q, None)
                D[:, stack.velocities[:, :, None], self._place[stack.by][:, None]] = solutions
                sure &= are_sure.all(axis=1)
        for group in self._followers:
            if len(group.by) and len(group.unit):
                solution, is_sure = group.following(q, None, whole)
                D[:, group.loops.velocities[:, None], self._place[group.by]] = solution
                sure &= is_sure
        return D, sure


def for_many(robot: Robot, given: Sequence[int] = ()) -> Problem:
    """A robot for many elements at once, with the indices in v of the given velocities; made once and shared."""
    with working_memory(robot, _for_many, *given) as problem:
        return problem


def _for_many(robot: Robot, *given: int) -> Problem:
    return Problem(robot, given, few=False)
