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
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.kinematics.array import Vector
from eurdf.kinematics.derived import borrowed
from eurdf.kinematics.descent import Descent
from eurdf.kinematics.evaluation import Evaluation, evaluations
from eurdf.kinematics.loop import find_loops, independent_groups, merged
from eurdf.kinematics.opening import CLOSED, Opening
from eurdf.kinematics.position_limit import JointAtLimit, PositionLimits, chosen_limits
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale
from eurdf.kinematics.several import several
from eurdf.kinematics.tree_kinematics import TreeKinematics
from eurdf.pinocchio.arguments import checked_array, checked_count, checked_tolerance

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Above this many velocities, closing all loops at once takes longer than one by one.
_MOST_VELOCITIES_AT_ONCE = 60

#: Bound of the steps of one descent.
MOST_STEPS = 60

#: Restarts of a group of loops that stays open, unless a caller gives their number.
RESTARTS = 20

# Bound of the multiplications in the steps of one assembly, about five seconds. Groups with hundreds of shared joints
# end before all restarts; a group with a single step above this bound is not tried.
_MOST_WORK = 1e10

# A residual below this, in m and rad and in shares of the characteristic length, is of closed loops for
# certain: how far a closure is open differs from its rows by a factor below 10.
_WELL_CLOSED = 0.1 * CLOSED

# A quaternion whose length differs from 1 by no more is normalized.
_ROUNDING = 1e-15

#: Distance of the restarts from the first start (rad, or characteristic lengths); the last one is repeated.
SPREADS = (0.1, 0.3, 1.0, 2.0, 3.0)


