"""Inverse kinematics of targets that are near: Newton's method on the closures and the targets at once.

A target is a closure between the world, at the target, and the frame. Only the loops that share joints with what
carries the frames move. Where the steps do not end on the branch of the start beyond doubt, the search of
`eurdf.kinematics.inverse_search` has to find a configuration.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.closures.frame import kind_of_target
from eurdf.closures.kind import PoseArrays
from eurdf.closures.se3 import IDENTITY_ROTATION, transposed, turned
from eurdf.kinematics.descend import damped
from eurdf.kinematics.evaluate import Evaluator, Frames, frames_at
from eurdf.kinematics.loop import independent_groups, merged
from eurdf.kinematics.rank import Numbers, choose, every, largest, numbers, some, square, squares, times
from eurdf.kinematics.tangent_space import AlikeBlocks, TangentSpaces, decomposed
from eurdf.kinematics.tolerances import (
    LEAST_DAMPING,
    MOST_CORRECTION,
    MOST_STEPS,
    MOST_VELOCITIES_AT_ONCE,
    SMALL,
    SOLVED,
    WELL_CLOSED,
)
from eurdf.mechanism.body import Anchor
from eurdf.pinocchio.memory import working_memory
from eurdf.pinocchio.tree_few import as_slice

if TYPE_CHECKING:
    from eurdf.kinematics.frame_targets import Target
    from eurdf.kinematics.position_limit import PositionLimits
    from eurdf.kinematics.problem import Problem
    from eurdf.mechanism.constraint import Constraint
    from eurdf.pinocchio.robot import Robot
    from eurdf.pinocchio.tree import Tree
    from eurdf.pinocchio.tree_few import Site

# Half of the way has half of the correction, relative to its first step: sure if that of the whole is at most this.
_MOST_TO_HALVE = 1.6 * MOST_CORRECTION
# Each step reduces the squared residual to this fraction at least, or the target is left to the search.
_REDUCED = 0.25


class Near(NamedTuple):
    """Where the steps lead; B elements.

    Attributes:
        q: Configurations (B, nq); those of the start where they are in doubt.
        position: Distances (B, F) of the frames from their targets, m.
        angle: Angles (B, F) between their axes and those of the targets, rad; 0 for targets that are positions.
        iterations: Numbers (B,) of steps.
        reached: Whether (B,) loops are closed, frames at their targets, and the branch is certainly that of the start.
        openings: How far each constraint is open (B, c) each, m and rad, where that is known.
    """

    q: Matrix
    position: Matrix
    angle: Matrix
    iterations: Indices
    reached: Mask
    openings: tuple[Matrix, Matrix] | None


class _Stepped(NamedTuple):
    """Where steps lead.

    Attributes:
        q: The configuration (1, nq).
        at: The state there.
        arrived: Whether they end there for certain.
        steps: Their number.
        correction: How long all but the first are, together, relative to it.
    """

    q: Matrix
    at: Any
    arrived: bool
    steps: int
    correction: float


class _Targets:
    """Targets of B elements as closures, as an `Evaluator` has them for few elements."""

    def __init__(self, frames: Frames, goals: Sequence[Target]) -> None:
        self._frames, self._goals = frames, goals
        self._each = []  # its kind, its pose (B, 1), and the twist seen from it by that in the world (B, 1, 6, 6)
        for goal in goals:
            turn = np.broadcast_to(IDENTITY_ROTATION, (len(goal.position), 3, 3))
            at = PoseArrays((turn if goal.rotation is None else goal.rotation)[:, None], goal.position[:, None])
            self._each.append((kind_of_target(goal.rotation is not None), at, at.twist_in_b()))

    def among(self, which: Mask) -> _Targets:
        """Those of some elements."""
        return _Targets(self._frames, [goal.among(which) for goal in self._goals])

    def fresh(self, q: Matrix) -> tuple[Any, list[PoseArrays]]:
        """The frames, and the frames seen from the targets, at q (B, nq)."""
        frames, seen = self._frames.fresh(q), []
        for index, (_, target, _) in enumerate(self._each):
            own, back = frames.of(slice(index, index + 1)), transposed(target.rotation)
            seen.append(PoseArrays(back @ own.rotation, turned(back, own.position - target.position)))
        return frames, seen

    def residual(self, at: tuple[Any, list[PoseArrays]]) -> Matrix:
        """The residual (B, k)."""
        rows = [kind.residual(seen, None)[:, 0] for (kind, _, _), seen in zip(self._each, at[1], strict=True)]
        return np.concatenate(rows, axis=1)

    def jacobian(self, at: tuple[Any, list[PoseArrays]]) -> Matrix:
        """Its derivative (B, k, n)."""
        frames, each_seen = at
        each = enumerate(zip(self._each, each_seen, strict=True))
        J = [self._frames.rows(frames, kind.jacobian(s, None) @ X, slice(i, i + 1)) for i, ((kind, _, X), s) in each]
        return np.concatenate(J, axis=1)

    def openings(self, at: tuple[Any, list[PoseArrays]]) -> tuple[Matrix, Matrix]:
        """How far the frames are from their targets (B, F), m and rad."""
        found = [kind.opening(seen, None) for (kind, _, _), seen in zip(self._each, at[1], strict=True)]
        lengths, angles = zip(*found, strict=True)
        return np.concatenate(lengths, axis=1), np.concatenate(angles, axis=1)


class _InTurn(NamedTuple):
    """Closures and targets that are evaluated one after the other, as an `Evaluator` evaluates both."""

    closures: Evaluator
    targets: Any

    def among(self, which: Mask) -> _InTurn:
        return _InTurn(self.closures, self.targets.among(which))

    def fresh(self, q: Matrix) -> tuple[Any, Any]:
        return self.closures.fresh(q), self.targets.fresh(q)

    def residual(self, at: tuple[Any, Any]) -> Matrix:
        return np.concatenate((self.closures.residual(at[0]), self.targets.residual(at[1])), axis=1)

    def jacobian(self, at: tuple[Any, Any]) -> Matrix:
        return np.concatenate((self.closures.jacobian(at[0]), self.targets.jacobian(at[1])), axis=1)

    def openings(self, at: tuple[Any, Any]) -> tuple[Matrix, Matrix]:
        found: tuple[Matrix, Matrix] = self.targets.openings(at[1])
        return found


class InverseNewton:
    """Takes the steps for F frames of a robot. For few elements it has memory for one thread; else it is plain data."""

    def __init__(self, robot: Robot, poses: tuple[bool, ...], *names: str, few: bool = True) -> None:
        """Take of each frame whether its targets are poses, and its name.

        Raises:
            ValueError: A frame is unknown, or two different frames have this name.
        """
        tree, spaces, sites = robot.tree, robot.cached(TangentSpaces), robot.tree.frame_sites(names)
        moving = set[int]()
        for joint, _ in sites:
            while joint:
                moving.update(tree.moving_velocities[joint])
                joint = tree.parents[joint]
        groups = [each for each in independent_groups(robot) if moving.intersection(each.velocities.tolist())]
        loops = merged(groups)
        own: Indices = np.array(sorted(moving.union(loops.velocities.tolist())), dtype=np.intp)
        closures = [robot.constraints[index] for index in loops.closures]
        # What evaluates the targets, together with the closures if that does not take too much memory.
        self._placed, self._closures = None, None
        for others in (closures, []) if few else ():
            found = _with_targets(tree, others, poses, names, sites, own)
            if found.is_by_pinocchio:
                self._placed, self._first = found, len(others)
                break
        else:
            self._frames, self._first = frames_at(tree, sites, own, few=False), 0
        if self._first < len(closures) or self._placed is None:
            self._closures = Evaluator(tree, closures, own, few=few)
        self._columns = as_slice(own)
        self._unit, self._m = spaces.scale[own], len(loops.rows)
        rows = [scale for is_pose in poses for scale in [1.0 / spaces.length] * 3 + [1.0] * 3 * is_pose]
        self._row_scale = np.concatenate((spaces.row_scale[loops.rows], rows))
        self._factors = self._row_scale[:, None] * self._unit
        self._blocks: list[AlikeBlocks] = []
        if len(own) > MOST_VELOCITIES_AT_ONCE:  # less time than all at once
            alike: dict[tuple[int, int], list[tuple[Indices, Indices]]] = {}
            for group in groups:
                where = np.searchsorted(loops.rows, group.rows), np.searchsorted(own, group.velocities)
                alike.setdefault((len(where[0]), len(where[1])), []).append(where)
            for each in alike.values():
                rows_of, velocities_of = map(np.array, zip(*each, strict=True))
                self._blocks.append(AlikeBlocks.of_units(rows_of, velocities_of, self._row_scale, self._unit))
        self._outside = np.flatnonzero(~np.isin(own, loops.velocities))
        small = min(1.0, spaces.length / SMALL)
        self._closed = (WELL_CLOSED * small) ** 2, (SOLVED * small) ** 2
        self._has_all = len(closures) == len(robot.constraints)

    def near(
        self, problem: Problem, goals: Sequence[Target], q: Matrix, limits: PositionLimits | None, tolerance: float
    ) -> Near:
        """The configurations near q (B, nq) at which the frames are at their targets.

        The first step keeps the loops closed. The others are together shorter than it by as much as
        `eurdf.kinematics.path.is_short` demands of what closes the loops after a step.
        """
        B, F = len(q), len(goals)
        if B == 1 and F:
            return self._near_one(problem, goals, q, limits, tolerance)
        aimed = self._aimed(goals)
        on, here, end = np.arange(B), q, np.array(q)
        position, angle = np.zeros((2, B, F))
        steps, reached = np.zeros(B, dtype=np.intp), np.zeros(B, dtype=bool)
        openings: tuple[Matrix, Matrix] | None = None
        if not F:
            return Near(end, position, angle, steps, reached, openings)
        before, first, later = numbers(B, np.inf), numbers(B, 1.0), numbers(B, 0.0)
        well_closed, solved = self._closed
        for step in range(MOST_STEPS + 1):
            at = aimed.fresh(here)
            r = aimed.residual(at)
            b = self._row_scale * r
            opened, squared = square(r[:, : self._m]), square(b)
            there = largest(r[:, self._m :]) <= tolerance
            done = there & (opened <= solved)
            if some(done):
                which = slice(None) if every(done) else done
                lengths, angles = aimed.openings(at)
                own = on[which]
                end[own], reached[own] = here[which], step > 0
                position[own], angle[own] = lengths[which, -F:], angles[which, -F:]
                if self._has_all and self._closures is None and len(own) == B:
                    openings = lengths[:, :-F], angles[:, :-F]
            going = choose(done, False, squared < _REDUCED * before)
            if not step:  # a solution is left as it is
                going = choose(there, False, going & (opened <= well_closed))
            if some(going):
                x = self._least(aimed.jacobian(at), b, LEAST_DAMPING * squared)
                length = square(x) ** 0.5
                first, later = (first, later + length) if step else (length, later)
                going = going & (first <= 1.0) & (later <= MOST_CORRECTION * first)
            if not every(going):
                steps[on] = step
                if not some(going):
                    break
                aimed, on, here, x = aimed.among(going), on[going], here[going], x[going]
                squared, first, later = squared[going], first[going], later[going]
            v = np.zeros((len(on), problem.tree.nv))
            v[:, self._columns] = self._unit * x
            here, before = problem.tree.integrate(here, v), squared
        if np.count_nonzero(reached):
            reached &= np.logical_and.reduce(np.maximum(position, angle) <= tolerance, axis=1)
            if limits is not None:
                reached &= np.logical_and.reduce(limits.are_kept(np.concatenate((q, end))).reshape(2, B))
            if not self._has_all:
                reached &= squares(problem.residual(end)) <= solved
        return Near(end, position, angle, steps, reached, openings)

    def _near_one(
        self, problem: Problem, goals: Sequence[Target], q: Matrix, limits: PositionLimits | None, tolerance: float
    ) -> Near:
        """As `near`, of one element; where the branch is a little in doubt, half of the way first."""
        F, aimed, here, steps = len(goals), self._aimed(goals), q, 0
        at = aimed.fresh(q)
        (r,) = aimed.residual(at)
        away, left, part = r[self._m :].copy(), 1.0, 1.0  # of the way to the targets what is left, and what goes next
        on_way = square(r[None, : self._m]) <= self._closed[0] and not largest(away[None]) <= tolerance
        while on_way and left:
            found = self._stepped(problem, aimed, here, at, (left - part) * away, tolerance)
            steps += found.steps
            on_way = limits is None or not limits.are_exceeded(np.concatenate((q, found.q)))
            if found.arrived:
                here, at, left = found.q, found.at, left - part
            else:
                part, on_way = 0.5, on_way and part > 0.5 and found.correction <= _MOST_TO_HALVE
        if on_way:
            lengths, angles = aimed.openings(at)
            position, angle = lengths[:, -F:], angles[:, -F:]
            on_way = max(*position[0].tolist(), *angle[0].tolist()) <= tolerance
            on_way = on_way and (self._has_all or square(problem.residual(here)) <= self._closed[1])
        if not on_way:
            position, angle = np.zeros((2, 1, F))
            return Near(np.array(q), position, angle, np.array([steps]), np.zeros(1, dtype=bool), None)
        openings = (lengths[:, :-F], angles[:, :-F]) if self._has_all and self._closures is None else None
        return Near(here, position, angle, np.array([steps]), np.ones(1, dtype=bool), openings)

    def _stepped(self, problem: Problem, aimed: Any, q: Matrix, at: Any, rest: Vector, tolerance: float) -> _Stepped:
        """Steps from a closed configuration (1, nq), in a state, to where ``rest`` (k,) of the targets' rows is left.

        The last ones to the targets count with the tolerance; others only close the loops.
        """
        before, first, later, is_last = np.inf, 0.0, 0.0, not np.count_nonzero(rest)
        well_closed, solved = self._closed
        for step in range(MOST_STEPS):
            (r,) = aimed.residual(at)
            is_closed = square(r[None, : self._m]) <= (solved if is_last else well_closed)
            if step and is_closed and (not is_last or largest(r[None, self._m :]) <= tolerance):
                return _Stepped(q, at, True, step, later / first)
            b = self._row_scale * r
            if not is_last:
                b[self._m :] -= self._row_scale[self._m :] * rest
            squared = float(b.dot(b))
            if not squared < _REDUCED * before:
                return _Stepped(q, at, False, step, np.inf)
            (x,) = self._least(aimed.jacobian(at), b[None], LEAST_DAMPING * squared)
            length = math.sqrt(x.dot(x))
            first, later = (first, later + length) if step else (length, later)
            if not (first <= 1.0 and later <= MOST_CORRECTION * first):
                break
            v = np.zeros((1, problem.tree.nv))
            v[0, self._columns] = self._unit * x
            q, before = problem.tree.integrate(q, v), squared
            at = aimed.fresh(q)
        return _Stepped(q, at, False, step, later / first)

    def _least(self, J: Matrix, b: Matrix, damping: Numbers) -> Matrix:
        """The x (B, n) of least norm that solve A x = -b, of b (B, m + k), with A the dimensionless J (B, m + k, n).

        Of a large robot, those of the groups of loops close them, and free motions of the groups reach the targets.
        """
        if not self._blocks:
            (x,) = damped([J * self._factors], [b], damping)
            return np.asarray(x)
        B, m, to_targets = len(J), self._m, J[:, self._m :] * self._factors[self._m :]
        x, free, along = np.zeros((B, J.shape[2])), [], [to_targets[:, :, self._outside]]
        for block in self._blocks:
            A = block.of(J) * block.factors
            found = decomposed(A.reshape(-1, *A.shape[2:]))
            opened = b[:, block.rows].reshape(-1, A.shape[2])
            x[:, block.velocities] = -times(found.inverse, opened).reshape(B, *block.velocities.shape)
            Z = found.right * (np.arange(A.shape[3]) >= found.rank[:, None])[:, None]
            free.append(Z.reshape(B, -1, *Z.shape[1:]))
            moved = to_targets[:, :, block.velocities].swapaxes(1, 2) @ free[-1]
            along.append(moved.swapaxes(1, 2).reshape(B, to_targets.shape[1], -1))
        (y,) = damped([np.concatenate(along, axis=2)], [b[:, m:] + times(to_targets, x)], damping)
        x[:, self._outside], first = y[:, : len(self._outside)], len(self._outside)
        for block, Z in zip(self._blocks, free, strict=True):
            last = first + block.velocities.size
            x[:, block.velocities] += (Z @ y[:, first:last].reshape(*Z.shape[:3], 1))[..., 0]
            first = last
        return x

    def _aimed(self, goals: Sequence[Target]) -> Any:
        """What evaluates the closures and the targets."""
        targets: Any = self._placed
        if self._placed is None:
            targets = _Targets(self._frames, goals)
        else:
            for index, goal in enumerate(goals, self._first):
                turn = IDENTITY_ROTATION if goal.rotation is None else goal.rotation[0]
                self._placed.place(index, turn, goal.position[0])
        return targets if self._closures is None else _InTurn(self._closures, targets)


def _with_targets(
    tree: Tree,
    closures: Sequence[Constraint],
    poses: Sequence[bool],
    names: Sequence[str],
    sites: Sequence[Site],
    own: Indices,
) -> Evaluator:
    """An evaluator of closures, followed by the targets of frames, for few elements."""
    nowhere = Anchor("")
    targets = [kind_of_target(is_pose)(name, nowhere, nowhere) for is_pose, name in zip(poses, names, strict=True)]
    pairs = {index: (tree.world, site) for index, site in enumerate(sites, len(closures))}
    return Evaluator(tree, [*closures, *targets], own, few=True, sites=pairs)


def newton_for_many(robot: Robot, poses: tuple[bool, ...], names: Sequence[str]) -> InverseNewton:
    """The steps for many elements at once; made once and shared."""
    with working_memory(robot, _for_many, poses, *names) as newton:
        return newton


def _for_many(robot: Robot, poses: tuple[bool, ...], *names: str) -> InverseNewton:
    return InverseNewton(robot, poses, *names, few=False)
