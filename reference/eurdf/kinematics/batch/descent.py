"""Closing the loops of many elements at once, by the steps of `eurdf.kinematics.descent`.

Each element has its own damping and its own end. The steps of one do not depend on the others.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.batch import linear
from eurdf.kinematics.batch.problem import Group, Problem
from eurdf.kinematics.batch.stack import State
from eurdf.kinematics.opening import CLOSED
from eurdf.kinematics.position_limit import PositionLimits

# As in `eurdf.kinematics.assembly` and `eurdf.kinematics.descent`, so that results are the same.
_MOST_STEPS = 60
_MOST_IDLE_STEPS = 6
_SPREADS = (0.1, 0.3, 1.0, 2.0, 3.0)


def close(
    problem: Problem,
    groups: Sequence[Group],
    q: Matrix,
    tolerance: float,
    restarts: int = 0,
    limits: PositionLimits | None = None,
) -> tuple[Matrix, Mask]:
    """Bring the residual to zero from q (nq, B), as `eurdf.kinematics.assembly.Assembler` does.

    Args:
        problem: The robot.
        groups: Groups of its loops, and the velocities that move.
        q: Where to start (nq, B).
        tolerance: Bound of each row of the residual, m or rad.
        restarts: Maximum number of restarts while a group is open.
        limits: The position limits to respect, or None.

    Returns:
        The configurations (nq, B) with the least residual, and whether all loops are closed there (B,).
    """
    q = _clipped(q, groups, limits)
    best = np.array(q)
    errors = np.full((len(groups), q.shape[1]), np.inf)
    if problem.at_once and len(groups) > 1:
        best, squares = descend(problem, groups, q, tolerance, limits)
        errors = np.sqrt(squares)
    for index, group in enumerate(groups):
        random = np.random.default_rng(0)
        for attempt in range(restarts + 1):
            still_open = np.flatnonzero(~(errors[index] <= CLOSED))
            if not len(still_open):
                break
            place = q[:, still_open]
            if attempt > 0:
                spread = _SPREADS[min(attempt, len(_SPREADS)) - 1]
                v = np.zeros((problem.tree.nv, 1))
                v[group.stack.velocities, 0] = group.unit * random.uniform(-spread, spread, len(group.unit))
                place = problem.tree.integrate(place, np.broadcast_to(v, (len(v), len(still_open))))
                place = _clipped(place, [group], limits)
            end, squares = descend(problem, [group], place, tolerance, limits)
            better = np.flatnonzero(np.sqrt(squares[0]) < errors[index, still_open])
            errors[index, still_open[better]] = np.sqrt(squares[0, better])
            best[np.ix_(group.coordinates, still_open[better])] = end[np.ix_(group.coordinates, better)]
    return best, closes(groups, best, tolerance)


def closes(groups: Sequence[Group], q: Matrix, tolerance: float) -> Mask:
    """Whether all loops are closed at q (nq, B), within `CLOSED` or the tolerance if that is larger."""
    closed = np.ones(q.shape[1], dtype=bool)
    for group in groups:
        closed &= group.stack.closes(group.stack.at(q), max(CLOSED, tolerance))
    return closed


def _clipped(q: Matrix, groups: Sequence[Group], limits: PositionLimits | None) -> Matrix:
    if limits is None or not groups:
        return q
    return clip(limits, q, np.concatenate([group.stack.velocities for group in groups]))


def clip(limits: PositionLimits, q: Matrix, velocities: Indices) -> Matrix:
    """The configurations (nq, B) with the coordinates that the given velocities drive clipped to their limits."""
    bounded = velocities[np.isfinite(limits.lower[velocities]) | np.isfinite(limits.upper[velocities])]
    coordinates, within = limits.coordinates[bounded], np.array(q)
    within[coordinates] = np.clip(q[coordinates], limits.lower[bounded, None], limits.upper[bounded, None])
    return within


def room(limits: PositionLimits, q: Matrix, velocities: Indices) -> tuple[Matrix, Matrix]:
    """Distances (n, B) from q to the lower limits (at most 0) and to the upper limits (at least 0), by velocity."""
    at = q[limits.coordinates[velocities]]
    lower, upper = limits.lower[velocities, None], limits.upper[velocities, None]
    return np.minimum(lower - at, 0.0), np.maximum(upper - at, 0.0)


def descend(
    problem: Problem, groups: Sequence[Group], q: Matrix, tolerance: float, limits: PositionLimits | None = None
) -> tuple[Matrix, Matrix]:
    """Levenberg-Marquardt steps of groups that go together, from q (nq, B).

    Returns:
        Where they end (nq, B), and the squared norm of the residual of each group there, (groups, B), m² and rad².
    """
    q = np.array(q)
    state = _Descents(groups, q)
    for _ in range(_MOST_STEPS):
        moving = np.flatnonzero((state.errors() > tolerance) & ~state.stuck())
        if not len(moving):
            break
        steps = state.steps(q, moving, limits)
        v = np.zeros((problem.tree.nv, len(moving)))
        for group, step in zip(groups, steps, strict=True):
            v[group.stack.velocities] = group.unit[:, None] * step
        trial = problem.tree.integrate(q[:, moving], v)
        accepted = state.arrive(trial, moving)
        q[:, moving[accepted]] = trial[:, accepted]
    return q, state.squares


class _Descents:
    """The state of the descents of all elements; see `eurdf.kinematics.descent.Descent`."""

    def __init__(self, groups: Sequence[Group], q: Matrix) -> None:
        B = q.shape[1]
        self._groups = groups
        self._at = [group.stack.at(q) for group in groups]
        self._here = np.arange(B)  # the elements that `_at` is of
        r = [group.stack.residual(at) for group, at in zip(groups, self._at, strict=True)]
        self.squares = np.array([(each * each).sum(axis=0) for each in r]).reshape(len(groups), B)
        self._b = [group.row_scale[:, None] * each for group, each in zip(groups, r, strict=True)]
        self._A = [np.empty((group.stack.m, group.stack.n, B)) for group in groups]
        self._stale: Mask = np.ones(B, dtype=bool)
        self._square = _sum_of_squares(self._b, B)
        self._damping, self._more = np.full(B, 1e-3), np.full(B, 8.0)
        self._expected = np.full(B, np.inf)
        self._idle = np.zeros(B, dtype=np.intp)

    def errors(self) -> Vector:
        """Norms (B,) of the residuals, m and rad."""
        return np.asarray(np.sqrt(self.squares.sum(axis=0)))

    def stuck(self) -> Mask:
        """Whether further steps are not worthwhile (B,)."""
        return (self._idle > _MOST_IDLE_STEPS) | ~(self._expected > 1e-12 * self._square)

    def steps(self, q: Matrix, moving: Indices, limits: PositionLimits | None) -> list[Matrix]:
        """The next steps (n, k) of each group, for elements by index (k,), of at most 1 rad or length."""
        self._refresh(q, moving)
        everything = len(moving) == q.shape[1]
        A = [each if everything else each[:, :, moving] for each in self._A]
        b = [each if everything else each[:, moving] for each in self._b]
        damping = self._damping[moving] * self._square[moving]
        steps = _damped(A, b, damping)
        rooms: list[tuple[Matrix, Matrix]] = []
        if limits is not None:
            rooms = [room(limits, q[:, moving], group.stack.velocities) for group in self._groups]
            rooms = [
                (down / group.unit[:, None], up / group.unit[:, None])
                for group, (down, up) in zip(self._groups, rooms, strict=True)
            ]
            _stay_within(A, b, damping, steps, rooms)
        largest = np.ones(len(moving))
        for step in steps:
            largest = np.maximum(largest, np.abs(step).max(axis=0, initial=0.0))
        steps = [step / largest for step in steps]
        if limits is not None:
            steps = [np.clip(step, *bounds) for step, bounds in zip(steps, rooms, strict=True)]
        predicted = _sum_of_squares(
            [of_b + linear.times(of_A, step) for of_b, of_A, step in zip(b, A, steps, strict=True)], len(moving)
        )
        self._expected[moving] = self._square[moving] - predicted
        return steps

    def arrive(self, trial: Matrix, moving: Indices) -> Mask:
        """Whether the steps of the elements moving (k,) to these configurations (nq, k) are accepted."""
        at = [group.stack.at(trial) for group in self._groups]
        r = [group.stack.residual(each) for group, each in zip(self._groups, at, strict=True)]
        b = [group.row_scale[:, None] * each for group, each in zip(self._groups, r, strict=True)]
        before, reached, expected = self._square[moving], _sum_of_squares(b, len(moving)), self._expected[moving]
        gain = np.zeros(len(moving))
        np.divide(before - reached, expected, out=gain, where=expected > 0.0)
        self._idle[moving] = np.where(reached < 0.98 * before, 0, self._idle[moving] + 1)
        accepted: Mask = gain > 0.01
        there, refused = moving[accepted], moving[~accepted]
        self._damping[refused] *= self._more[refused]
        self._more[refused] *= 2.0
        self._more[there] = 8.0
        good = gain[accepted]
        factor = np.where(good > 0.75, 0.1, np.where(good > 0.25, 1.0, 4.0))
        self._damping[there] = np.maximum(self._damping[there] * factor, 1e-8)
        self._square[there] = reached[accepted]
        for own, (each_r, each_b) in enumerate(zip(r, b, strict=True)):
            self.squares[own, there] = (each_r * each_r).sum(axis=0)[accepted]
            self._b[own][:, there] = each_b[:, accepted]
        self._stale[there] = True
        self._at, self._here = (at, moving) if accepted.all() else ([], moving)
        return accepted

    def _refresh(self, q: Matrix, moving: Indices) -> None:
        """Evaluate the derivatives of the elements that have moved since."""
        stale = moving[self._stale[moving]]
        if not len(stale):
            return
        at: Sequence[State] = self._at
        if not (self._at and np.array_equal(stale, self._here)):
            at = [group.stack.at(q[:, stale]) for group in self._groups]
        for group, each, A in zip(self._groups, at, self._A, strict=True):
            A[:, :, stale] = group.jacobian(each)
        self._stale[stale] = False


def _sum_of_squares(parts: Sequence[Matrix], B: int) -> Vector:
    total = np.zeros(B)
    for part in parts:
        total += (part * part).sum(axis=0)
    return total


def _gram(A: Matrix) -> Matrix:
    """The smaller of A Aᵀ and Aᵀ A."""
    m, n, _ = A.shape
    return linear.gram(A if m < n else np.swapaxes(A, 0, 1))


def _damped(parts: Sequence[Matrix], residuals: Sequence[Matrix], damping: Vector) -> list[Matrix]:
    """The δ (n, B) that minimise Σ |A δ + b|² + λ |δ|², from the smaller of A Aᵀ and Aᵀ A of each group."""
    grams = [_gram(A) for A in parts]
    trace = sum(np.einsum("iib->b", G) for G in grams)
    damping = np.maximum(np.maximum(damping, 1e-13 * trace), 1e-300)  # invertible even with redundant rows
    steps = []
    for A, gram, b in zip(parts, grams, residuals, strict=True):
        m, n, _ = A.shape
        G = np.array(gram)
        for index in range(len(G)):
            G[index, index] += damping
        if m < n:
            steps.append(linear.times_back(A, linear.solve(G, -b)[0]))
        else:
            steps.append(linear.solve(G, linear.times_back(A, -b))[0])
    return steps


def _stay_within(
    parts: Sequence[Matrix],
    residuals: Sequence[Matrix],
    damping: Vector,
    steps: list[Matrix],
    rooms: Sequence[tuple[Matrix, Matrix]],
) -> None:
    """Change the steps so that joints at a limit stay there if they would exceed it, and the others compensate."""
    held = [np.zeros(step.shape, dtype=bool) for step in steps]
    while True:
        again = np.zeros(len(damping), dtype=bool)
        for step, (down, up), own in zip(steps, rooms, held, strict=True):
            blocked = ~own & (((step < 0.0) & (down == 0.0)) | ((step > 0.0) & (up == 0.0)))
            own |= blocked
            again |= blocked.any(axis=0)
        which = np.flatnonzero(again)
        if not len(which):
            return
        moving = [np.where(own[:, which], 0.0, A[:, :, which]) for A, own in zip(parts, held, strict=True)]
        changed = _damped(moving, [b[:, which] for b in residuals], damping[which])
        for step, new, own in zip(steps, changed, held, strict=True):
            step[:, which] = np.where(own[:, which], 0.0, new)
