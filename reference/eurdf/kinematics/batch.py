"""Kinematics of many elements at once; the public names are those of `eurdf.batch`.

Each function does for arrays of elements, which come first in arguments and results, what the function of the same name
in `eurdf` does for one. The solvers are the same: they are written for B elements, and one is B = 1. Where values are
given by name, those of a joint are an array with its B elements first, or those of one element, which hold for all.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeVar, get_args

import numpy as np
import numpy.typing as npt
from pinocchio import LOCAL

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.errors import NumericalOverflow
from eurdf.kinematics.applied_force import AppliedForce
from eurdf.kinematics.blocks import Progress, blocks, checked_configurations, checked_rows, shape_of, starts
from eurdf.kinematics.closing import close
from eurdf.kinematics.derivatives import DerivativesTask, DynamicsDerivatives, derivatives_at
from eurdf.kinematics.evaluate import Evaluator, evaluator, frames
from eurdf.kinematics.forward import driving_many, given_many, goals, in_equilibrium, moved_many
from eurdf.kinematics.frame_jacobian import checked_reference
from eurdf.kinematics.frame_targets import Target
from eurdf.kinematics.inverse import checked_targets
from eurdf.kinematics.inverse_newton import newton_for_many
from eurdf.kinematics.inverse_search import InverseKinematicsReason, InverseTask, search
from eurdf.kinematics.metric import metric
from eurdf.kinematics.named import Named, NamedRows, configurations_of, velocity_of
from eurdf.kinematics.position_limit import chosen_limits
from eurdf.kinematics.problem import Problem, for_many
from eurdf.kinematics.project import ProjectionTask, nearest_closed
from eurdf.kinematics.residual import residual as residual_of_one
from eurdf.kinematics.sensitivity import JacobianTask, actuated_jacobians
from eurdf.kinematics.tolerances import RESTARTS, SOLVED
from eurdf.pinocchio.arguments import are_by_name, checked_array, checked_count, checked_tolerance
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Why forward kinematics did not converge: no closed configuration was found near the start; the loops do not close at
#: the given coordinates, as far as steps from where the joints stopped show; or they close there, but not on a straight
#: path from the start.
ForwardKinematicsReason = Literal["start open", "not closed", "blocked"]

#: Why a projection did not converge: no closed configuration was found near the given one.
ProjectionReason = Literal["not closed"]

# By the code of an element.
_FORWARD_REASONS: tuple[ForwardKinematicsReason | None, ...] = (None, *get_args(ForwardKinematicsReason))
_INVERSE_REASONS: tuple[InverseKinematicsReason | None, ...] = (None, *get_args(InverseKinematicsReason))

_Reason = TypeVar("_Reason")


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Solutions(Generic[_Reason]):
    """What a solver found for B elements.

    Attributes:
        q: Configurations (B, nq).
        converged: Whether the element is a solution (B,).
        residual: Euclidean norms (B,) of the residual at q, m and rad.
        reason: For each element why it did not converge; None if it did.
    """

    q: Matrix
    converged: Mask
    residual: Vector
    reason: tuple[_Reason | None, ...]

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {int(self.converged.sum())} of {len(self.q)} converged>"


class ForwardKinematics(Solutions[ForwardKinematicsReason]):
    """The result of `forward_kinematics`: every loop is closed and the given joints are at the given coordinates.

    Where an element did not converge, q is the least open one found at the given coordinates, or near the start.
    """

    __slots__ = ()


class Projection(Solutions[ProjectionReason]):
    """The result of `project_configuration`: the nearest closed configurations, or the least open ones found."""

    __slots__ = ()


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class InverseKinematics(Solutions[InverseKinematicsReason]):
    """The result of `inverse_kinematics`: every frame is at its target, and every loop closed, within the tolerances.

    The reasons are those of `eurdf.results.InverseKinematics`.

    Attributes:
        q: The configurations (B, nq) nearest to the targets: closed and within the limits, if such were found.
        starts: For each element how often the search started again from another configuration (B,).
        same_branch: Whether each is on the branch of its start for certain (B,).
        position_error: Distances (B, F) of the origins of the frames from those of the targets, m, in their order.
        angle_error: Angles (B, F) between their axes and those of the targets, rad; 0 for targets that are positions.
    """

    starts: Indices
    same_branch: Mask
    position_error: Matrix
    angle_error: Matrix


def forward_kinematics(
    robot: Robot,
    values: NamedRows,
    q0: Named | NamedRows | None = None,
    *,
    tolerance: float = SOLVED,
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
        values: The actuated coordinates (B, nu), in each row as `eurdf.split_configuration` returns them; or those of
            any joints by name, as in files.
        q0: Where to start: one configuration (nq,) for all, or one for each element (B, nq). The default is the
            `assembled` configuration, or the neutral one if there is none. To stay on a branch far from the start, give
            the result for near values.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        block: Number of elements that are worked on together. By default as many as take some 16 MB, at most 2,000; for
            several threads half of these, a third or a quarter.
        threads: Number of threads that work on blocks.
        executor: Any `concurrent.futures.Executor` that works on blocks instead: a process pool, or that of a cluster.
        progress: Called after each block with the number of elements done and the number of all.

    Returns:
        The configurations. Elements that did not converge do not raise; they state the reason.

    Raises:
        ValueError: An argument has a wrong shape or is not finite.
    """
    given = given_many(robot, values)
    values = given.values
    q, common = starts(robot, q0, len(values))
    driving = driving_many(robot, given, checked_tolerance(tolerance))
    goal = goals(driving, q, values)
    work = blocks(driving.driven.numbers, block, threads, executor, progress)
    closed = None
    if common and len(q):
        first = close(driving.free, q[:1], driving.tolerance, RESTARTS)
        q, closed = np.broadcast_to(first.q, q.shape), np.broadcast_to(first.closes, len(q))
        goal = goals(driving, q, values)
    found, residual, code, rests = work.map(moved_many, driving, (q, goal) if closed is None else (q, goal, closed))
    if len(robot.tree.springs):
        with working_memory(robot, Problem, tuple(given.velocities.tolist())) as driven:
            alone = driving._replace(driven=driven)
            for each in np.flatnonzero((code == 0) & ~rests).tolist():
                found[each] = in_equilibrium(robot, found[each], alone)
                residual[each] = np.linalg.norm(residual_of_one(robot, found[each]))
    return ForwardKinematics(found, code == 0, residual, tuple(_FORWARD_REASONS[each] for each in code.tolist()))


