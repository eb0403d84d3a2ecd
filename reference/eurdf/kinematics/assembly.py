"""Assembly: a configuration in which every loop is closed.

Damped Gauss-Newton steps on the configuration manifold bring the residual to zero. In a small robot they close all
loops at once. If that fails, and in a large robot, they close each group of loops that share joints by itself. A
descent can end with open loops, for instance from a straight or symmetric configuration; the group then starts again
from random configurations around the first one.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.errors import NotClosable
from eurdf.kinematics.descend import Descended, descend, evaluated
from eurdf.kinematics.named import Named, configuration_of
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.position_limit import JointAtLimit, PositionLimits, chosen_limits
from eurdf.kinematics.problem import Group, Problem
from eurdf.kinematics.rank import norms
from eurdf.kinematics.tolerances import CLOSED, MOST_STEPS, MOST_WORK, RESTARTS, SMALL, SOLVED, WELL_CLOSED
from eurdf.pinocchio.arguments import are_by_name, as_names, checked_array, checked_count, checked_tolerance
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A quaternion whose length differs from 1 by no more is normalized.
_ROUNDING = 1e-15

#: Distance of the restarts from the first start (rad, or characteristic lengths); the last one is repeated.
SPREADS = (0.1, 0.3, 1.0, 2.0, 3.0)


#: Why an assembly did not converge: joints at their limits keep the loops open; the loops stay open though no limit
#: prevents closing; the search reached its limit of work, so that it is unknown whether the loops can close;
#: or the loops close, but rounded numbers in the files make redundant rows contradict each other.
AssemblyReason = Literal["joint limits", "not closed", "not decided", "rounding"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Assembly:
    """The result of `assemble`.

    Attributes:
        q: Configuration (nq,): closed, or the least open one found.
        residual: Euclidean norm of the residual at q, m and rad.
        converged: Whether every row of the residual is within ``tolerance``.
        closes: Whether each closure is open by at most `CLOSED`, m and rad, as required of a configuration in a file;
            in robots with a characteristic length L below 1 cm, by at most 1e-4 L. If a robot closes but does not
            converge, rounded numbers in its files make redundant rows contradict each other.
        iterations: Number of evaluations of the residual and its Jacobian.
        open: How far each closure is open at q, in file order.
        reason: Why it did not converge; None if it did.
        at_limits: The joints that are at their limits at q and would have to exceed them to close the loops further;
            empty if the loops close.
    """

    q: Vector
    residual: float
    converged: bool
    closes: bool
    iterations: int
    open: tuple[Opening, ...]
    reason: AssemblyReason | None = None
    at_limits: tuple[JointAtLimit, ...] = ()

    def __repr__(self) -> str:
        is_open = ", ".join(str(found) for found in self.open if found.is_open)
        parts = [f"open: {is_open}" if is_open else "closed", f"residual {self.residual:.3g} m, rad"]
        if self.reason == "rounding":
            parts.append("not converged: rounding makes redundant rows contradict each other")
        if self.reason == "not decided":
            parts.append("not decided: the search reached its limit of work")
        if self.at_limits:
            parts.append(f"at their limits: {', '.join(map(str, self.at_limits))}")
        return f"<Assembly: {'; '.join(parts)}; {self.iterations} iterations>"


def assemble(
    robot: Robot,
    q0: Named | None = None,
    *,
    hold: str | Iterable[str] = (),
    tolerance: float = SOLVED,
    limits: bool = False,
    restarts: int = RESTARTS,
) -> Assembly:
    """Find a closed configuration, r(q) = 0, near the given one.

    Each step x solves (KᵀK + μ 1) x = -Kᵀ r, and q becomes q ⊕ x (Levenberg, *A method for the solution of certain
    non-linear problems in least squares*, 1944; Marquardt, 1963), with the residual r and the K of EU-CLO-008 to -010.

    Only joints of the loops move. The result is deterministic. The work is bounded even if the loops cannot be closed:
    at most ``restarts`` + 2 descents of at most 60 steps, and 1e10 multiplications, about five seconds. If loops are
    still open at this limit, `Assembly.reason` is ``"not decided"``.

    The structure of the robot is analysed once and kept with it.

    Args:
        robot: The robot.
        q0: Where to start (nq,). The default is the `assembled` configuration, or the neutral one if there is none.
        hold: Names of joints that do not move, or one name. A mimic joint is held with its leader.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        limits: Whether to respect the position limits of joints whose coordinates are angles or lengths. A start
            outside the limits is clipped first. Limits that are both 0 are no range (`urdf-no-range`).
        restarts: Maximum number of restarts while loops are open by more than `CLOSED`.

    Returns:
        The closed configuration, or the least open one found.

    Raises:
        ValueError: ``q0`` is not a configuration, ``hold`` has a name that is not a joint of the model, or
            ``tolerance`` or ``restarts`` is negative.
    """
    q = start(robot, q0)
    held = tuple(velocity for name in as_names(hold) for velocity in robot.tree.velocities_of(name))
    tolerance, chosen = checked_tolerance(tolerance), chosen_limits(robot, limits)
    restarts = checked_count("restarts", restarts, 0)
    with working_memory(robot, Problem, *([held] if held else [])) as problem:  # others use one that holds none, too
        return assembled(problem, q, tolerance, restarts, chosen)


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
        if not little or not problem.groups:
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
        self._errors = np.stack(list(map(_error, self._problem.groups, self._by_group(found.residuals))), axis=1)
        self._first = 0 if self._problem.at_once else 1  # of one by one, they were the first attempt

    def closed(self, restarts: int) -> Closed:
        """Where the last descents lead."""
        problem, generators = self._problem, _Generators()
        if problem.at_once and not self._iterations.any():
            found = self._descended(problem.together, np.arange(len(self._q)), self._q)
            self.keep_all(found, _well_closed(problem, found))
        for attempt in range(self._first, restarts + 1):
            is_open = ~(self._errors <= CLOSED)
            if attempt:
                is_open &= np.array([group.work <= MOST_WORK for group in problem.groups], dtype=bool)
                is_open &= (self._spent <= MOST_WORK)[:, None]
            if not is_open.any():
                break
            longest = np.zeros_like(self._iterations)
            for index, group in enumerate(problem.groups):
                which = np.flatnonzero(is_open[:, index])
                if len(which):
                    place = self._around(group, which, attempt, generators) if attempt else self._q[which]
                    found = self._descended([group], which, place)
                    longest[which] = np.maximum(longest[which], 1 + found.steps)
                    self._keep(index, group, which, found)
            self._iterations += longest
        is_open = ~(self._errors <= CLOSED)
        stopped = (self._spent > MOST_WORK) | ~(self._ended & is_open).any(axis=1)
        closes, decided = np.array(self._sure.all(axis=1)), ~(is_open.any(axis=1) & stopped)
        doubtful = np.flatnonzero(~closes)
        if len(doubtful):
            closes[doubtful] = problem.closes(self._best[doubtful], self._tolerance)
        return Closed(self._best, closes, self._iterations, decided)

    def _around(self, group: Group, which: Indices, attempt: int, generators: _Generators) -> Matrix:
        """Where a group of some elements starts again."""
        spread = SPREADS[min(attempt, len(SPREADS)) - 1]
        away = [generators[element].uniform(-spread, spread, len(group.unit)) for element in which.tolist()]
        place = self._problem.moved(self._q[which], [group], [np.array(away)])
        return place if self._limits is None else self._limits.clip(place, group.loops.velocities)

    def _keep(self, index: int, group: Group, which: Indices, found: Descended) -> None:
        """Keep where a group of some elements is less open than before."""
        self._ended[which, index] |= ~found.cut
        errors = _error(group, found.residuals[0])
        better = errors < self._errors[which, index]
        if self._best is self._q:
            self._best = np.array(self._q)
        if np.count_nonzero(better) == len(self._q):
            better, own = slice(None), slice(None)
            self._best[:, group.loops.coordinates] = found.q[:, group.loops.coordinates]
        else:
            own = which[better]
            self._best[own[:, None], group.loops.coordinates] = found.q[better][:, group.loops.coordinates]
        self._errors[own, index] = errors[better]
        self._sure[own, index] = _well_closed(self._problem, found)[better]

    def _descended(self, groups: Sequence[Group], which: Indices, q: Matrix) -> Descended:
        """The descents of some elements from q (b, nq), within the bound of the work."""
        work = sum(group.work for group in groups)
        most = None
        if work > MOST_WORK:
            work, most = 0.0, np.zeros(len(which), dtype=np.intp)
        elif self._spent.max(initial=0.0) + work * MOST_STEPS > MOST_WORK:
            most = np.maximum((MOST_WORK - self._spent[which]) // work, 0.0).astype(np.intp)
        found = descend(self._problem, groups, q, self._tolerance, self._limits, most)
        self._spent[which] += work * (found.steps + found.cut)
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


def _error(group: Group, r: Matrix) -> Vector:
    """The norms (B,) of residuals (B, m) of a group, m and rad; lengths of small robots count more, in proportion."""
    return norms(r * np.maximum(SMALL * group.row_scale, 1.0))


def _well_closed(problem: Problem, found: Descended) -> Mask:
    """Which elements (B,) are closed so well that their openings need not be measured."""
    return np.asarray((found.square <= WELL_CLOSED**2) & (found.scaled_square <= _well_closed_scaled(problem)))


def _well_closed_scaled(problem: Problem) -> float:
    """Bound of the square of the dimensionless residual of such."""
    return (WELL_CLOSED / max(problem.spaces.length, SMALL)) ** 2


@np.errstate(all="ignore")
def is_closed(problem: Problem, q: Matrix, tolerance: float) -> Mask:
    """Whether (B,) `close` would leave configurations (B, nq) as they are."""
    if not problem.parts:
        return np.ones(len(q), dtype=bool)
    _, _, _, error, scaled = evaluated(problem.parts, q)
    closed = (error <= tolerance**2) & (scaled <= _well_closed_scaled(problem))
    return np.array(closed, ndmin=1)


def assembled(
    problem: Problem, q: Vector, tolerance: float, restarts: int = RESTARTS, limits: PositionLimits | None = None
) -> Assembly:
    """As `assemble`, from a configuration (nq,)."""
    if limits is not None and problem.groups:
        q = limits.clip(q, np.concatenate([group.loops.velocities for group in problem.groups]))
    closed = close(problem, q[None], tolerance, restarts, limits)
    with np.errstate(over="ignore", invalid="ignore"):
        (r,), found = problem.residual(closed.q), openings(problem, closed.q)
    closes = bool(closed.closes[0])
    converged = float(np.abs(r).max(initial=0.0)) <= tolerance
    at_limits = () if closes or limits is None else _pressed(problem, closed.q, limits)
    reason: AssemblyReason | None = None
    if not converged:
        why_open: AssemblyReason = "joint limits" if at_limits else "not closed"
        reason = "rounding" if closes else why_open if closed.decided[0] else "not decided"
    return Assembly(
        q=closed.q[0],
        residual=math.hypot(*r.tolist()),
        converged=converged,
        closes=closes,
        iterations=int(closed.iterations[0]),
        open=found,
        reason=reason,
        at_limits=at_limits,
    )


def closed_start(problem: Problem, q: Vector, tolerance: float, where: str = "the start") -> Vector:
    """A configuration (nq,), with its loops closed.

    Raises:
        NotClosable: They cannot be closed there.
    """
    closed = close(problem, q[None], tolerance)
    if closed.closes[0]:
        return np.array(closed.q[0])
    first = assembled(problem, q, tolerance)
    if not first.closes:
        raise NotClosable(f"no closed configuration was found near {where}", first.open, first.q)
    return first.q


def openings(problem: Problem, q: Matrix) -> tuple[Opening, ...]:
    """How far each constraint is open at a configuration (1, nq)."""
    lengths, angles = problem.openings(q)
    return tuple(map(Opening, problem.names, lengths[0].tolist(), angles[0].tolist()))


@np.errstate(over="ignore", invalid="ignore")
def _pressed(problem: Problem, q: Matrix, limits: PositionLimits) -> tuple[JointAtLimit, ...]:
    """The joints at their limits that the descent direction -Kᵀ r would move beyond them at q (1, nq)."""
    down = np.zeros(problem.tree.nv)
    for group in problem.together:
        if group.work <= MOST_WORK:
            at = group.evaluator.at(q)
            b = group.row_scale * group.evaluator.residual(at)[0]
            down[group.loops.velocities] = -group.jacobian(at)[0].T @ b
    return limits.pressed(q[0], down)
