"""Closed-loop forward kinematics of many elements at once, by the steps of `eurdf.forward_kinematics`."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.assembly import Assembler
from eurdf.kinematics.batch import linear
from eurdf.kinematics.batch.arguments import checked_rows, starts
from eurdf.kinematics.batch.blocks import Progress, blocks
from eurdf.kinematics.batch.descent import close
from eurdf.kinematics.batch.problem import Group, Problem, driving_stack, held_groups, problem
from eurdf.kinematics.batch.stack import BatchStack
from eurdf.kinematics.batch.tangent import SURE, following
from eurdf.kinematics.derived import borrowed
from eurdf.kinematics.forward_kinematics import SHORTEST_STEP_AT_REST
from eurdf.kinematics.residual import residual as residual_of
from eurdf.kinematics.spring_equilibrium import joints_at_rest, spring_equilibrium
from eurdf.pinocchio.arguments import checked_tolerance

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# As in `eurdf.kinematics.forward_kinematics`, so that results are the same.
_MOST_CORRECTION = 0.25
_LEAST_CORRECTION = 1e-6
_SHORTEST_STEP = 2.0**-10
_LONGEST_MOTION = 0.5
_FASTEST = 1e6
_RESTARTS = 20

# Numbers of the arrays in which singular values are computed.
_MOST_NUMBERS = 2**22


@dataclass(frozen=True, eq=False)
class Driven:
    """A robot some joints of which are given.

    Attributes:
        problem: The robot.
        groups: Its loops, with the given joints held.
        driving: The constraints of each of these groups, by the given velocities that move their joints.
        coordinates: Indices in q of the given coordinates.
        velocities: Indices in v of the given velocities.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        rest: The last of the given coordinates, those of springs at rest; the same for all elements.
        shortest: Smallest step, as a part of the path.
    """

    problem: Problem
    groups: tuple[Group, ...]
    driving: tuple[BatchStack, ...]
    coordinates: Indices
    velocities: Indices
    tolerance: float
    rest: Vector
    shortest: float


#: Why forward kinematics did not converge: no closed configuration was found near the start; the loops do not close at
#: the given coordinates, as far as steps from where the joints stopped show; or they close there, but not on a straight
#: path from the start.
ForwardKinematicsReason = Literal["start open", "not closed", "blocked"]

_REASONS: tuple[ForwardKinematicsReason | None, ...] = (None, "start open", "not closed", "blocked")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ForwardKinematics:
    """The result of `forward_kinematics`; B elements.

    Attributes:
        q: Configurations (B, nq). Where an element did not converge, the least open one found at the given coordinates,
            or near the start.
        converged: Whether every loop is closed and the given joints are at the given coordinates (B,).
        residual: Euclidean norms (B,) of the residual at q, m and rad.
        reason: For each element why it did not converge; None if it did.
    """

    q: Matrix
    converged: Mask
    residual: Vector
    reason: tuple[ForwardKinematicsReason | None, ...]

    def __repr__(self) -> str:
        return f"<ForwardKinematics: {int(self.converged.sum())} of {len(self.q)} converged>"


def forward_kinematics(
    robot: Robot,
    values: Matrix,
    q0: Matrix | None = None,
    *,
    tolerance: float = 1e-10,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ForwardKinematics:
    """The closed configurations at which the actuated joints have the given coordinates; B elements.

    Each element equals the result of `eurdf.forward_kinematics` to 1e-9, on the branch of its start. It does not
    depend on the other elements or on how the batch is divided. If joints have springs that the loops do not let rest,
    each element is moved to their equilibrium afterwards, one after the other.

    Args:
        robot: The robot.
        values: The actuated coordinates (B, nu), in each row as `eurdf.split_configuration` returns them.
        q0: Where to start: one configuration (nq,) for all, or one for each element (B, nq). The default is the
            `assembled` configuration, or the neutral one if there is none. To stay on a branch far from the start, give
            the result for near values.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        block: Number of elements that are worked on together. By default as many as take some 32 MB, at most 1,000.
        threads: Number of threads that work on blocks.
        executor: Any `concurrent.futures.Executor` that works on blocks instead: a process pool, or that of a cluster.
        progress: Called after each block with the number of elements done and the number of all.

    Returns:
        The configurations. Elements that did not converge do not raise; they state the reason.

    Raises:
        ValueError: An argument has a wrong shape or is not finite.
        NotImplementedError: A joint or constraint has a type that is not supported.
    """
    actuation = robot.actuation
    values = checked_rows("values", values, len(actuation.idx_q))
    q, common = starts(robot, q0, len(values))
    driven = _driven(robot, actuation.idx_q, actuation.idx_v, checked_tolerance(tolerance))
    _refuse_zero(driven, values)
    at_rest = None
    if (resting := joints_at_rest(robot, actuation.idx_v)) is not None:
        coordinates = np.concatenate((actuation.idx_q, resting.coordinates))
        velocities = np.concatenate((actuation.idx_v, resting.velocities))
        at_rest = _driven(robot, coordinates, velocities, driven.tolerance, resting.values, SHORTEST_STEP_AT_REST)
    work = blocks(_numbers(driven), block, threads, executor, progress)
    closed = None
    if common:
        first, closed = _close_start(driven, q[:1])
        q, closed = np.broadcast_to(first, q.shape), np.broadcast_to(closed, len(q))
    batch = (values, q) if closed is None else (values, q, closed)
    found, residual, code, rests = work.map(_solved, (driven, at_rest), batch)
    if len(robot.tree.springs):
        _to_equilibrium(robot, driven, found, residual, np.flatnonzero((code == 0) & ~rests))
    return ForwardKinematics(found, code == 0, residual, tuple(_REASONS[each] for each in code.tolist()))


def _driven(
    robot: Robot,
    coordinates: Indices,
    velocities: Indices,
    tolerance: float,
    rest: Vector | None = None,
    shortest: float = _SHORTEST_STEP,
) -> Driven:
    """A robot whose joints at these indices in q and v are given."""
    held = held_groups(robot, velocities.tolist())
    driving = tuple(driving_stack(robot, group, velocities) for group in held)
    rest = np.empty(0) if rest is None else rest
    return Driven(problem(robot), held, driving, coordinates, velocities, tolerance, rest, shortest)


def _to_equilibrium(robot: Robot, driven: Driven, q: Matrix, residual: Vector, elements: Indices) -> None:
    """Move elements (B, nq) to where their springs are in equilibrium, and update the norms (B,) of their residuals."""
    with borrowed(robot, Assembler, robot.actuation.joints) as assembler:
        assembler.tolerance, assembler.limits = driven.tolerance, None
        for each in elements.tolist():
            q[each] = spring_equilibrium(robot, q[each], driven.velocities, driven.coordinates, assembler)
            residual[each] = np.linalg.norm(residual_of(robot, q[each]))


def _refuse_zero(driven: Driven, values: Matrix) -> None:
    """Refuse quaternions, and cosines and sines, of length zero."""
    q = np.zeros((driven.problem.tree.nq, len(values)))
    q[driven.coordinates] = values.T
    with np.errstate(all="ignore"):
        wrong = ~np.isfinite(driven.problem.tree.normalized(q)[driven.coordinates]).all(axis=0)
    if wrong.any():
        row = int(np.flatnonzero(wrong)[0])
        raise ValueError(f"values[{row}] has a quaternion, or a (cos, sin) pair, whose length is zero or overflows")


def _numbers(driven: Driven) -> int:
    model = driven.problem
    groups = [group.stack.numbers for group in model.groups]
    held = [group.stack.numbers + driving.numbers for group, driving in zip(driven.groups, driven.driving, strict=True)]
    together = sum if model.at_once else max  # else one group after the other
    return together([*groups, *held, 0]) + 20 * model.tree.nq


def _close_start(driven: Driven, q: Matrix) -> tuple[Matrix, Mask]:
    with np.errstate(all="ignore"):
        first, closed = close(driven.problem, driven.problem.groups, q.T, driven.tolerance, restarts=_RESTARTS)
    return first.T, closed


def _solved(
    robots: tuple[Driven, Driven | None], values: Matrix, q: Matrix, closed: Mask | None = None
) -> tuple[Matrix, Vector, Indices, Mask]:
    """What `solve` finds, and for which elements the springs are at rest; the norms (B,) of the residual."""
    driven, at_rest = robots
    if closed is None:
        q, closed = _close_start(driven, q)
    found, residual, code = np.array(q), np.zeros(len(q)), np.zeros(len(q), np.intp)
    rests = np.zeros(len(q), dtype=bool)
    if at_rest is not None:
        free = np.flatnonzero(closed)
        free = free[_is_sure(at_rest, q[free].T)]
        rest = np.broadcast_to(at_rest.rest, (len(free), len(at_rest.rest)))
        there, r, why = solve(at_rest, q[free].T, closed[free], np.hstack((values[free], rest)).T)
        resting = free[why == 0]
        found[resting], residual[resting] = there.T[why == 0], np.linalg.norm(r[:, why == 0], axis=0)
        rests[resting] = True
    others = np.flatnonzero(~rests)
    there, r, code[others] = solve(driven, q[others].T, closed[others], values[others].T)
    found[others], residual[others] = there.T, np.linalg.norm(r, axis=0)
    return found, residual, code, rests


def solve(driven: Driven, first: Matrix, closed: Mask, values: Matrix) -> tuple[Matrix, Matrix, Indices]:
    """Move the given joints of each element along the straight path to their values.

    Args:
        driven: The robot and its given joints.
        first: Where to start (nq, B).
        closed: Whether the loops are closed there (B,).
        values: The given coordinates (g, B).

    Returns:
        q (nq, B), the residual (nc, B) there, and the number (B,) of the reason; 0 if an element converged.
    """
    tree, tolerance = driven.problem.tree, driven.tolerance
    goal = np.array(first)
    goal[driven.coordinates] = values
    goal = tree.normalized(goal)
    path = tree.difference(first, goal)
    q, B = np.array(first), first.shape[1]
    done, step = np.zeros(B), np.ones(B)
    code = np.where(closed, 0, 1)  # index in _REASONS
    v = np.zeros((tree.nv, B))
    fresh = np.zeros(B, dtype=bool)  # whether v is that at q
    going = np.flatnonzero(closed)
    while len(going):
        new = going[~fresh[going]]
        v[:, new] = _following(driven, q[:, new], path[:, new])
        fresh[new] = True
        step[going] = np.minimum(step[going], 1.0 - done[going])
        fastest = np.abs(v[:, going] / driven.problem.scale[:, None]).max(axis=0, initial=0.0)
        while (far := (fastest * step[going] > _LONGEST_MOTION) & (step[going] > driven.shortest)).any():
            step[going[far]] *= 0.5
        h = step[going]
        motion = h * v[:, going]
        last = done[going] + h >= 1.0
        at = np.where(last, goal[:, going], tree.integrate(first[:, going], (done[going] + h) * path[:, going]))
        expected = tree.integrate(q[:, going], motion)
        expected[driven.coordinates] = at[driven.coordinates]
        reached, closed = close(driven.problem, driven.groups, expected, tolerance)
        corrected = _size(driven.problem, tree.difference(expected, reached))
        allowed = np.maximum(_MOST_CORRECTION * _size(driven.problem, motion), _LEAST_CORRECTION)
        accepted = closed & (corrected <= allowed)
        there, refused = going[accepted], going[~accepted]
        q[:, there] = reached[:, accepted]
        done[there] += h[accepted]
        step[there] *= 2.0
        fresh[there] = False
        step[refused] *= 0.5
        code[refused[step[refused] < driven.shortest]] = 2
        going = np.flatnonzero((code == 0) & (done < 1.0))
    stopped = np.flatnonzero(code == 2)
    if len(stopped):
        beyond = q[:, stopped]
        beyond[driven.coordinates] = goal[np.ix_(driven.coordinates, stopped)]
        q[:, stopped], closed = close(driven.problem, driven.groups, beyond, tolerance)
        code[stopped[closed]] = 3
    return q, driven.problem.residual(q), code


def _size(problem: Problem, v: Matrix) -> Vector:
    """Norms (B,) in rad and characteristic lengths."""
    return np.asarray(np.linalg.norm(v / problem.scale[:, None], axis=0))


def _following(driven: Driven, q: Matrix, path: Matrix) -> Matrix:
    """The least motions (nv, B) at which the given joints have the velocities of the path and the loops stay closed.

    With the other joints p, v_p = -K_pᵀ (K_p K_pᵀ)⁻¹ K_g v_g, if K_p has full rank beyond doubt.
    """
    v = np.zeros((driven.problem.tree.nv, q.shape[1]))
    v[driven.velocities] = path[driven.velocities]
    sure = _follow(driven, q, v)
    which = np.flatnonzero(~sure)
    part = max(1, _MOST_NUMBERS // driven.problem.whole.numbers)
    for own in (which[first : first + part] for first in range(0, len(which), part)):
        K = driven.problem.whole.jacobian(driven.problem.whole.at(q[:, own]))
        given = driven.velocities
        v[:, own] = following(driven.problem, K, given, path[np.ix_(given, own)], _FASTEST)
    return v


def _follow(driven: Driven, q: Matrix, v: Matrix) -> Mask:
    """Complete velocities (nv, B) by those that follow from the given ones; for which elements (B,) that is sure."""
    sure = np.ones(q.shape[1], dtype=bool)
    for group, driving in zip(driven.groups, driven.driving, strict=True):
        at, weights = group.stack.at(q), group.row_scale[:, None]
        A = group.stack.jacobian(at) * weights[:, :, None]
        b = linear.times(driving.jacobian(at), v[driving.velocities])
        y, pivot = linear.solve(linear.gram(A), -weights * b)
        v[group.stack.velocities] = linear.times_back(A, y)
        sure &= pivot > SURE
    return sure


def _is_sure(driven: Driven, q: Matrix) -> Mask:
    """Whether the loops leave the given joints free at q (nq, B), beyond doubt."""
    v = np.zeros((driven.problem.tree.nv, q.shape[1]))
    v[driven.velocities] = 1.0
    return _follow(driven, q, v)
