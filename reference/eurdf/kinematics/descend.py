"""Levenberg-Marquardt steps towards the closed configurations.

A step δ solves (AᵀA + λ1) δ = -Aᵀb, with b the residual and A its derivative, in units of the characteristic length.
Since λ is proportional to |b|², steps are small far from a solution, and convergence near it is quadratic, even with
redundant rows. Each element has its own damping and its own end; elements that have ended are left out of the arrays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.position_limit import PositionLimits
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import (
    Numbers,
    at_least,
    choose,
    column,
    diagonals,
    every,
    largest,
    numbers,
    product,
    solutions,
    some,
    square,
    times,
    total,
)
from eurdf.kinematics.stack import Stack
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

# With a λ of this fraction of the trace, and this much, A Aᵀ is invertible even with redundant rows.
_LEAST_OF_TRACE, _LEAST = 1e-13, 1e-300


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


def next_damping(damping: Numbers, gain: Numbers) -> Numbers:
    """The damping after accepted steps that reduced the square by so much of what was expected."""
    return at_least(damping * choose(gain > GOOD_SHARE, 0.1, choose(gain > POOR_SHARE, 1.0, 4.0)), LEAST_DAMPING)


def descend(
    problem: Problem | Stack,
    groups: Sequence[Any],
    q: Matrix,
    tolerance: float,
    limits: PositionLimits | None = None,
    most: Indices | None = None,
) -> Descended:
    """Steps of groups that go together, with one damping.

    Args:
        problem: The robot, or a stack of its groups.
        groups: The groups, each a `Group`; of a stack its `StackElements`, which are the elements.
        q: Where to start (B, nq).
        tolerance: A descent ends where the norm of the residual is at most this, m and rad.
        limits: The position limits to respect, or None.
        most: Bound (B,) of the steps of each element, if it is less than `MOST_STEPS`.
    """
    B, enough = len(q), tolerance * tolerance
    on, ended = np.arange(B), None
    at, r, b, error, squared = evaluated(groups, q)
    if not some(error > enough):
        return _ended(q, r, error, squared, 0)
    before = expected = squared
    A: list[Matrix] = []
    damping, more, idle = numbers(B, FIRST_DAMPING), numbers(B, MORE_DAMPING), numbers(B, 0)
    stale: Numbers | None = None  # whose A is not that at q; None for all of them, with the states `at`
    for step in range(MOST_STEPS + 1):
        going, cut = error > enough, None
        if step and some(going):
            idle = choose(squared < (1.0 - IDLE) * before, 0, idle + 1)
            going = going & (idle <= MOST_IDLE_STEPS) & (expected > LEAST_GAIN * squared)
        if most is not None:
            cut = going & (most[on] <= step)
            going = going & ~cut
        goes_on = step < MOST_STEPS and some(going)
        if not (goes_on and every(going)):
            here = _ended(q, r, error, squared, step, cut)
            if not goes_on and ended is None:
                return here  # all at once
            ended = here.copy() if ended is None else ended
            ended.keep(here, ~going if goes_on else np.ones(len(on), dtype=bool), on)
            if not goes_on:
                break
            on, q, r, A, b = on[going], q[going], *([each[going] for each in of] for of in (r, A, b))
            error, squared, damping, more, idle = error[going], squared[going], damping[going], more[going], idle[going]
            groups = [group.among(going) for group in groups]
            if stale is None:
                at = [group.at(q) for group in groups]
            else:
                stale = stale[going]
        if stale is None:
            A = []
            for group, each in zip(groups, at, strict=True):
                A.append(group.jacobian(each))
        elif some(stale):
            for group, own in zip(groups, A, strict=True):
                own[stale] = group.among(stale).jacobian_at(q[stale])
        steps, trial = _steps(problem, groups, A, b, q, damping * squared, limits)
        expected, before = squared - _predicted(A, steps, b), squared
        at, r_there, b_there, error_there, reached = evaluated(groups, trial)
        progress = squared - reached
        accepted = (expected > 0.0) & (progress > LEAST_SHARE * expected)
        if every(accepted):
            q, r, b, error, squared, stale = trial, r_there, b_there, error_there, reached, None
            damping, more = next_damping(damping, progress / expected), numbers(len(on), MORE_DAMPING)
            continue
        stale = accepted
        if some(accepted):
            rows = accepted[:, None]
            q = np.where(rows, trial, q)
            error, squared = np.where(accepted, error_there, error), np.where(accepted, reached, squared)
            r = [np.where(rows, there, here) for there, here in zip(r_there, r, strict=True)]
            b = [np.where(rows, there, here) for there, here in zip(b_there, b, strict=True)]
        gain = choose(accepted, progress, 0.0) / choose(accepted, expected, 1.0)
        damping = choose(accepted, next_damping(damping, gain), damping * more)
        more = choose(accepted, MORE_DAMPING, 2.0 * more)  # doubles with each step that follows
    assert ended is not None
    return ended


def evaluated(groups: Sequence[Any], q: Matrix) -> tuple[list[Any], list[Matrix], list[Matrix], Numbers, Numbers]:
    """Of each group its state and its residual, as it is and dimensionless; the squares of the norms of all of both."""
    states, residuals, scaled, error, squared = [], [], [], 0.0, 0.0
    for group in groups:
        at = group.at(q)
        r = group.residual_of(at)
        b = group.row_scale * r
        states.append(at)
        residuals.append(r)
        scaled.append(b)
        error, squared = error + square(r), squared + square(b)
    return states, residuals, scaled, error, squared


def _ended(
    q: Matrix, r: list[Matrix], error: Numbers, squared: Numbers, step: int, cut: Numbers | None = None
) -> Descended:
    B = len(q)
    cut = np.zeros(B, dtype=bool) if cut is None else np.array(cut, ndmin=1)
    return Descended(q, r, np.array(error, ndmin=1), np.array(squared, ndmin=1), np.array([step]).repeat(B), cut)


def _predicted(A: Sequence[Matrix], steps: Sequence[Matrix], b: Sequence[Matrix]) -> Numbers:
    """Σ |A δ + b|² of each element."""
    found: Numbers = 0.0
    for own, step, rows in zip(A, steps, b, strict=True):
        found = found + square(times(own, step) + rows)
    return found


def _steps(
    problem: Problem | Stack,
    groups: Sequence[Any],
    A: Sequence[Matrix],
    b: Sequence[Matrix],
    q: Matrix,
    damping: Numbers,
    limits: PositionLimits | None,
) -> tuple[list[Matrix], Matrix]:
    """The next steps (B, n) of each group, of at most 1 rad or characteristic length, within the limits.

    And the configurations (B, nq) that they lead to.
    """
    free = damped(A, b, damping)
    steps = _shortened(free)
    there = problem.moved(q, groups, steps)
    if limits is None or not problem.exceeds(there, groups, limits):
        return steps, there
    rooms = [group.room(q, limits) for group in groups]
    rooms = [(down / group.unit, up / group.unit) for (down, up), group in zip(rooms, groups, strict=True)]
    _stay_within(A, b, np.array(damping, ndmin=1), free, rooms)
    steps = [np.minimum(np.maximum(step, down), up) for step, (down, up) in zip(_shortened(free), rooms, strict=True)]
    return steps, problem.moved(q, groups, steps)


def _shortened(steps: list[Matrix]) -> list[Matrix]:
    """The same steps, shorter for the elements for which one is longer than 1."""
    longest: Numbers = 1.0
    for step in steps:
        if not every(square(step) <= 1.0):  # else it is not longer
            longest = at_least(longest, largest(step))
    return [step / column(longest) for step in steps] if some(longest > 1.0) else steps


def damped(A: Sequence[Matrix], b: Sequence[Matrix], damping: Numbers) -> list[Matrix]:
    """The δ (B, n) that minimise Σ |A δ + b|² + λ |δ|², from the smaller of A Aᵀ and Aᵀ A of each group."""
    if len(A) == len(b[0]) == 1:  # the same in fewer steps
        ((one,),), ((rows,),) = A, b
        back, is_wide = one.T, len(one) < one.shape[1]
        gram = one.dot(back) if is_wide else back.dot(one)
        diagonal = gram.ravel()[:: len(gram) + 1]
        diagonal += max(damping, _LEAST_OF_TRACE * sum(diagonal.tolist()) + _LEAST)
        step: Vector = back.dot(solutions(gram, -rows)) if is_wide else solutions(gram, -back.dot(rows))
        return [step[None]]
    grams = []
    trace: Numbers = 0.0
    for own in A:
        back, is_wide = own.swapaxes(1, 2), own.shape[1] < own.shape[2]
        gram = product(own, back) if is_wide else product(back, own)
        diagonal = diagonals(gram)
        grams.append((back, is_wide, gram, diagonal))
        trace = trace + total(diagonal)
    damping = column(at_least(damping, _LEAST_OF_TRACE * trace + _LEAST))
    steps: list[Matrix] = []
    for (back, is_wide, gram, diagonal), rows in zip(grams, b, strict=True):
        diagonal += damping
        steps.append(times(back, solutions(gram, -rows)) if is_wide else solutions(gram, -times(back, rows)))
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
        changed = damped(moving, [each[which] for each in b], damping[which])
        for step, new, own in zip(steps, changed, held, strict=True):
            step[which] = np.where(own[which], 0.0, new)
