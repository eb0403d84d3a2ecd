"""Inverse kinematics of frames for many targets at once, by the steps of `eurdf.inverse_kinematics`.

With K̃ and Ẽ the derivatives of the residual and of the errors in units of the velocities, and P the projection onto
ker K̃, a damped step is v = -P Ẽᵀ (Ẽ P Ẽᵀ + λ 1)⁻¹ e: small systems, of the size of the errors. Where a step would
exceed a limit, the bounded step of that element is computed by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from pinocchio import SE3

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.batch import linear, rigid
from eurdf.kinematics.batch.arguments import checked_rows, shape_of, starts
from eurdf.kinematics.batch.blocks import Progress, blocks
from eurdf.kinematics.batch.descent import clip, close, closes, room
from eurdf.kinematics.batch.frames import BatchFrames
from eurdf.kinematics.batch.problem import Problem, problem
from eurdf.kinematics.batch.tangent import SURE, tangents
from eurdf.kinematics.bounded_step import bounded_step
from eurdf.kinematics.inverse_kinematics import InverseKinematicsReason
from eurdf.kinematics.position_limit import PositionLimits, chosen_limits
from eurdf.kinematics.rank import numerical_ranks
from eurdf.mechanism.joint import LIMIT_TOLERANCE
from eurdf.pinocchio.arguments import checked_array, checked_count, checked_tolerance

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# As in `eurdf.kinematics.inverse_kinematics`, so that results are the same.
_MOST_STEPS = 60
_MOST_IDLE_STEPS = 6
_IDLE = 0.02
_IDLE_AT_LAST = 1e-8
_LEAST_GAIN = 1e-12
_SPREADS = (0.2, 0.5, 1.0, 2.0)
_FLAT = 0.02
_SINGULAR = 0.05
_CLOSED = 1e-10
_RESTARTS_TO_CLOSE = 20

# If the smallest pivot of Ẽ P Ẽᵀ + λ 1 is below this part of its largest diagonal entry, rounding would be amplified.
_SURE = 1e-9

_REASONS: tuple[InverseKinematicsReason | None, ...] = (
    None,
    "closures open",
    "joint limits",
    "singular",
    "out of reach",
    "steps",
)


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class InverseKinematics:
    """The result of `inverse_kinematics`; B elements, F frames.

    Attributes:
        q: The configurations (B, nq) nearest to the targets: closed and within the limits, if such were found.
        converged: Whether every frame is at its target, and every loop closed, within the tolerances (B,).
        position_error: Distances (B, F) of the origins of the frames from those of the targets, m, in their order.
        angle_error: Angles (B, F) between their axes and those of the targets, rad; 0 for targets that are positions.
        residual: Euclidean norms (B,) of the residual at q, m and rad.
        reason: For each element why it did not converge, as `eurdf.InverseKinematics` has it; None if it did.
    """

    q: Matrix
    converged: Mask
    position_error: Matrix
    angle_error: Matrix
    residual: Vector
    reason: tuple[InverseKinematicsReason | None, ...]

    def __repr__(self) -> str:
        return f"<InverseKinematics: {int(self.converged.sum())} of {len(self.q)} converged>"


def inverse_kinematics(
    robot: Robot,
    targets: Mapping[str, Any],
    q0: Matrix | None = None,
    limits: bool = True,
    *,
    tolerance: float = 1e-8,
    restarts: int = 10,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> InverseKinematics:
    """Move frames of the closed mechanism to targets, as `eurdf.inverse_kinematics` does; B elements.

    Args:
        robot: The robot.
        targets: For each frame, by name, its targets in the world: B positions (B, 3), m, or B poses, as `pin.SE3` or
            as homogeneous matrices (B, 4, 4).
        q0: Where to start: one configuration (nq,) for all, or one for each element (B, nq). The default is the
            `assembled` configuration, or the neutral one if there is none.
        limits: Whether to respect the position limits of joints.
        tolerance: Bound of the distance of a frame from its target, m and rad. Loops are closed to 1e-10 if possible.
        restarts: Maximum number of restarts of an element while frames are off target.
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        The configurations. Elements that did not converge do not raise; they state the reason.

    Raises:
        ValueError: A frame is unknown or ambiguous, the targets are no poses or positions, or an argument has a wrong
            shape or value.
        NotImplementedError: A joint or constraint has a type that is not supported.
    """
    model, names = problem(robot), list(targets)
    frames = BatchFrames(robot, model.tree, names)
    goals = [_checked_target(name, target) for name, target in targets.items()]
    count = len(goals[0].position) if goals else len(q0) if q0 is not None and len(shape_of(q0)) == 2 else 1
    for name, goal in zip(names, goals, strict=True):
        if len(goal.position) != count:
            raise ValueError(f"targets['{name}'] has {len(goal.position)} elements; the first frame has {count}")
    q, _ = starts(robot, q0, count)
    task = _Task(
        model,
        frames,
        tuple(goal.rotation is not None for goal in goals),
        chosen_limits(robot, limits),
        checked_tolerance(tolerance),
        checked_count("restarts", restarts, 0),
    )
    arrays = [part for goal in goals for part in (goal.position, goal.rotation) if part is not None]
    numbers = 2 * model.whole.numbers + 40 * len(goals) * model.tree.nv
    work = blocks(numbers, block, threads, executor, progress)
    found, position, angle, residual, code = work.map(_search, task, (q, *arrays))
    reason = tuple(_REASONS[each] for each in code.tolist())
    return InverseKinematics(found, code == 0, position, angle, residual, reason)


@dataclass(frozen=True, slots=True, eq=False)
class _Target:
    """Where frames should be.

    Attributes:
        position: (B, 3), m.
        rotation: (B, 3, 3); None for positions.
    """

    position: Matrix
    rotation: Matrix | None = None


def _checked_target(name: str, target: Any) -> _Target:
    """Targets, checked.

    Raises:
        ValueError: They are neither positions nor poses, or are not finite.
    """
    argument = f"targets['{name}']"
    if isinstance(target, Sequence) and len(target) and all(isinstance(each, SE3) for each in target):
        target = np.array([each.homogeneous for each in target])
    shape = shape_of(target)
    if len(shape) != 3 or shape[1:] != (4, 4):
        try:
            return _Target(checked_rows(argument, target, 3))
        except ValueError as error:
            raise ValueError(f"{error}, or poses: (B, 4, 4), or a list of pin.SE3") from None
    poses = checked_array(argument, target, shape)
    R = poses[:, :3, :3]
    wrong = np.abs(np.swapaxes(R, 1, 2) @ R - np.eye(3)).max(axis=(1, 2), initial=0.0) > 1e-6
    wrong |= (np.linalg.det(R) < 0.0) | (np.abs(poses[:, 3] - (0.0, 0.0, 0.0, 1.0)).max(axis=1, initial=0.0) > 1e-9)
    if wrong.any():
        raise ValueError(f"{argument}[{int(np.argmax(wrong))}] is not a pose: its rotation is not orthonormal")
    return _Target(poses[:, :3, 3], R)


@dataclass(frozen=True, eq=False)
class _Task:
    """What is the same for all elements.

    Attributes:
        problem: The robot.
        frames: The frames that have targets.
        poses: Of each frame whether its targets are poses.
        limits: The position limits to respect, or None.
        tolerance: Bound of the distance of a frame from its target, m and rad.
        restarts: Maximum number of restarts.
    """

    problem: Problem
    frames: BatchFrames
    poses: tuple[bool, ...]
    limits: PositionLimits | None
    tolerance: float
    restarts: int


def _search(task: _Task, rows: Matrix, *arrays: Matrix) -> tuple[Matrix, Matrix, Matrix, Vector, Indices]:
    parts, goals = iter(arrays), []
    for is_pose in task.poses:
        position = next(parts).T
        goals.append((position, np.moveaxis(next(parts), 0, -1) if is_pose else None))
    search = _Search(task, goals, rows.shape[0])
    q, code = search.run(rows.T)
    position, angle = search.errors(q, np.arange(q.shape[1]))
    residual = np.linalg.norm(task.problem.residual(q), axis=0)
    return q.T, position.T, angle.T, residual, code


class _Search:
    """The descents of a block of elements."""

    def __init__(self, task: _Task, goals: Sequence[tuple[Matrix, Matrix | None]], count: int) -> None:
        self._task, self._goals = task, goals
        self._problem = task.problem
        self._velocities = np.arange(task.problem.tree.nv)
        # Of Ẽ P, at the configuration farthest from singular that each element met.
        self._motions = np.full(count, task.problem.tree.nv)
        self._rank, self._smallest = np.zeros(count, dtype=np.intp), np.zeros(count)

    def run(self, start: Matrix) -> tuple[Matrix, Indices]:
        """The configurations found (nq, B), and the numbers (B,) of the reasons; 0 for those that converged."""
        model, task, B = self._problem, self._task, start.shape[1]
        everything = np.arange(B)
        code = np.zeros(B, dtype=np.intp)
        done = closes(model.groups, start, 0.0) & (self._clipped(start) == start).all(axis=0)
        done &= self._reached(start, everything)
        best, cost = np.array(start), np.full(B, np.inf)
        going = np.flatnonzero(~done)
        first, closed = close(
            model, model.groups, self._clipped(start[:, going]), _CLOSED, _RESTARTS_TO_CLOSE, task.limits
        )
        best[:, going] = first
        code[going[~closed]] = 1
        first, going = first[:, closed], going[closed]
        best[:, going], cost[going] = self._descend(first, going, _IDLE)
        random = np.random.default_rng(0)
        for attempt in range(task.restarts):
            off = np.flatnonzero(~self._reached(best[:, going], going))
            if not len(off):
                break
            spread = _SPREADS[min(attempt, len(_SPREADS) - 1)]
            away = model.scale * random.uniform(-spread, spread, model.tree.nv)
            place = self._moved(first[:, off], np.repeat(away[:, None], len(off), axis=1))
            place, shut = close(model, model.groups, place, _CLOSED, limits=task.limits)
            own = going[off[shut]]
            end, reached = self._descend(place[:, shut], own, _IDLE)
            better = reached < cost[own]
            best[:, own[better]], cost[own[better]] = end[:, better], reached[better]
        off = going[~self._reached(best[:, going], going)]
        best[:, off], _ = self._descend(best[:, off], off, _IDLE_AT_LAST)
        for element in off[~self._reached(best[:, off], off)].tolist():
            code[element] = _REASONS.index(self._why_off_target(best[:, [element]], element))
        return best, code

    def errors(self, q: Matrix, which: Indices) -> tuple[Matrix, Matrix]:
        """Distances and angles (F, b) of the frames from the targets of some elements, m and rad."""
        position, angle = np.zeros((2, len(self._goals), q.shape[1]))
        poses = self._task.frames.poses(self._task.frames.place(q), q.shape[1])
        for index, ((R, p), (target, rotation)) in enumerate(zip(poses, self._goals, strict=True)):
            position[index] = rigid.norm(p - target[:, which])
            if rotation is not None:
                turn = rigid.product(rigid.transposed(rotation[:, :, which]), R)
                angle[index] = rigid.norm(rigid.log3(turn))
        return position, angle

    def _reached(self, q: Matrix, which: Indices) -> Mask:
        position, angle = self.errors(q, which)
        return np.asarray((np.maximum(position, angle) <= self._task.tolerance).all(axis=0))

    def _descend(self, q: Matrix, which: Indices, least: float) -> tuple[Matrix, Vector]:
        """Where descents of some elements from closed configurations (nq, b) end, and the squared errors (b,) there.

        Args:
            q: Where to start (nq, b).
            which: The elements (b,).
            least: A step that reduces the squared error by less than this fraction is idle.
        """
        model, B = self._problem, q.shape[1]
        q = np.array(q)
        e, E = self._error_and_jacobian(q, which)
        A, sure = self._projected(q, E)
        self._look_at_rank(A, q, which, sure)
        cost, damping, idle = (e * e).sum(axis=0), np.full(B, 1e-3), np.zeros(B, dtype=np.intp)
        running = np.ones(B, dtype=bool)
        for _ in range(_MOST_STEPS):
            running &= (idle <= _MOST_IDLE_STEPS) & ~self._reached(q, which)
            on = np.flatnonzero(running)
            if not len(on):
                break
            v = self._steps(q[:, on], e[:, on], E[:, :, on], A[:, :, on], damping[on] * cost[on])
            error = e[:, on] + linear.times(E[:, :, on], v)
            expected = cost[on] - (error * error).sum(axis=0)
            worth = expected > _LEAST_GAIN * cost[on]
            running[on[~worth]] = False
            on, v, expected = on[worth], v[:, worth], expected[worth]
            if not len(on):
                break
            trial = self._moved(q[:, on], v)
            trial, shut = close(model, model.groups, trial, _CLOSED, limits=self._task.limits)
            e_trial, E_trial = self._error_and_jacobian(trial, which[on])
            reached = (e_trial * e_trial).sum(axis=0)
            gain = np.where(shut, (cost[on] - reached) / expected, 0.0)
            idle[on] = np.where(shut & (reached < (1.0 - least) * cost[on]), 0, idle[on] + 1)
            accepted = gain > 0.01
            there = on[accepted]
            damping[on[~accepted]] *= 8.0
            good = gain[accepted]
            factor = np.where(good > 0.75, 0.1, np.where(good > 0.25, 1.0, 4.0))
            damping[there] = np.maximum(damping[there] * factor, 1e-8)
            q[:, there], e[:, there], E[:, :, there] = trial[:, accepted], e_trial[:, accepted], E_trial[:, :, accepted]
            cost[there] = reached[accepted]
            A[:, :, there], _ = self._projected(q[:, there], E[:, :, there])
        return q, cost

    def _steps(self, q: Matrix, e: Matrix, E: Matrix, A: Matrix, damping: Vector) -> Matrix:
        """The v (nv, b) with K v = 0 that minimise |E v + e|² + λ|v|² within the limits; at most 1 rad or length."""
        scale = self._problem.scale[:, None]
        G = np.array(linear.gram(A))
        trace = np.einsum("iib->b", G)
        damping = np.maximum(np.maximum(damping, 1e-13 * trace), 1e-300)
        for index in range(len(G)):
            G[index, index] += damping
        y, pivot = linear.solve(G, e)
        for element in np.flatnonzero(~(pivot > _SURE)).tolist():  # errors that no motion changes
            y[:, element] = _within_range(G[:, :, element], e[:, element], float(damping[element]))
        v = -scale * linear.times_back(A, y)
        if self._task.limits is not None:
            down, up = room(self._task.limits, q, self._velocities)
            over = ((up <= scale) & (v > up)) | ((-down <= scale) & (v < down))
            for element in np.flatnonzero(over.any(axis=0)).tolist():
                Z = self._basis(q[:, [element]])
                of_Z = E[:, :, element] @ Z
                H = of_Z.T @ of_Z
                np.einsum("ii->i", H)[:] += damping[element]
                v[:, element] = Z @ bounded_step(H, of_Z.T @ e[:, element], *self._bounds(q[:, [element]], Z))
        return np.asarray(v / np.maximum(np.abs(v / scale).max(axis=0, initial=0.0), 1.0))

    def _projected(self, q: Matrix, E: Matrix) -> tuple[Matrix, Mask]:
        """Ẽ P (k, nv, b), and whether K has full rank beyond doubt (b,)."""
        model = self._problem
        A = np.array(E * model.scale[:, None])
        K = model.whole.jacobian(model.whole.at(q))
        sure = np.ones(q.shape[1], dtype=bool)
        for group in model.groups:
            velocities = group.stack.velocities
            own = K[np.ix_(group.rows, velocities)] * group.factors
            part = A[:, velocities]
            x, pivot = linear.solve(linear.gram(own), np.einsum("inb,knb->ikb", own, part))
            A[:, velocities] = part - np.einsum("inb,ikb->knb", own, x)
            sure &= pivot > SURE
        doubtful = np.flatnonzero(~sure)
        if len(doubtful):
            for space in tangents(model, K[:, :, doubtful]):
                which = doubtful[space.which]
                Q, _ = np.linalg.qr(space.basis / model.scale[:, None])
                scaled = np.moveaxis(E[:, :, which] * model.scale[:, None], -1, 0)
                A[:, :, which] = np.moveaxis(scaled @ Q @ np.swapaxes(Q, 1, 2), 0, -1)
        return A, sure

    def _basis(self, q: Matrix) -> Matrix:
        """Basis Z (nv, m) of the motions of one element (nq, 1), orthonormal in the units of the velocities."""
        model = self._problem
        (space,) = tangents(model, model.whole.jacobian(model.whole.at(q)))
        Q, _ = np.linalg.qr(space.basis[0] / model.scale[:, None])
        return np.asarray(model.scale[:, None] * Q)

    def _bounds(self, q: Matrix, Z: Matrix) -> tuple[Matrix, Vector]:
        """G and h of one element (nq, 1): v = Z y respects the limits within a step of 1 rad or length if G y ≤ h."""
        if self._task.limits is None:
            return np.empty((0, Z.shape[1])), np.empty(0)
        down, up = (each[:, 0] for each in room(self._task.limits, q, self._velocities))
        scale = self._problem.scale
        rows = Z / scale[:, None]
        moves = np.linalg.norm(rows, axis=1) > 1e-9
        above, below = moves & (up <= scale), moves & (-down <= scale)
        return np.vstack([rows[above], -rows[below]]), np.concatenate([(up / scale)[above], (-down / scale)[below]])

    def _look_at_rank(self, A: Matrix, q: Matrix, which: Indices, sure: Mask) -> None:
        """Keep the largest rank of Ẽ P that elements have met, and with it the largest of its smallest singular values.

        Only configurations with the fewest free motions count.
        """
        model, B = self._problem, q.shape[1]
        motions = np.full(B, model.tree.nv - model.whole.m)
        doubtful = np.flatnonzero(~sure)
        if len(doubtful):
            for space in tangents(model, model.whole.jacobian(model.whole.at(q[:, doubtful]))):
                motions[doubtful[space.which]] = space.basis.shape[2]
        values = _singular_values(A)
        rank = numerical_ranks(values)
        smallest = np.zeros(B)
        some = np.flatnonzero(rank > 0)
        smallest[some] = values[some, rank[some] - 1]
        fewer, same = motions < self._motions[which], motions == self._motions[which]
        higher, equal = rank > self._rank[which], rank == self._rank[which]
        farther = fewer | (same & (higher | (equal & (smallest > self._smallest[which]))))
        own = which[farther]
        self._motions[own], self._rank[own] = motions[farther], rank[farther]
        self._smallest[own] = smallest[farther]

    def _why_off_target(self, q: Matrix, element: int) -> InverseKinematicsReason:
        """Why no descent of one element continues from a closed configuration (nq, 1)."""
        which = np.array([element])
        e, E = self._error_and_jacobian(q, which)
        A, sure = self._projected(q, E)
        self._look_at_rank(A, q, which, sure)
        error, Z = e[:, 0], self._basis(q)
        slope, values = (E[:, :, 0] @ Z).T @ error, _singular_values(A)[0]
        size = max(values.max(initial=0.0), self._smallest[element]) * np.linalg.norm(error)
        rank = int(self._rank[element])
        if np.linalg.norm(slope) <= _FLAT * size:
            singular = rank > 0 and not values[rank - 1] > _SINGULAR * self._smallest[element]
            return "singular" if singular else "out of reach"
        if self._task.limits is not None and self._task.limits.pressed(q[:, 0], -Z @ slope):
            G, h = self._bounds(q, Z)
            at_bounds = h <= LIMIT_TOLERANCE
            down = bounded_step(np.eye(len(slope)), slope, G[at_bounds], np.zeros(int(at_bounds.sum())))
            if np.linalg.norm(down) <= _FLAT * size:
                return "joint limits"
        return "steps"

    def _error_and_jacobian(self, q: Matrix, which: Indices) -> tuple[Matrix, Matrix]:
        """Stacked errors (k, b) of all frames, in characteristic lengths and rad, and derivatives (k, nv, b) by v."""
        length, frames = self._problem.length, self._task.frames
        place = frames.place(q)
        errors, jacobians = [np.empty((0, q.shape[1]))], [np.empty((0, self._problem.tree.nv, q.shape[1]))]
        each = zip(frames.poses(place, q.shape[1]), frames.jacobians(q, place), self._goals, strict=True)
        for (R, p), J, (target, rotation) in each:
            errors.append((p - target[:, which]) / length)
            jacobians.append(J[:3] / length)
            if rotation is not None:
                turn = rigid.log3(rigid.product(rigid.transposed(rotation[:, :, which]), R))
                errors.append(turn)
                to_log = rigid.product(rigid.jacobian_log3(turn), rigid.transposed(R))
                jacobians.append(np.einsum("ijb,jnb->inb", to_log, J[3:]))
        return np.concatenate(errors), np.concatenate(jacobians)

    def _moved(self, q: Matrix, v: Matrix) -> Matrix:
        return self._clipped(self._problem.tree.integrate(q, v))

    def _clipped(self, q: Matrix) -> Matrix:
        limits = self._task.limits
        return q if limits is None else clip(limits, q, self._velocities)


def _within_range(G: Matrix, e: Vector, damping: float) -> Vector:
    """The solution of G y = e, without the part that belongs to eigenvalues of little but the damping, and rounding."""
    if not np.isfinite(G).all():
        return np.zeros(len(e))
    values, vectors = np.linalg.eigh(G)
    counts = values > damping + 1e-13 * values[-1]
    return np.asarray(vectors[:, counts] @ ((vectors[:, counts].T @ e) / values[counts]), dtype=np.float64)


def _singular_values(A: Matrix) -> Matrix:
    """Of (k, nv, B), descending (B, k)."""
    each = np.moveaxis(A, -1, 0)
    each = np.where(np.isfinite(each).all(axis=(1, 2), keepdims=True), each, 0.0)
    if not each.size:
        return np.empty((len(each), 0))
    return np.asarray(np.linalg.svd(each, compute_uv=False), dtype=np.float64)
