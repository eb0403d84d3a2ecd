"""Motions along a path in steps: how long they are, and how joints follow others that move along it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.closing import close
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import Numbers, as_numbers, at_least, choose, column, every, largest, numbers, some, square
from eurdf.kinematics.tolerances import (
    FASTEST,
    LEAST_CORRECTION,
    LONGEST_MOTION,
    MOST_CORRECTION,
    SHORTEST_STEP,
)

#: Some elements: their indices, or all of them.
Elements = Indices | slice

#: Takes a step of some elements: which, the fractions (b,) of their paths that are done, and the steps (b,) to take, in
#: the same unit. Returns the steps that were tried, at most as long, and whether each was accepted. A step of zero that
#: was not accepted ends the path. Of a single element they are floats and a bool.
Advance = Callable[[Elements, Numbers, Numbers], tuple[Numbers, Numbers]]


def follow(advance: Advance, count: int = 1, *, shortest: float = SHORTEST_STEP, first: float = 1.0) -> Vector:
    """Take steps along paths: a step that is not accepted is halved; after one that is, the next is twice as long.

    Args:
        advance: Takes a step of some elements.
        count: Number of elements.
        shortest: A path ends where a step below this fraction of it would have to be tried.
        first: The step to try first.

    Returns:
        What fraction (count,) of each path is done: 1, or less if it ended early.
    """
    done, part, step = np.empty(count), numbers(count, 0.0), numbers(count, first)
    on: Elements = slice(None)
    while True:
        left = 1.0 - part  # of the elements that go on
        h = choose(step < left, step, left)
        tried, accepted = advance(on, part, h)
        part = part + accepted * tried
        step = choose(accepted, 2.0, 0.5) * tried
        done[on] = part
        going = choose(accepted, part < 1.0, step >= shortest)
        if not some(going):
            return done
        if not every(going):
            on = np.arange(count)[on][going]
            part, step = part[going], step[going]


@np.errstate(all="ignore")  # joints stop where numbers overflow
def follow_given(
    problem: Problem,
    first: Matrix,
    goal: Matrix,
    coordinates: Indices,
    tolerance: float,
    shortest: float = SHORTEST_STEP,
    *,
    free: Problem | None = None,
) -> tuple[Matrix, Vector, Mask]:
    """Move given joints along straight paths, in steps that are short enough to stay on the branch.

    Args:
        problem: The robot whose velocities of these joints are given.
        first: Closed configurations (B, nq) to start from.
        goal: The configurations (B, nq) with the coordinates to move to.
        coordinates: Indices in q of the given coordinates.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        shortest: Smallest step, as a part of the path.
        free: The robot with no velocity given. Without it, the joints stop where the loops may block them.

    Returns:
        Where the joints get (B, nq), what part (B,) of their paths that is, and where (B,) they stopped so, or numbers
        overflow.
    """
    tree, scale = problem.tree, problem.spaces.scale
    path = tree.difference(first, goal)  # zero except for the given joints
    driven, ends = path[:, problem.given], goal[:, coordinates]
    q, stopped = np.array(first), np.zeros(len(first), dtype=bool)
    distant = np.abs(path / scale) > LONGEST_MOTION / SHORTEST_STEP  # even in the shortest steps
    is_distant = np.count_nonzero(distant) > 0
    if is_distant:
        outside = np.zeros(tree.nv, dtype=bool)  # where a joint moves nothing else, however far it goes
        outside[problem.spaces.outside] = True
        turns = np.abs(path / scale) > 2.0 * math.pi / SHORTEST_STEP  # and more than one in the shortest step
        driven[(turns & ~outside).any(axis=1)] = np.nan
        distant &= outside

    def advance(on: Elements, done: Numbers, h: Numbers) -> tuple[Numbers, Numbers]:
        here = q[on]
        v = _followed(problem, here, driven[on], free)
        motion = v / scale
        fastest = largest(np.where(distant[on], 0.0, motion) if is_distant else motion)
        while some(far := (fastest * h > LONGEST_MOTION) & (h > shortest)):
            h = choose(far, 0.5 * h, h)
        to, at = done + h, ends[on]
        if some(to < 1.0):
            between = tree.integrate(first[on], column(to) * path[on])
            at = np.where(column(to < 1.0), between[:, coordinates], at)
        expected = tree.integrate(here, column(h) * v)
        expected[:, coordinates] = at
        closed = close(problem, expected, tolerance)
        accepted = as_numbers(closed.closes) & is_short(problem, expected, closed.q, h * h * square(motion))
        if every(accepted):
            q[on] = closed.q
            return h, accepted
        q[on] = np.where(column(accepted), closed.q, here)
        lost = fastest != fastest  # NaN
        stopped[on] = lost & np.isfinite(driven[on]).all(axis=1)
        return choose(lost, 0.0, h), accepted

    return q, follow(advance, len(first), shortest=shortest), stopped


def is_short(problem: Problem, expected: Matrix, closed: Matrix, squared: Numbers) -> Numbers:
    """Whether steps were short enough to stay on the branch: closing the loops after them moved the joints little.

    Args:
        problem: The robot.
        expected: Where the steps led (B, nq).
        closed: The configurations (B, nq) after the loops were closed.
        squared: Squared norms (B,) of the steps, dimensionless.
    """
    corrected = square(problem.tree.difference(expected, closed) / problem.spaces.scale)
    return corrected <= at_least(MOST_CORRECTION**2 * squared, LEAST_CORRECTION**2)


def _followed(problem: Problem, q: Matrix, driven: Matrix, free: Problem | None) -> Matrix:
    """The velocities (B, nv) with given ones (B, k); NaN where loops may block these, or K is not finite."""
    v, certain = problem.velocity(q, driven)
    if np.count_nonzero(certain) < len(q):
        doubtful = np.flatnonzero(~certain)
        v[doubtful] = np.nan if free is None else nearest_velocity(free, problem.given, q[doubtful], driven[doubtful])
    return v


def nearest_velocity(free: Problem, given: Indices, q: Matrix, driven: Matrix) -> Matrix:
    """The velocities (B, nv) of a robot whose given ones are nearest to these (B, k), where loops may block them.

    They are v = Z (Z_g)⁺ v_g with K Z = 0; NaN where K is not finite.
    """
    K, v = free.jacobian(q), np.zeros((len(q), free.tree.nv))
    for space in free.spaces.each(K):
        Z = space.basis
        y = np.linalg.pinv(Z[:, given], rcond=1.0 / FASTEST) @ driven[space.which, :, None]
        v[space.which] = (Z @ y)[:, :, 0]
    v[~np.isfinite(K).all(axis=(1, 2))] = np.nan
    return v
