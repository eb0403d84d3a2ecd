"""The search for configurations at which frames are at their targets, within the joint limits.

With K̃ and Ẽ the derivatives of the residual and of the errors in units of the velocities, and P the projection onto
ker K̃, a damped step is v = -P Ẽᵀ (Ẽ P Ẽᵀ + λ 1)⁻¹ e: small systems, of the size of the errors. Where a step would
exceed a limit, the bounded step of that element is computed by itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.bounded_step import bounded_step, damped_step_within
from eurdf.kinematics.closing import Closed, close
from eurdf.kinematics.descend import next_damping
from eurdf.kinematics.frame_targets import FrameTargets, Target
from eurdf.kinematics.inverse_newton import InverseNewton
from eurdf.kinematics.path import Elements, follow, is_short
from eurdf.kinematics.position_limit import JointAtLimit, PositionLimits
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import (
    Numbers,
    as_numbers,
    at_least,
    certain_inverse,
    choose,
    column,
    damped_step,
    every,
    largest,
    norms,
    numbers,
    product,
    some,
    square,
    squares,
    taken,
    times,
)
from eurdf.kinematics.tolerances import (
    FIRST_DAMPING,
    IDLE,
    LEAST_GAIN,
    LEAST_SHARE,
    LONGEST_MOTION,
    MORE_DAMPING,
    MOST_IDLE_STEPS,
    MOST_STEPS,
    NOTHING,
    RESTARTS,
    SOLVED,
)
from eurdf.mechanism.joint import LIMIT_TOLERANCE

#: Why inverse kinematics did not converge: closures stay open; joints at their limits keep the frames from coming
#: nearer; the frames are as near as rounding and the loops, closed to 1e-10, allow; no motion brings them nearer, from
#: there or from where other descents ended; or the maximum number of steps was reached. None of them shows that no
#: configuration has the frames at their targets.
InverseKinematicsReason = Literal["closures open", "joint limits", "tolerance", "local minimum", "steps"]

# As `IDLE`, in the last descent.
_IDLE_AT_LAST = 1e-8
# Distance of the restarts from the start (rad, or characteristic lengths); the last one is repeated.
_SPREADS = (0.2, 0.5, 1.0, 2.0)
# Smallest step on the way to a restart, as a part of it.
_SHORTEST_STEP = 2.0**-5
# The gradient of the squared error counts as zero below this fraction of |A| |e|.
_FLAT = 0.02


class InverseTask(NamedTuple):
    """What is the same for all elements.

    Attributes:
        problem: The robot.
        frames: Evaluates the F frames that have targets.
        newton: Finds configurations that are near.
        poses: Of each frame whether its targets are poses.
        limits: The position limits to respect, or None.
        tolerance: Bound of the distance of a frame from its target, m and rad.
        restarts: Maximum number of restarts: the first quarter on the branch of the start, the others around it.
    """

    problem: Problem
    frames: Any
    newton: InverseNewton
    poses: tuple[bool, ...]
    limits: PositionLimits | None
    tolerance: float
    restarts: int


class SearchResult(NamedTuple):
    """The result of `search`; B elements.

    Attributes:
        q: The configurations (B, nq) nearest to the targets.
        position: Distances (B, F) of the origins of the frames from those of the targets, m.
        angle: Angles (B, F) between their axes and those of the targets, rad; 0 for targets that are positions.
        iterations: Numbers (B,) of steps tried.
        starts: Numbers (B,) of descents from other configurations.
        same_branch: Whether (B,) each step to q was short enough to stay on the branch of the start.
        reason: For each element why it did not converge; None if it did.
        at_limits: For each element the joints that are at their limits and would have to exceed them to come nearer.
        openings: How far each constraint is open (B, c) each, m and rad, if that is known.
    """

    q: Matrix
    position: Matrix
    angle: Matrix
    iterations: Indices
    starts: Indices
    same_branch: Mask
    reason: list[InverseKinematicsReason | None]
    at_limits: list[tuple[JointAtLimit, ...]]
    openings: tuple[Matrix, Matrix] | None = None


@np.errstate(all="ignore")
def search(task: InverseTask, goals: Sequence[Target], q: Matrix) -> SearchResult:
    """The configurations nearest to the targets, from q (B, nq)."""
    B, near = len(q), task.newton.near(task.problem, goals, q, task.limits, task.tolerance)
    reason: list[InverseKinematicsReason | None] = [None] * B
    at_limits: list[tuple[JointAtLimit, ...]] = [()] * B
    starts, same_branch = np.zeros(B, dtype=np.intp), np.ones(B, dtype=bool)
    arrays = near.q, near.position, near.angle, near.steps, starts, same_branch
    count = np.count_nonzero(near.reached)
    if count == B:
        return SearchResult(*arrays, reason, at_limits, near.openings)
    rest = np.flatnonzero(~near.reached)
    found = _Search(task, [goal.among(rest) for goal in goals] if count else goals, len(rest)).run(q[rest])
    found.iterations[:] += near.steps[rest]
    for whole, own in zip(arrays, found[:6], strict=True):
        whole[rest] = own
    for index, element in enumerate(rest.tolist()):
        reason[element], at_limits[element] = found.reason[index], found.at_limits[index]
    return SearchResult(*arrays, reason, at_limits)


class _Search:
    """The descents of B elements."""

    def __init__(self, task: InverseTask, goals: Sequence[Target], count: int) -> None:
        self._task, self._problem, self._spaces = task, task.problem, task.problem.spaces
        self._targets = FrameTargets(goals, self._spaces.length, task.tolerance, count)
        self._iterations, self._starts = np.zeros((2, count), dtype=np.intp)
        self._same_branch, self._exhausted = np.ones(count, dtype=bool), np.zeros(count, dtype=bool)
        self._may_be_certain = not task.problem.stacks  # of many groups of loops, each is decomposed by itself

    def run(self, start: Matrix) -> SearchResult:
        """The configurations found from start (B, nq)."""
        task, B = self._task, len(start)
        reason: list[InverseKinematicsReason | None] = [None] * B
        at_limits: list[tuple[JointAtLimit, ...]] = [()] * B
        clipped, best = self._clipped(start), np.array(start)
        errors, _ = self._error(start, np.arange(B))
        done = np.logical_and.reduce(clipped == start, axis=1) & self._targets.reached(errors)
        if np.count_nonzero(done):
            done[done] = self._problem.closes(start[done])
            if np.count_nonzero(done) == B:
                return self._result(best, errors, reason, at_limits)
        going = np.flatnonzero(~done)
        first = self._close(clipped[going], RESTARTS)
        best[going] = first.q
        is_open = going[~first.closes]
        if len(is_open):
            errors[is_open], _ = self._error(best[is_open], is_open)
        for element in is_open.tolist():
            reason[element] = "closures open"
        place, going = first.q[first.closes], going[first.closes]
        best[going], errors[going], self._same_branch[going] = self._descend(place, going, IDLE)
        far = going[~self._targets.reached(errors[going], self._targets.nearly)]
        random = np.random.default_rng(0) if len(far) else None  # making it takes as long as a step
        on_branch = (task.restarts + 3) // 4  # so many restarts stay on it
        for attempt in range(task.restarts):
            if random is None or not len(far):
                break
            stays = attempt < on_branch
            spread = _SPREADS[min(attempt if stays else attempt - on_branch, len(_SPREADS) - 1)]
            away = self._spaces.scale * random.uniform(-spread, spread, self._problem.tree.nv)
            own, begin = far, place[np.searchsorted(going, far)]
            if stays:
                begin = self._wandered(begin, np.tile(away, (len(far), 1)), spread)
            else:
                again = self._close(self._moved(begin, np.tile(away, (len(far), 1))))
                own, begin = far[again.closes], again.q[again.closes]
            end, e, stayed = self._descend(begin, own, IDLE)
            self._starts[own] += 1
            better = squares(e) < squares(errors[own])
            changed = own[better]
            best[changed], errors[changed] = end[better], e[better]
            self._same_branch[changed] = stayed[better] & stays
            far = far[~self._targets.reached(errors[far], self._targets.nearly)]
        off = going[~self._targets.reached(errors[going])]
        if len(off):
            best[off], errors[off], stayed = self._descend(best[off], off, _IDLE_AT_LAST)
            self._same_branch[off] &= stayed
            for element in off[~self._targets.reached(errors[off])].tolist():
                reason[element], at_limits[element] = self._why_off_target(best[[element]], element)
        return self._result(best, errors, reason, at_limits)

    def _result(
        self,
        q: Matrix,
        errors: Matrix,
        reason: list[InverseKinematicsReason | None],
        at_limits: list[tuple[JointAtLimit, ...]],
    ) -> SearchResult:
        position, angle = self._targets.distances(errors)
        return SearchResult(q, position, angle, self._iterations, self._starts, self._same_branch, reason, at_limits)

    def _wandered(self, q: Matrix, away: Matrix, spread: float) -> Matrix:
        """Where paths along the closed configurations lead (b, nq), as far as their steps surely stay on the branch.

        Args:
            q: Closed configurations (b, nq) to start from.
            away: Velocities (b, nv); the paths follow the nearest ones that keep the loops closed.
            spread: How far the joint that moves most is to move, dimensionless.
        """
        q, scale = np.array(q), self._spaces.scale
        away *= column(spread / at_least(largest(self._kept_closed(q, away) / scale), NOTHING))

        def advance(on: Elements, done: Numbers, h: Numbers) -> tuple[Numbers, Numbers]:
            here = q[on]
            v = self._kept_closed(here, away[on])
            motion = v / scale
            fastest = largest(motion)
            h = choose(fastest * h > LONGEST_MOTION, LONGEST_MOTION / at_least(fastest, NOTHING), h)
            there = self._moved(here, column(h) * v)
            closed = self._close(there)
            accepted = as_numbers(closed.closes) & is_short(self._problem, there, closed.q, h * h * square(motion))
            q[on] = np.where(column(accepted), closed.q, here)
            return h, accepted

        follow(advance, len(q), shortest=_SHORTEST_STEP)
        return q

    def _kept_closed(self, q: Matrix, v: Matrix) -> Matrix:
        """The velocities (b, nv) nearest to the given ones, dimensionless, that keep the loops closed."""
        if not len(self._spaces.row_scale):
            return v
        scale, nearest = self._spaces.scale, np.empty(v.shape)
        for space in self._spaces.each(self._problem.jacobian(q)):
            Z = space.free / scale[:, None]
            nearest[space.which] = scale * times(Z, times(Z.swapaxes(1, 2), v[space.which] / scale))
        return nearest

    def _close(self, q: Matrix, restarts: int = 0) -> Closed:
        return close(self._problem, q, SOLVED, restarts, self._task.limits)

    def _descend(self, q: Matrix, which: Indices, idle_below: float) -> tuple[Matrix, Matrix, Mask]:
        """Where descents of some elements from closed configurations (b, nq) end, and the errors (b, k) there.

        And whether (b,) each of their steps was short enough to stay on the branch.

        Args:
            q: Where to start (b, nq).
            which: The elements (b,).
            idle_below: A step that reduces the squared error by less than this fraction is idle.
        """
        e, at = self._error(q, which)
        end, errors, stayed = np.array(q), np.array(e), np.ones(len(q), dtype=bool)
        on, cost = np.arange(len(q)), square(e)
        damping, idle = numbers(len(q), FIRST_DAMPING), numbers(len(q), 0)
        E: Matrix | None = None
        for step in range(MOST_STEPS + 1):
            going = as_numbers(~self._targets.reached(e)) & (idle <= MOST_IDLE_STEPS)
            if step == MOST_STEPS or not (len(on) and every(going)):
                end[on], errors[on] = q, e
                self._exhausted[which[on]] = step == MOST_STEPS and going
                if step == MOST_STEPS or not some(going):
                    break
                on, q, e, cost, damping, idle = on[going], q[going], e[going], cost[going], damping[going], idle[going]
                E, at = None if E is None else E[going], None
            if E is None:
                E = self._jacobian(self._task.frames.at(q) if at is None else at, e)
            v, there = self._steps(q, e, E, damping * cost)
            expected = cost - square(e + times(E, v))
            worth = expected > LEAST_GAIN * cost
            if not every(worth):
                end[on], errors[on] = q, e
                self._exhausted[which[on]] = False
                if not some(worth):
                    break
                on, q, e, cost, damping, idle = on[worth], q[worth], e[worth], cost[worth], damping[worth], idle[worth]
                E, v, there, expected = E[worth], v[worth], there[worth], expected[worth]
            self._iterations[which[on]] += 1
            closed = self._close(there)
            e_there, at = self._error(closed.q, which[on])
            closes, reached = as_numbers(closed.closes), square(e_there)
            gain = choose(closes, (cost - reached) / expected, 0.0)
            idle = choose(closes & (reached < (1.0 - idle_below) * cost), 0, idle + 1)
            accepted = gain > LEAST_SHARE
            short = is_short(self._problem, there, closed.q, square(v / self._spaces.scale))
            stayed[on] &= choose(accepted, short, True)
            damping = choose(accepted, next_damping(damping, gain), MORE_DAMPING * damping)
            if every(accepted):
                q, e, cost, E = closed.q, e_there, reached, None
                continue
            at = None
            if some(accepted):
                q, e = np.where(accepted[:, None], closed.q, q), np.where(accepted[:, None], e_there, e)
                cost = np.where(accepted, reached, cost)
                E[accepted] = self._jacobian(self._task.frames.at(q[accepted]), e[accepted])
        return end, errors, stayed

    def _steps(self, q: Matrix, e: Matrix, E: Matrix, damping: Numbers) -> tuple[Matrix, Matrix]:
        """The v (b, nv) with K v = 0 that minimise |E v + e|² + λ|v|² within the limits; at most 1 rad or length.

        And the configurations (b, nq) that they lead to.
        """
        K, scale, limits = self._problem.jacobian(q), self._spaces.scale, self._task.limits
        steps, parts = np.empty((len(q), len(scale))), []
        for which, A, Z in self._free_motions(K, E):
            by = at_least(taken(damping, which), 1e-13 * square(A) + 1e-300)
            y = damped_step(A, e[which], by)
            steps[which] = y if Z is None else times(Z, y)
            parts.append((which, A, Z, by, y))
        longest = largest(steps)
        v = scale * (steps / column(at_least(longest, 1.0)))
        there = self._problem.tree.integrate(q, v)
        if limits is None or (every(longest <= 1.0) and not limits.are_exceeded(there)):
            return v, there
        down, up = limits.room(q)
        moved = scale * steps
        over = np.any(((moved > up) & (up <= scale)) | ((moved < down) & (-down <= scale)), axis=1)
        for which, A, Z, by, y in parts:
            by = np.broadcast_to(by, len(A))
            for index, at in enumerate(np.arange(len(q))[which].tolist()):
                if not over[at]:
                    continue
                if Z is None:
                    basis = self._spaces.at(K[at]).free / scale[:, None]
                    bounds = self._bounds(q[at], basis)
                    steps[at] = basis @ damped_step_within((E[at] * scale) @ basis, e[at], float(by[index]), *bounds)
                else:
                    bounds = self._bounds(q[at], Z[index])
                    steps[at] = Z[index] @ damped_step_within(A[index], e[at], float(by[index]), *bounds, y[index])
        v = scale * (steps / column(at_least(largest(steps), 1.0)))
        return v, self._moved(q, v)

    def _free_motions(self, K: Matrix, E: Matrix) -> Iterator[tuple[slice | Indices, Matrix, Matrix | None]]:
        """Some elements, the derivatives A of their errors by free motions, and these Z (b, nv, f), dimensionless.

        Where the rows of K are independent for certain, Z is None and A = Ẽ P with P = 1 - K̃ᵀ (K̃ K̃ᵀ)⁻¹ K̃; else A is
        Ẽ Z.
        """
        spaces, B = self._spaces, E * self._spaces.scale
        if not K.shape[1]:
            yield slice(None), B, None
            return
        which: slice | Indices = slice(None)
        if self._may_be_certain:  # else the rows of K depend on each other at every configuration
            A = K * spaces.dimensionless
            across = A.swapaxes(1, 2)
            inverse, sure = certain_inverse(product(A, across), norms(A))
            sure = as_numbers(sure)
            self._may_be_certain = some(sure)
            if self._may_be_certain:
                projected = B
                for _ in range(2):  # the second time what rounding left
                    projected = projected - product(product(product(projected, across), inverse), A)
                if every(sure):
                    yield which, projected, None
                    return
                yield np.flatnonzero(sure), projected[sure], None
                which = np.flatnonzero(~sure)
        for space in spaces.each(K[which]):
            own = space.which if isinstance(which, slice) else which[space.which]
            Z = space.free / spaces.scale[:, None]
            yield (own if len(own) < len(K) else slice(None)), B[own] @ Z, Z

    def _bounds(self, q: Vector, Z: Matrix) -> tuple[Matrix, Vector]:
        """G and h such that the dimensionless step Z y respects the limits within its reach if G y ≤ h."""
        if self._task.limits is None:
            return np.empty((0, Z.shape[1])), np.empty(0)
        down, up = self._task.limits.room(q)
        scale = self._spaces.scale
        moves = np.linalg.norm(Z, axis=1) > 1e-9
        above, below = moves & (up <= scale), moves & (-down <= scale)
        return np.vstack([Z[above], -Z[below]]), np.concatenate([(up / scale)[above], (-down / scale)[below]])

    def _why_off_target(self, q: Matrix, element: int) -> tuple[InverseKinematicsReason, tuple[JointAtLimit, ...]]:
        """Why no descent of one element continues from a closed configuration (1, nq) at which frames are off."""
        limits, (errors, at) = self._task.limits, self._error(q, np.array([element]))
        if self._targets.reached(errors, self._targets.nearly)[0]:
            return "tolerance", ()
        Z = self._spaces.at(self._problem.jacobian(q)[0]).free
        A, e = self._jacobian(at, errors)[0] @ Z, errors[0]
        slope = A.T @ e
        flat = _FLAT * np.linalg.norm(A, 2) * np.linalg.norm(e) if A.size else np.inf
        at_limits = () if limits is None else limits.pressed(q[0], -Z @ slope)
        if at_limits and np.linalg.norm(slope) > flat:
            G, h = self._bounds(q[0], Z / self._spaces.scale[:, None])
            at_bounds = h <= LIMIT_TOLERANCE
            down = bounded_step(np.eye(len(slope)), slope, G[at_bounds], np.zeros(int(at_bounds.sum())))
            if np.linalg.norm(down) <= flat:
                return "joint limits", at_limits
        return ("steps" if self._exhausted[element] else "local minimum"), ()

    def _moved(self, q: Matrix, v: Matrix) -> Matrix:
        return self._clipped(self._problem.tree.integrate(q, v))

    def _clipped(self, q: Matrix) -> Matrix:
        return q if self._task.limits is None else self._task.limits.clip(q)

    def _error(self, q: Matrix, which: Indices) -> tuple[Matrix, Any]:
        """The errors (b, k) of some elements, and the frames there."""
        at = self._task.frames.at(q)
        return self._targets.errors(at, which), at

    def _jacobian(self, at: Any, e: Matrix) -> Matrix:
        """Their derivatives (b, k, nv) by v."""
        return self._targets.jacobian(self._task.frames, at, e)