#: Why an assembly did not converge: joints at their limits keep the loops open; the loops stay open though no limit
#: prevents closing; the search reached its limit of work, so that it is not decided whether the loops can close;
#: or the loops close, but rounded numbers in the files make redundant rows contradict each other.
AssemblyReason = Literal["joint limits", "not closed", "not decided", "rounding"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Assembly:
    """The result of `assemble`.

    Attributes:
        q: Configuration (nq,): closed, or the least open one found.
        residual: Euclidean norm of the residual at q, m and rad.
        converged: Whether every row of the residual is within ``tolerance``.
        closes: Whether each closure is open by at most `CLOSED` (m, rad), as required of a configuration in a file. If
            a robot closes but does not converge, rounded numbers in its files make redundant rows contradict each
            other.
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
        parts = [f"open: {is_open}" if is_open else "closed", f"residual {self.residual:.3g}"]
        if self.reason == "rounding":
            parts.append("not converged: rounding makes redundant rows contradict each other")
        if self.reason == "not decided":
            parts.append("not decided: the search reached its limit of work")
        if self.at_limits:
            parts.append(f"at their limits: {', '.join(map(str, self.at_limits))}")
        return f"<Assembly: {'; '.join(parts)}; {self.iterations} iterations>"


def assemble(
    robot: Robot,
    q0: Vector | None = None,
    hold: str | Iterable[str] = (),
    *,
    tolerance: float = 1e-10,
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
    held = several(hold)
    with borrowed(robot, Assembler, *([held] if held else [])) as assembler:  # others borrow one that holds none, too
        assembler.tolerance = checked_tolerance(tolerance)
        assembler.limits = chosen_limits(robot, limits)
        return assembler.assemble(q, checked_count("restarts", restarts, 0))


def start(robot: Robot, q0: Vector | None = None, name: str = "q0") -> Vector:
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
    given = checked_array(name, q0, (tree.nq,))
    if tree.is_normalized(given, _ROUNDING):
        return np.array(given)
    q = tree.normalized(given)
    if not tree.is_normalized(q):  # NaN is not
        raise ValueError(f"{name} has a quaternion, or a (cos, sin) pair, whose length is zero or overflows")
    return q


class Assembler:
    """Closes the loops of one robot repeatedly; its structure is analysed once.

    Attributes:
        evaluations: One for each group of loops that share no joint with the others.
        iterations: Evaluations of the residual and its Jacobian so far. Groups that descend together count once.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        limits: The position limits to respect, or None.
    """

    def __init__(
        self, robot: Robot, hold: str | Iterable[str] = (), *, tolerance: float = 1e-10, limits: bool = False
    ) -> None:
        """The arguments are those of `assemble`."""
        # No reference to the robot: the cache would keep it alive.
        tree = self._tree = robot.tree
        self._names = [constraint.name for constraint in robot.constraints]
        loops = find_loops(robot)
        self._nc = loops[-1].rows.stop if loops else 0
        groups = list(independent_groups(robot, _held_velocities(tree, hold)))
        small = tree.nv <= _MOST_VELOCITIES_AT_ONCE
        whole = [merged(groups)] if small and len(groups) > 1 else []
        length = self._length = characteristic_length(robot)
        made = evaluations(
            robot,
            groups + whole,
            row_scale(robot, length),
            velocity_scale(robot, length),
        )
        self.evaluations = made[: len(groups)]
        self._whole = made[len(groups) :] if whole else self.evaluations
        self.iterations = 0
        self._work = 0.0  # of the current assembly, in multiplications
        self._is_decided = True  # whether the last assembly closed the loops or ended all descents
        self.tolerance = checked_tolerance(tolerance)
        self.limits = chosen_limits(robot, limits)

    def assemble(self, q: Vector, restarts: int = RESTARTS) -> Assembly:
        """Close the loops from q (nq,), then at most ``restarts`` times from configurations around it."""
        before = self.iterations
        with np.errstate(over="ignore", invalid="ignore"):  # lengths such as 1e200 m overflow and never close
            q, _ = self.close(q, restarts)
            r, open_by = np.zeros(self._nc), [(0.0, 0.0)] * len(self._names)
            for evaluation in self._whole:
                r[evaluation.group.rows] = evaluation.residual(q)
                for index, opening in zip(evaluation.group.closures, evaluation.openings(), strict=True):
                    open_by[index] = opening
        largest = float(np.abs(r).max(initial=0.0))
        enough = max(CLOSED, self.tolerance)
        converged = largest <= self.tolerance
        closes = all(part <= enough for opening in open_by for part in opening)  # NaN is not closed
        at_limits = () if closes or self.limits is None else self._pressed(q, self.limits)
        return Assembly(
            q=q,
            residual=math.hypot(*r),
            converged=converged,
            closes=closes,
            iterations=self.iterations - before,
            open=tuple(Opening(name, *opening) for name, opening in zip(self._names, open_by, strict=True)),
            reason=None if converged else "rounding" if closes else self._why_open(at_limits),
            at_limits=at_limits,
        )

    @np.errstate(over="ignore", invalid="ignore")
    def closed(self, q: Vector) -> Vector | None:
        """The configuration that one descent from q (nq,) leads to; None if that leaves a loop open, or close to it."""
        self._work = 0.0
        end, descents, _ = self._descend(self._within_limits(q, self.evaluations), self._whole)
        errors = [size for each in descents for size in (each.error, self._length * each.scaled_error)]
        return end if all(error <= _WELL_CLOSED for error in errors) else None

    def _why_open(self, at_limits: Sequence[JointAtLimit]) -> AssemblyReason:
        if not self._is_decided:
            return "not decided"
        return "joint limits" if at_limits else "not closed"

    @np.errstate(over="ignore", invalid="ignore")  # lengths such as 1e200 m overflow and never close
    def close(self, q: Vector, restarts: int = RESTARTS) -> tuple[Vector, list[float]]:
        """The final configuration (nq,), and the norm of the residual of each group there, m and rad.

        Args:
            q: Where to start (nq,).
            restarts: Maximum number of restarts while a group is open by more than `CLOSED`.
        """
        self._work = 0.0
        q = self._within_limits(q, self.evaluations)
        best, errors = np.array(q), [math.inf] * len(self.evaluations)
        tried = [False] * len(self.evaluations)  # whether a descent finished
        if self._whole is not self.evaluations:
            best, (descent,), (ended,) = self._descend(q, self._whole)
            errors = [math.hypot(*descent.r[evaluation.group.rows]) for evaluation in self.evaluations]
            tried = [ended] * len(self.evaluations)
        random: np.random.Generator | None = None
        for attempt in range(restarts + 1):
            still_open = [index for index, error in enumerate(errors) if not error <= CLOSED]
            if attempt > 0:
                still_open = [index for index in still_open if _feasible(self.evaluations[index])]
            if not still_open or (attempt > 0 and self._work > _MOST_WORK):
                break
            going, place = [self.evaluations[index] for index in still_open], q
            if attempt > 0:
                random = random or np.random.default_rng(0)
                spread = SPREADS[min(attempt, len(SPREADS)) - 1]
                away = [random.uniform(-spread, spread, len(evaluation.unit)) for evaluation in going]
                place = self._within_limits(self.moved(q, going, away), going)
            end, descents, ended_by_group = self._descend(place, going)
            for index, descent, ended in zip(still_open, descents, ended_by_group, strict=True):
                tried[index] |= ended
                if descent.error < errors[index]:
                    errors[index] = descent.error
                    coordinates = self.evaluations[index].group.coordinates
                    best[coordinates] = end[coordinates]
        still_open = [index for index, error in enumerate(errors) if not error <= CLOSED]
        stopped = self._work > _MOST_WORK or not any(tried[index] for index in still_open)
        self._is_decided = not (still_open and stopped)
        return best, errors

    def moved(self, q: Vector, going: Sequence[Evaluation], steps: Sequence[Vector]) -> Vector:
        """Configuration (nq,) after a step of each group; lengths are in characteristic lengths."""
        v = np.zeros(self._tree.nv)
        for evaluation, step in zip(going, steps, strict=True):
            v[evaluation.group.velocities] = evaluation.unit * step
        # Pinocchio normalizes quaternions to first order only.
        return self._tree.normalized(self._tree.integrate(q, v))

    def _descend(self, q: Vector, going: Sequence[Evaluation]) -> tuple[Vector, list[Descent], list[bool]]:
        """The configuration (nq,) after the descents of the groups, the descents, and whether each finished."""
        q = np.array(q)
        self.iterations += 1
        descents = [Descent(evaluation, q) for evaluation in going]
        moving: list[Descent] = []
        for _ in range(MOST_STEPS):
            moving = [descent for descent in descents if descent.error > self.tolerance and not descent.stuck]
            feasible = [descent for descent in moving if _feasible(descent.evaluation)]
            self._work += sum(descent.evaluation.work for descent in feasible)
            if not feasible or self._work > _MOST_WORK:
                break
            steps = [descent.step(self._room(q, descent.evaluation)) for descent in feasible]
            trial = self.moved(q, [descent.evaluation for descent in feasible], steps)
            self.iterations += 1
            for descent in feasible:
                if descent.arrive(trial):
                    coordinates = descent.evaluation.group.coordinates
                    q[coordinates] = trial[coordinates]
        else:
            moving = []
        cut = set(moving)
        return q, descents, [descent not in cut for descent in descents]

    def _within_limits(self, q: Vector, going: Sequence[Evaluation]) -> Vector:
        if self.limits is None or not going:
            return q
        return self.limits.clip(q, np.concatenate([evaluation.group.velocities for evaluation in going]))

    @np.errstate(over="ignore", invalid="ignore")
    def _pressed(self, q: Vector, limits: PositionLimits) -> tuple[JointAtLimit, ...]:
        """The joints at their limits that the descent direction -Kᵀ r would move beyond them."""
        down = np.zeros(self._tree.nv)
        for evaluation in filter(_feasible, self._whole):
            b = evaluation.row_scale * evaluation.residual(q)
            down[evaluation.group.velocities] = -evaluation.jacobian().T @ b
        return limits.pressed(q, down)

    def _room(self, q: Vector, evaluation: Evaluation) -> tuple[Vector, Vector] | None:
        """Distance to the lower and upper limits, by velocity of a group, in rad and characteristic lengths."""
        if self.limits is None:
            return None
        down, up = self.limits.room(q, evaluation.group.velocities)
        return down / evaluation.unit, up / evaluation.unit


def _feasible(evaluation: Evaluation) -> bool:
    return evaluation.work <= _MOST_WORK


def _held_velocities(tree: TreeKinematics, names: str | Iterable[str]) -> list[int]:
    return [velocity for name in several(names) for velocity in tree.velocities_of(name)]
