"""Jacobians of frames by the actuated velocities, at many configurations."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from pinocchio import LOCAL, LOCAL_WORLD_ALIGNED, WORLD

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.batch import linear, rigid
from eurdf.kinematics.batch.arguments import checked_configurations
from eurdf.kinematics.batch.blocks import Progress, blocks
from eurdf.kinematics.batch.frames import BatchFrames
from eurdf.kinematics.batch.problem import Group, Problem, held_groups, problem
from eurdf.kinematics.batch.tangent import SURE, tangents
from eurdf.kinematics.metric import metric
from eurdf.kinematics.rank import numerical_ranks

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_Reference = Literal["local", "world", "local world aligned"]
_REFERENCES: dict[Any, _Reference] = {LOCAL: "local", WORLD: "world", LOCAL_WORLD_ALIGNED: "local world aligned"}

#: Why there is no Jacobian: the closures do not let the actuators move independently; or numbers overflow.
ActuatedJacobianReason = Literal["dependent actuators", "overflow"]

_REASONS: tuple[ActuatedJacobianReason | None, ...] = (None, "dependent actuators", "overflow")


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
    q: Matrix,
    frame: str,
    reference: Any = LOCAL,
    weights: Vector | Matrix | None = None,
    *,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ActuatedJacobian:
    """Jacobians of a frame by the actuated velocities, as `eurdf.actuated_jacobian` has them; B elements.

    Args:
        robot: The robot.
        q: Closed configurations (B, nq).
        frame: Name of a link, a joint (its frame on the child's side), or a frame of the description.
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
        NotImplementedError: A joint or constraint has a type that is not supported.
    """
    model, velocities = problem(robot), robot.actuation.idx_v
    if reference not in _REFERENCES:
        raise ValueError(f"reference is {reference!r}; expected pin.LOCAL, pin.WORLD or pin.LOCAL_WORLD_ALIGNED")
    W = metric(weights, model.tree.nv)
    task = _Task(
        model,
        held_groups(robot, velocities.tolist()),
        velocities,
        BatchFrames(robot, model.tree, [frame]),
        _REFERENCES[reference],
        None if weights is None else W,
    )
    rows = checked_configurations(robot, "q", q)
    work = blocks(model.whole.numbers + 20 * model.tree.nv, block, threads, executor, progress)
    jacobian, code = work.map(_jacobians, task, (rows,))
    return ActuatedJacobian(jacobian, code == 0, tuple(_REASONS[each] for each in code.tolist()))


@dataclass(frozen=True, eq=False)
class _Task:
    """What is the same for all elements.

    Attributes:
        problem: The robot.
        groups: Its loops, with the actuated joints held.
        velocities: Indices (nu,) of the actuated velocities in v.
        frames: The frame.
        reference: Where the twist is expressed.
        W: The metric (nv, nv); None for the identity.
    """

    problem: Problem
    groups: tuple[Group, ...]
    velocities: Indices
    frames: BatchFrames
    reference: _Reference
    W: Matrix | None


def _jacobians(task: _Task, rows: Matrix) -> tuple[Matrix, Indices]:
    q, B = rows.T, len(rows)
    D, dependent = _derivatives(task, q)
    place = task.frames.place(q)
    (J,), ((R, p),) = task.frames.jacobians(q, place), task.frames.poses(place, B)
    by_actuators = np.einsum("inb,nub->iub", J, D)
    origin, angular = by_actuators[:3], by_actuators[3:]
    if task.reference == "local":
        origin, angular = (np.einsum("ijb,iub->jub", R, part) for part in (origin, angular))
    elif task.reference == "world":
        origin = origin + rigid.cross(np.broadcast_to(p[:, None], angular.shape), angular)
    jacobian = np.moveaxis(np.concatenate((origin, angular)), -1, 0)
    finite = np.isfinite(jacobian).all(axis=(1, 2))
    jacobian[dependent | ~finite] = np.nan
    return jacobian, np.where(dependent, 1, np.where(finite, 0, 2))


def _derivatives(task: _Task, q: Matrix) -> tuple[Matrix, Mask]:
    """D (nv, nu, B) of `eurdf.dq_dq_actuated`, and where the actuators depend on each other (B,)."""
    model, velocities, B = task.problem, task.velocities, q.shape[1]
    K = model.whole.jacobian(model.whole.at(q))
    D = np.zeros((model.tree.nv, len(velocities), B))
    D[velocities, range(len(velocities))] = 1.0
    doubtful, dependent = np.full(B, task.W is not None), np.zeros(B, dtype=bool)
    if task.W is None:
        for group in task.groups:
            weights = group.row_scale[:, None, None]
            A = K[np.ix_(group.rows, group.stack.velocities)] * weights
            x, pivot = linear.solve(linear.gram(A), -weights * K[np.ix_(group.rows, velocities)])
            D[group.stack.velocities] = np.einsum("inb,iub->nub", A, x)
            doubtful |= ~(pivot > SURE)
    which = np.flatnonzero(doubtful & np.isfinite(K).all(axis=(0, 1)))
    if len(which):
        for space in tangents(model, K[:, :, which]):
            own = which[space.which]
            Z = space.basis
            free, _ = np.linalg.qr(Z / model.scale[:, None])
            values = np.linalg.svd(free[:, velocities], compute_uv=False)
            dependent[own] = numerical_ranks(values, np.ones(len(own))) < len(velocities)
            W = np.eye(model.tree.nv) if task.W is None else task.W
            Z = Z @ np.linalg.inv(np.swapaxes(np.linalg.cholesky(np.swapaxes(Z, 1, 2) @ W @ Z), 1, 2))
            D[:, :, own] = np.moveaxis(Z @ np.linalg.pinv(Z[:, velocities]), 0, -1)
    return D, dependent
