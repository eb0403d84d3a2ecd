"""Closing loops: descents of all loops together, of each group, and restarts of groups that stay open.

In a small robot the first descent is of all loops at once. If that fails, and in a large robot, each group of loops
that share joints descends by itself. A descent can end with open loops, for instance from a straight or symmetric
configuration; the group then starts again from random configurations around the first one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.descend import Descended, descend, evaluated
from eurdf.kinematics.named import Named, configuration_of
from eurdf.kinematics.position_limit import PositionLimits
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import norms
from eurdf.kinematics.stack import Stack, StackElements
from eurdf.kinematics.tolerances import CLOSED, MOST_STEPS, MOST_WORK, SMALL, SOLVED, WELL_CLOSED
from eurdf.pinocchio.arguments import are_by_name, checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A quaternion whose length differs from 1 by no more is normalized.
_ROUNDING = 1e-15

# If only one group of so many in a stack is open, it descends by itself.
_FEW_OF = 8

#: Distance of the restarts from the first start (rad, or characteristic lengths); the last one is repeated.
SPREADS = (0.1, 0.3, 1.0, 2.0, 3.0)


class Closed(NamedTuple):
    """Configurations whose loops were closed, as far as that is possible; B elements.

    Attributes:
        q: (B, nq).
        closes: Whether (B,) each closure is closed as `Problem.closes` has it, or within the tolerance.
        iterations: Numbers (B,) of evaluations of the residual. Groups that descend together count once.
        decided: Whether (B,) the loops close, or all descents ended.
    """

    q: Matrix
    closes: Mask
    iterations: Indices
    decided: Mask


def close(
    problem: Problem,
    q: Matrix,
    tolerance: float = SOLVED,
    restarts: int = 0,
    limits: PositionLimits | None = None,
) -> Closed:
    """Bring the residual to zero, in a small robot first of all loops together, and of each group by itself.

    Args:
        problem: The robot.
        q: Where to start (B, nq).
        tolerance: Bound of the norm of the residual, m and rad.
        restarts: Maximum number of restarts while a group is open by more than `CLOSED`.
        limits: The position limits to respect, as q does, or None.
    """
    tolerance *= min(1.0, problem.spaces.length / SMALL)
    with np.errstate(all="ignore"):  # lengths such as 1e200 m overflow and never close
        little = (restarts + 2) * MOST_STEPS * problem.work <= MOST_WORK
        if not little or not problem.groups or problem.stacks:
            return _Closing(problem, q, tolerance, limits).closed(restarts)
        if problem.at_once or len(problem.groups) == 1:
            found = descend(problem, problem.together, q, tolerance, limits)
        else:
            found = _one_by_one(problem, q, tolerance, limits)
        sure = _well_closed(problem, found)
        if np.count_nonzero(sure) == len(q):
            return Closed(found.q, sure, 1 + found.steps, sure)
        closing = _Closing(problem, q, tolerance, limits)
        closing.keep_all(found, sure)
        return closing.closed(restarts)


def _one_by_one(problem: Problem, q: Matrix, tolerance: float, limits: PositionLimits | None) -> Descended:
    """The descents of the groups, each from where the one before it ended: they share no joint that moves."""
    each: list[Descended] = []
    for group in problem.groups:
        each.append(descend(problem, [group], each[-1].q if each else q, tolerance, limits))
    return Descended(
        each[-1].q,
        [found.residuals[0] for found in each],
        np.add.reduce([found.square for found in each]),
        np.add.reduce([found.scaled_square for found in each]),
        np.maximum.reduce([found.steps for found in each]),
        np.logical_or.reduce([found.cut for found in each]),
    )


class _Closing:
    """The descents from the configurations q (B, nq), within the limits."""

    def __init__(self, problem: Problem, q: Matrix, tolerance: float, limits: PositionLimits | None) -> None:
        self._problem, self._tolerance, self._limits = problem, tolerance, limits
        self._q = self._best = q
        by_group = len(q), len(problem.groups)
        self._errors = np.full(by_group, np.inf)
        self._sure = np.zeros(by_group, dtype=bool)  # whether a group is closed beyond doubt
        self._ended = np.zeros(by_group, dtype=bool)  # whether a descent was not cut
        self._spent = np.zeros(len(q))  # multiplications
        self._iterations = np.zeros(len(q), dtype=np.intp)
        self._first = 0  # attempt

    def keep_all(self, found: Descended, sure: Mask) -> None:
        """Start from where descents of all groups ended."""
        self._best, self._iterations = found.q, 1 + found.steps
        self._sure[:], self._ended[:] = sure[:, None], ~found.cut[:, None]
        scales = [group.row_scale for group in self._problem.groups]
        self._errors = np.stack(list(map(_error, scales, self._by_group(found.residuals))), axis=1)
        self._first = 0 if self._problem.at_once else 1  # of one by one, they were the first attempt

    def closed(self, restarts: int) -> Closed:
        """Where the last descents lead."""
        problem, generators = self._problem, _Generators()
        if problem.at_once and not self._iterations.any():
            work = sum(group.work for group in problem.together)
            found = self._descended(problem, problem.together, np.arange(len(self._q)), self._q, work)
            self.keep_all(found, _well_closed(problem, found))
        for attempt in range(self._first, restarts + 1):
            is_open = ~(self._errors <= CLOSED)
            if attempt:
                is_open &= np.array([group.work <= MOST_WORK for group in problem.groups], dtype=bool)
                is_open &= (self._spent <= MOST_WORK)[:, None]
            if not is_open.any():
                break
            away = self._drawn(is_open, attempt, generators) if attempt else None
            longest = np.zeros_like(self._iterations)
            for stack in problem.stacks:
                own = is_open[:, stack.members]
                if np.count_nonzero(own) * _FEW_OF > own.size:  # else each by itself takes less time
                    self._descend_pairs(stack, own, away, longest)
                    is_open[:, stack.members] = False
            for index, group in enumerate(problem.groups):
                which = np.flatnonzero(is_open[:, index])
                if len(which):
                    place = self._q[which]
                    if away is not None:
                        place = problem.moved(place, [group], [away[index]])
                        if self._limits is not None:
                            place = self._limits.clip(place, group.loops.velocities)
                    found = self._descended(problem, [group], which, place, group.work)
                    own_q = found.q[:, group.loops.coordinates]
                    errors = _error(group.row_scale, found.residuals[0])
                    member = np.full(len(which), index)
                    self._keep(which, member, group.loops.coordinates, own_q, found, errors, longest)
            self._iterations += longest
        is_open = ~(self._errors <= CLOSED)
        stopped = (self._spent > MOST_WORK) | ~(self._ended & is_open).any(axis=1)
        closes, decided = np.array(self._sure.all(axis=1)), ~(is_open.any(axis=1) & stopped)
        doubtful = np.flatnonzero(~closes)
        if len(doubtful):
            closes[doubtful] = problem.closes(self._best[doubtful], self._tolerance)
        return Closed(self._best, closes, self._iterations, decided)

    def _drawn(self, is_open: Mask, attempt: int, generators: _Generators) -> list[Matrix]:
        """Of each group the steps (b, n) away from the start with which its open elements start again."""
        spread, groups = SPREADS[min(attempt, len(SPREADS)) - 1], self._problem.groups
        return [
            np.array(
                [generators[each].uniform(-spread, spread, len(group.unit)) for each in np.flatnonzero(own).tolist()]
            )
            for own, group in zip(is_open.T, groups, strict=True)
        ]

    def _descend_pairs(self, stack: Stack, is_open: Mask, away: list[Matrix] | None, longest: Indices) -> None:
        """Descend the open groups (B, g) of a stack at once, and keep where they lead."""
        index, element = np.nonzero(is_open.T)  # by group, as what is drawn
        pairs = StackElements(stack, self._q, element, index)
        place = pairs.start()
        if away is not None:
            drawn = [away[member] for member in stack.members.tolist() if len(away[member])]
            place = pairs.moved(place, np.concatenate(drawn))
            if self._limits is not None:
                place = pairs.clipped(place, self._limits)
        found = self._descended(stack, [pairs], element, place, stack.work)
        errors = _error(pairs.row_scale, found.residuals[0])
        self._keep(element, stack.members[index], stack.coordinates[index], found.q, found, errors, longest)

    def _keep(
        self,
        element: Indices,
        group: Indices,
        coordinates: Indices,
        own: Matrix,
        found: Descended,
        errors: Vector,
        longest: Indices,
    ) -> None:
        """Keep where groups (E,) of elements (E,), at coordinates (E, c) of their own, are less open than before."""
        self._ended[element, group] |= ~found.cut
        np.maximum.at(longest, element, 1 + found.steps)
        better = errors < self._errors[element, group]
        if self._best is self._q:
            self._best = np.array(self._q)
        coordinates = np.broadcast_to(coordinates, own.shape)[better]
        element, group = element[better], group[better]
        self._best[element[:, None], coordinates] = own[better]
        self._errors[element, group] = errors[better]
        self._sure[element, group] = _well_closed(self._problem, found)[better]

    def _descended(
        self, problem: Problem | Stack, groups: Sequence[Any], element: Indices, q: Matrix, work: float
    ) -> Descended:
        """The descents from q of elements (E,), of so much work a step each, within the bound of the work."""
        most = None
        if work > MOST_WORK:
            work, most = 0.0, np.zeros(len(element), dtype=np.intp)
        else:
            each = work * np.bincount(element, minlength=len(self._spent))  # a step of all that are of an element
            if (self._spent + each * MOST_STEPS).max(initial=0.0) > MOST_WORK:
                most = np.maximum((MOST_WORK - self._spent[element]) // each[element], 0.0).astype(np.intp)
        found = descend(problem, groups, q, self._tolerance, self._limits, most)
        np.add.at(self._spent, element, work * (found.steps + found.cut))
        return found

    def _by_group(self, residuals: Sequence[Matrix]) -> list[Matrix]:
        """Residuals of the loops that descended together, as those of each group."""
        problem = self._problem
        if len(residuals) == len(problem.groups):
            return list(residuals)
        (together,) = problem.together
        return [residuals[0][:, np.searchsorted(together.loops.rows, each.loops.rows)] for each in problem.groups]


class _Generators(dict[int, "np.random.Generator"]):  # a text: few searches need what takes time to import
    """Of each element random numbers, the same for all."""

    def __missing__(self, element: int) -> np.random.Generator:
        self[element] = np.random.default_rng(0)
        return self[element]


def _error(row_scale: Matrix, r: Matrix) -> Vector:
    """The norms (B,) of residuals (B, m) of a group, m and rad; lengths of small robots count more, in proportion."""
    return norms(r * np.maximum(SMALL * row_scale, 1.0))


def _well_closed(problem: Problem, found: Descended) -> Mask:
    """Which elements (B,) are closed so well that their openings need not be measured."""
    return np.asarray((found.square <= WELL_CLOSED**2) & (found.scaled_square <= problem.well_closed))


@np.errstate(all="ignore")
def is_closed(problem: Problem, q: Matrix, tolerance: float) -> Mask:
    """Whether (B,) `close` would leave configurations (B, nq) as they are."""
    if not problem.parts:
        return np.ones(len(q), dtype=bool)
    _, _, _, error, scaled = evaluated(problem.parts, q)
    closed = (error <= tolerance**2) & (scaled <= problem.well_closed)
    return np.array(closed, ndmin=1)


def start(robot: Robot, q0: Named | None = None, name: str = "q0") -> Vector:
    """The given configuration, checked and normalized; by default `assembled`, or else the neutral configuration.

    ``name`` is that of the argument.

    Raises:
        ValueError: Its shape is not (nq,), it is not finite, or it cannot be normalized.
    """
    if q0 is None:
        q0 = robot.configurations.get("assembled")
    if q0 is None:
        return robot.tree.neutral()
    tree = robot.tree
    given = configuration_of(robot, q0, name) if are_by_name(q0) else checked_array(name, q0, (tree.nq,))
    if tree.is_normalized(given, _ROUNDING):
        return np.array(given)
    q = tree.normalized(given)
    if not tree.is_normalized(q):  # NaN is not
        raise ValueError(f"{name} has a quaternion, or a (cos, sin) pair, whose length is zero or overflows")
    return q
