"""Levenberg-Marquardt steps towards the closed configurations.

A step δ solves (AᵀA + λ1) δ = -Aᵀb, with b the residual and A its derivative, in units of the characteristic length.
Since λ is proportional to |b|², steps are small far from a solution, and convergence near it is quadratic, even with
redundant rows. Each element has its own damping and its own end; elements that have ended are left out of the arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.position_limit import PositionLimits
from eurdf.kinematics.problem import Group, Problem
from eurdf.kinematics.rank import diagonals, solutions, squares
from eurdf.kinematics.tolerances import (
    FIRST_DAMPING,
    GOOD_SHARE,
    IDLE,
    LEAST_DAMPING,
    LEAST_GAIN,
    LEAST_SHARE,
    MORE_DAMPING,
    MOST_IDLE_STEPS,
    MOST_STEPS,
    POOR_SHARE,
)


class Descended(NamedTuple):
    """Where descents end; B elements.

    Attributes:
        q: Configurations (B, nq).
        residuals: Of each group its residual (B, m), m and rad.
        square: Squared norms (B,) of all residuals, m² and rad².
        scaled_square: The same of the dimensionless residuals.
        steps: Numbers (B,) of steps tried.
        cut: Which descents (B,) would have gone on, but for the bound of their steps.
    """

    q: Matrix
    residuals: list[Matrix]
    square: Vector
    scaled_square: Vector
    steps: Indices
    cut: Mask

    def copy(self) -> Descended:
        """The same in arrays of its own."""
        q, residuals = np.array(self.q), [np.array(each) for each in self.residuals]
        square, scaled_square = np.array(self.square), np.array(self.scaled_square)
        return Descended(q, residuals, square, scaled_square, np.array(self.steps), np.array(self.cut))

    def keep(self, here: Descended, which: Mask, elements: Indices) -> None:
        """Write some of other descents, those of these elements, to where they belong."""
        to = elements[which]
        for whole, own in zip(self.residuals, here.residuals, strict=True):
            whole[to] = own[which]
        self.q[to], self.square[to], self.scaled_square[to] = (
            here.q[which],
            here.square[which],
            here.scaled_square[which],
        )
        self.steps[to], self.cut[to] = here.steps[which], here.cut[which]


_FACTORS = np.array([4.0, 1.0, 0.1])


def next_damping(damping: Vector, gain: Vector) -> Vector:
    """The damping after accepted steps that reduced the square by so much of what was expected."""
    factor = _FACTORS[np.add(gain > POOR_SHARE, gain > GOOD_SHARE, dtype=np.intp)]
    return np.asarray(np.maximum(damping * factor, LEAST_DAMPING))


def descend(
    problem: Problem,
    groups: Sequence[Group],
    q: Matrix,
    tolerance: float,
    limits: PositionLimits | None = None,
    most: Indices | None = None,
) -> Descended:
    """Steps of groups that go together, with one damping.

    Args:
        problem: The robot.
        groups: The groups.
        q: Where to start (B, nq).
        tolerance: A descent ends where the norm of the residual is at most this, m and rad.
        limits: The position limits to respect, or None.
        most: Bound (B,) of the steps of each element, if it is less than `MOST_STEPS`.
    """
    B, enough = len(q), tolerance * tolerance
    on, ended = np.arange(B), None
    at = [group.evaluator.at(q) for group in groups]
    r = [group.evaluator.residual(each) for group, each in zip(groups, at, strict=True)]
    error, square = before, expected = measured(groups, r)
    if not np.count_nonzero(error > enough):
        return Descended(q, r, error, square, np.zeros(B, dtype=np.intp), np.zeros(B, dtype=bool))
    A: list[Matrix] = []
    damping, more, idle = np.full(B, FIRST_DAMPING), np.full(B, MORE_DAMPING), np.zeros(B, dtype=np.intp)
    stale: Mask | None = None  # whose A is not that at q; None for all of them, with the states `at`
    for step in range(MOST_STEPS + 1):
        going, cut = error > enough, None
        if step and np.count_nonzero(going):
            idle = (idle + 1) * ~(square < (1.0 - IDLE) * before)
            going &= (idle <= MOST_IDLE_STEPS) & (expected > LEAST_GAIN * square)
        if most is not None:
            cut = going & (most[on] <= step)
            going &= ~cut
        count = np.count_nonzero(going) if step < MOST_STEPS else 0
        if count < len(on) or not count:
            no: Mask = np.zeros(len(on), dtype=bool)
            here = Descended(q, r, error, square, np.full(len(on), step), no if cut is None else cut)
            if not count and ended is None:
                return here  # all at once
            ended = here.copy() if ended is None else ended
            ended.keep(here, ~going if count else ~no, on)
            if not count:
                break
            on, q, r, A = on[going], q[going], [each[going] for each in r], [each[going] for each in A]
            error, square, damping, more, idle = error[going], square[going], damping[going], more[going], idle[going]
            if stale is None:
                at = [group.evaluator.at(q) for group in groups]
            else:
                stale = stale[going]
        if stale is None:
            A = [group.jacobian(each) for group, each in zip(groups, at, strict=True)]
        elif stale.any():
            for group, own in zip(groups, A, strict=True):
                own[stale] = group.jacobian_at(q[stale])
        b = [group.row_scale * each for group, each in zip(groups, r, strict=True)]
        steps = _steps(groups, A, b, q, damping * square, limits)
        expected = square - _predicted(A, steps, b)
        trial = problem.moved(q, groups, steps)
        at = [group.evaluator.at(trial) for group in groups]
        r_there = [group.evaluator.residual(each) for group, each in zip(groups, at, strict=True)]
        error_there, reached = measured(groups, r_there)
        progress, before = square - reached, square
        accepted = (expected > 0.0) & (progress > LEAST_SHARE * expected)
        if np.count_nonzero(accepted) == len(on):
            q, r, error, square, stale = trial, r_there, error_there, reached, None
            damping, more[:] = next_damping(damping, progress / expected), MORE_DAMPING
            continue
        rows = accepted[:, None]
        q = np.where(rows, trial, q)
        error, square = np.where(accepted, error_there, error), np.where(accepted, reached, square)
        r = [np.where(rows, there, here) for there, here in zip(r_there, r, strict=True)]
        gain = np.divide(progress, expected, out=np.zeros(len(on)), where=accepted)
        damping = np.where(accepted, next_damping(damping, gain), damping * more)
        more = np.where(accepted, MORE_DAMPING, 2.0 * more)  # doubles with each step that follows
        stale = accepted
    assert ended is not None
    return ended


def measured(groups: Sequence[Group], r: Sequence[Matrix]) -> tuple[Vector, Vector]:
    """The squares (B,) of the norms of all residuals, as they are and dimensionless."""
    both = _sum([(each * each) @ group.weights for group, each in zip(groups, r, strict=True)])
    return both[:, 0], both[:, 1]


def _predicted(A: Sequence[Matrix], steps: Sequence[Matrix], b: Sequence[Matrix]) -> Vector:
    """Σ |A δ + b|² (B,)."""
    parts = zip(A, steps, b, strict=True)
    return _sum([squares((own @ step[:, :, None])[:, :, 0] + rows) for own, step, rows in parts])


def _sum(parts: Sequence[Vector]) -> Vector:
    return parts[0] if len(parts) == 1 else np.add.reduce(parts)


def _steps(
    groups: Sequence[Group],
    A: Sequence[Matrix],
    b: Sequence[Matrix],
    q: Matrix,
    damping: Vector,
    limits: PositionLimits | None,
) -> list[Matrix]:
    """The next steps (B, n) of each group, of at most 1 rad or characteristic length, within the limits."""
    steps = _damped(A, b, damping)
    rooms: list[tuple[Matrix, Matrix]] = []
    if limits is not None:
        for group in groups:
            down, up = limits.room(q, group.loops.velocities)
            rooms.append((down / group.unit, up / group.unit))
        _stay_within(A, b, damping, steps, rooms)
    largest = np.abs(steps[0]).max(axis=1, initial=1.0)
    for step in steps[1:]:
        np.maximum(largest, np.abs(step).max(axis=1, initial=0.0), out=largest)
    steps = [step / largest[:, None] for step in steps]
    if limits is not None:
        steps = [np.minimum(np.maximum(step, down), up) for step, (down, up) in zip(steps, rooms, strict=True)]
    return steps


def _damped(A: Sequence[Matrix], b: Sequence[Matrix], damping: Vector) -> list[Matrix]:
    """The δ (B, n) that minimise Σ |A δ + b|² + λ |δ|², from the smaller of A Aᵀ and Aᵀ A of each group."""
    transposed = [each.swapaxes(1, 2) for each in A]
    wide = [each.shape[1] < each.shape[2] for each in A]
    grams = [own @ back if is_wide else back @ own for own, back, is_wide in zip(A, transposed, wide, strict=True)]
    trace = _sum([diagonals(gram).sum(axis=1) for gram in grams])
    # Invertible even with redundant rows.
    damping = np.maximum(np.maximum(damping, 1e-13 * trace), 1e-300)[:, None]
    steps: list[Matrix] = []
    for back, gram, rows, is_wide in zip(transposed, grams, b, wide, strict=True):
        diagonals(gram)[:] += damping
        column = rows[:, :, None]
        step = back @ solutions(gram, -column) if is_wide else solutions(gram, back @ -column)
        steps.append(np.asarray(step[:, :, 0]))
    return steps


def _stay_within(
    A: Sequence[Matrix],
    b: Sequence[Matrix],
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
            again |= blocked.any(axis=1)
        which = np.flatnonzero(again)
        if not len(which):
            return
        moving = [np.where(own[which][:, None], 0.0, each[which]) for each, own in zip(A, held, strict=True)]
        changed = _damped(moving, [each[which] for each in b], damping[which])
        for step, new, own in zip(steps, changed, held, strict=True):
            step[which] = np.where(own[which], 0.0, new)