def residual(
    robot: Robot,
    q: NamedRows,
    *,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Matrix:
    """Residual of all constraints at B configurations, as `eurdf.residual` has it.

    Args:
        robot: The robot.
        q: Configurations (B, nq).
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        r (B, nc), m and rad.

    Raises:
        ValueError: An argument has a wrong shape or is not finite.
        NumericalOverflow: A configuration is so large that its residual is not finite; the message names it.
    """
    rows = checked_rows("q", configurations_of(robot, q), robot.tree.nq)
    constraints = robot.cached(_constraints)
    work = blocks(constraints.numbers_of_residual, block, threads, executor, progress)
    (r,) = work.map(_residual, constraints, (rows,))
    _require_finite(r)
    return r


def residual_and_jacobian(
    robot: Robot,
    q: NamedRows,
    *,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> tuple[Matrix, Matrix]:
    """Residual of all constraints and its derivative at B configurations, as `eurdf.residual_and_jacobian` has them.

    Args:
        robot: The robot.
        q: Configurations (B, nq).
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        r (B, nc), and K (B, nc, nv), in m and rad over the units of v.

    Raises:
        ValueError: As in `residual`.
        NumericalOverflow: As in `residual`, also of the derivative.
    """
    rows = checked_rows("q", configurations_of(robot, q), robot.tree.nq)
    constraints = robot.cached(_constraints)
    work = blocks(constraints.numbers, block, threads, executor, progress)
    r, K = work.map(_residual_and_jacobian, constraints, (rows,))
    _require_finite(r, K)
    return r, K


def constraint_acceleration(
    robot: Robot,
    q: NamedRows,
    v: Named | Matrix,
    *,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Matrix:
    """The k of K a = k at B configurations and velocities, as `eurdf.kinematics.constraint_acceleration` has it.

    Args:
        robot: The robot.
        q: Configurations (B, nq).
        v: Velocities (B, nv), rad/s and m/s, or one (nv,) for all.
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        k (B, nc), m/s² and rad/s².

    Raises:
        ValueError: As in `residual`, also for ``v``.
        NumericalOverflow: As in `residual`, of k.
    """
    tree, constraints = robot.tree, robot.cached(_constraints)
    rows = checked_rows("q", configurations_of(robot, q), tree.nq)
    v = velocity_of(robot, v) if are_by_name(v) else checked_array("v", v, (len(rows), tree.nv), (tree.nv,))
    velocities = np.broadcast_to(v, (len(rows), tree.nv))
    work = blocks(constraints.numbers, block, threads, executor, progress)
    (k,) = work.map(_acceleration, constraints, (rows, velocities))
    _require_finite(k)
    return k


def _acceleration(constraints: Evaluator, q: Matrix, v: Matrix) -> tuple[Matrix]:
    return (-constraints.drift(q, v),)


def _constraints(robot: Robot) -> Evaluator:
    return evaluator(robot, few=False)


def _residual(constraints: Evaluator, q: Matrix) -> tuple[Matrix]:
    return (constraints.residual(constraints.at(q)),)


def _residual_and_jacobian(constraints: Evaluator, q: Matrix) -> tuple[Matrix, Matrix]:
    at = constraints.at(q)
    return constraints.residual(at), constraints.jacobian(at)


def _require_finite(*results: Matrix) -> None:
    wrong = np.any([~np.isfinite(result).all(axis=tuple(range(1, result.ndim))) for result in results], axis=0)
    if wrong.any():
        raise NumericalOverflow(f"the result at q[{int(wrong.argmax())}]")


def project_configuration(
    robot: Robot,
    q: NamedRows,
    *,
    weights: Named | Matrix | None = None,
    tolerance: float = SOLVED,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Projection:
    """The closed configurations nearest to q, as `eurdf.project_configuration` finds them; B elements.

    Args:
        robot: The robot.
        q: Any configurations (B, nq).
        weights: The metric W: a matrix (nv, nv), or its diagonal (nv,). The default is the identity: the sum of squares
            of all motions, in rad and m.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        The configurations. Elements that did not converge do not raise; they state the reason.

    Raises:
        ValueError: An argument has a wrong shape or is not finite, or ``weights`` is not a metric.
    """
    model = for_many(robot)
    task = ProjectionTask(model, metric(robot, weights), checked_tolerance(tolerance))
    rows = checked_configurations(robot, "q", q)
    numbers = model.numbers + model.tree.nv**2
    found, residual, closed = blocks(numbers, block, threads, executor, progress).map(_projected, task, (rows,))
    return Projection(found, closed, residual, tuple(None if each else "not closed" for each in closed.tolist()))


def _projected(task: ProjectionTask, q: Matrix) -> tuple[Matrix, Vector, Mask]:
    found, closed = nearest_closed(task, q)
    return found, np.linalg.norm(task.problem.residual(found), axis=1), closed


#: Why there is no Jacobian: the closures do not let the actuators move independently; or numbers overflow.
ActuatedJacobianReason = Literal["dependent actuators", "overflow"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ActuatedJacobian:
    """The result of `actuated_jacobian`; B elements.

    Attributes:
        jacobian: (B, 6, nu): linear (m/s), then angular (rad/s), over the units of the actuated velocities; NaN where
            it does not exist.
        converged: Whether it exists (B,).
        reason: For each element why it does not exist; None if it does.
    """

    jacobian: Matrix
    converged: Mask
    reason: tuple[ActuatedJacobianReason | None, ...]

    def __repr__(self) -> str:
        return f"<ActuatedJacobian: {int(self.converged.sum())} of {len(self.jacobian)} exist>"


def actuated_jacobian(
    robot: Robot,
    frame: str,
    q: NamedRows,
    *,
    reference: Any = LOCAL,
    weights: Named | Matrix | None = None,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ActuatedJacobian:
    """Jacobians of a frame by the actuated velocities, as `eurdf.actuated_jacobian` has them; B elements.

    Args:
        robot: The robot.
        frame: Name of a link, a joint (its frame on the child's side), or a frame of the description.
        q: Closed configurations (B, nq).
        reference: Where the twist is expressed: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.
        weights: The metric in which motions that the actuators do not control are minimal: a matrix (nv, nv), or its
            diagonal (nv,); the identity by default, in rad/s and m/s.
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        The Jacobians. Where the actuators depend on each other there is none, and the element states it.

    Raises:
        ValueError: The frame is unknown or ambiguous, or an argument has a wrong shape or value.
    """
    model = for_many(robot)
    W = None if weights is None else metric(robot, weights)
    driven = for_many(robot, robot.actuation.idx_v.tolist())
    task = JacobianTask(model, driven, frames(robot, [frame], few=False), checked_reference(reference), W)
    rows = checked_configurations(robot, "q", q)
    work = blocks(2 * model.numbers + 40 * model.tree.nv, block, threads, executor, progress)
    jacobian, dependent = work.map(actuated_jacobians, task, (rows,))
    finite = np.isfinite(jacobian).all(axis=(1, 2))
    jacobian[dependent | ~finite] = np.nan
    reason: list[ActuatedJacobianReason | None] = [
        "dependent actuators" if depends else None if exists else "overflow"
        for depends, exists in zip(dependent.tolist(), finite.tolist(), strict=True)
    ]
    return ActuatedJacobian(jacobian, finite & ~dependent, tuple(reason))


def dynamics_derivatives(
    robot: Robot,
    q: NamedRows,
    v: Matrix,
    u: Matrix | None = None,
    *,
    tau: Matrix | None = None,
    gains: tuple[float, float] | None = None,
    dissipation: bool = False,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> DynamicsDerivatives:
    """Derivatives of forward dynamics, as `eurdf.dynamics_derivatives` has them; B elements.

    Args:
        robot: The robot.
        q: Configurations (B, nq).
        v: Velocities (B, nv).
        u: Motor torques (B, nu), N·m and N; zero by default.
        tau: Additional generalized forces (B, nv), N·m and N.
        gains: As in `eurdf.forward_dynamics`.
        dissipation: As in `eurdf.forward_dynamics`.
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        The arrays of `eurdf.dynamics_derivatives`, with the elements first.

    Raises:
        ValueError: An argument has a wrong shape or is not finite; or, in an element, redundant rows of K contradict
            each other.
        UndeterminedMotion: In an element a joint without inertia can move.
        NumericalOverflow: A result is not finite.
    """
    rows, nv, nu = checked_configurations(robot, "q", q), robot.tree.nv, len(robot.actuation.idx_v)
    given = {"v": (v, nv), "u": (u, nu), "tau": (tau, nv)}
    each = [
        checked_rows(name, np.zeros((len(rows), width)) if values is None else values, width)
        for name, (values, width) in given.items()
    ]
    for name, values in zip(given, each, strict=True):
        if len(values) != len(rows):
            raise ValueError(f"{name} has {len(values)} rows; expected {len(rows)}, one for each row of q")
    applied = AppliedForce(robot, None, dissipation)
    forces = np.array([applied.total(*state) for state in zip(rows, *each, strict=True)]).reshape(len(rows), nv)
    nc, task = robot.mechanism.nc, DerivativesTask(robot, gains, dissipation)
    numbers = 6 * (nv + nc) ** 2 + 40 * (nv + nc) + 14 * nv * len(robot.constraints)
    work = blocks(numbers, block, threads, executor, progress)
    return DynamicsDerivatives(*work.map(derivatives_at, task, (rows, each[0], forces)))


def inverse_kinematics(
    robot: Robot,
    targets: Mapping[str, Any],
    q0: Named | NamedRows | None = None,
    *,
    limits: bool = True,
    tolerance: float = 1e-8,
    restarts: int = 20,
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
    """
    model, names = for_many(robot), list(targets)
    places = frames(robot, names, few=False)
    goals = [checked_targets(name, target) for name, target in targets.items()]
    count = len(goals[0].position) if goals else len(q0) if q0 is not None and len(shape_of(q0)) == 2 else 1
    for name, goal in zip(names, goals, strict=True):
        if len(goal.position) != count:
            raise ValueError(f"targets['{name}'] has {len(goal.position)} elements; the first frame has {count}")
    q, _ = starts(robot, q0, count)
    poses = tuple(goal.rotation is not None for goal in goals)
    chosen, restarts = chosen_limits(robot, limits), checked_count("restarts", restarts, 0)
    task = InverseTask(
        model, places, newton_for_many(robot, poses, names), poses, chosen, checked_tolerance(tolerance), restarts
    )
    arrays = [part for goal in goals for part in (goal.position, goal.rotation) if part is not None]
    numbers = 2 * model.numbers + 40 * len(goals) * model.tree.nv
    found = blocks(numbers, block, threads, executor, progress).map(_searched, task, (q, *arrays))
    at, position, angle, residual, code, starts_tried, same_branch = found
    reason = tuple(_INVERSE_REASONS[each] for each in code.tolist())
    return InverseKinematics(at, code == 0, residual, reason, starts_tried, same_branch, position, angle)


def _searched(task: InverseTask, q: Matrix, *arrays: Matrix) -> tuple[npt.NDArray[Any], ...]:
    parts = iter(arrays)
    goals = [Target(next(parts), next(parts) if is_pose else None) for is_pose in task.poses]
    found = search(task, goals, q)
    code = np.array([_INVERSE_REASONS.index(reason) for reason in found.reason], dtype=np.intp)
    residual = np.linalg.norm(task.problem.residual(found.q), axis=1)
    return found.q, found.position, found.angle, residual, code, found.starts, found.same_branch
