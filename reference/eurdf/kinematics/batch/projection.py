"""The nearest closed configurations to many given ones, by the steps of `eurdf.project_configuration`."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.kinematics.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.batch.arguments import checked_configurations
from eurdf.kinematics.batch.blocks import Progress, blocks
from eurdf.kinematics.batch.descent import close
from eurdf.kinematics.batch.problem import Problem, problem
from eurdf.kinematics.batch.tangent import Tangents, tangents
from eurdf.kinematics.metric import metric
from eurdf.pinocchio.arguments import checked_tolerance

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# As in `eurdf.kinematics.projection`, so that results are the same.
_MOST_STEPS = 50
_MOST_HALVINGS = 20
_DIFFERENCE = 1e-6
_RESTARTS = 20

#: Why a projection did not converge: no closed configuration was found near the given one.
ProjectionReason = Literal["not closed"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Projection:
    """The result of `project_configuration`; B elements.

    Attributes:
        q: The nearest closed configurations (B, nq); where none was found, the least open one.
        converged: Whether the loops are closed (B,).
        residual: Euclidean norms (B,) of the residual at q, m and rad.
        reason: For each element why it did not converge; None if it did.
    """

    q: Matrix
    converged: Mask
    residual: Vector
    reason: tuple[ProjectionReason | None, ...]

    def __repr__(self) -> str:
        return f"<Projection: {int(self.converged.sum())} of {len(self.q)} converged>"


def project_configuration(
    robot: Robot,
    q: Matrix,
    weights: Vector | Matrix | None = None,
    *,
    tolerance: float = 1e-10,
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
        NotImplementedError: A joint or constraint has a type that is not supported.
    """
    model = problem(robot)
    task = _Task(model, metric(weights, model.tree.nv), checked_tolerance(tolerance))
    rows = checked_configurations(robot, "q", q)
    numbers = 3 * model.whole.numbers + 2 * model.tree.nv**2
    found, residual, closed = blocks(numbers, block, threads, executor, progress).map(_project, task, (rows,))
    return Projection(found, closed, residual, tuple(None if each else "not closed" for each in closed.tolist()))


@dataclass(frozen=True, eq=False)
class _Task:
    """What is the same for all elements.

    Attributes:
        problem: The robot.
        W: The metric (nv, nv).
        tolerance: Bound of each row of the residual for closed loops, m or rad.
    """

    problem: Problem
    W: Matrix
    tolerance: float


def _project(task: _Task, rows: Matrix) -> tuple[Matrix, Vector, Mask]:
    model, q = task.problem, rows.T
    here, closed = np.array(q), np.ones(len(rows), dtype=bool)
    going = np.flatnonzero(~(np.abs(model.residual(q)).max(axis=0, initial=0.0) <= task.tolerance))
    here[:, going], closed[going] = close(model, model.groups, q[:, going], task.tolerance, _RESTARTS)
    going = going[closed[going]]
    cost = _distance(task, q, here)
    for _ in range(_MOST_STEPS):
        if not len(going):
            break
        v, gain = _step(task, q[:, going], here[:, going])
        far = gain > 1e-14 * cost[going]
        going, v, gain = going[far], v[:, far], gain[far]
        waiting, moved = np.arange(len(going)), np.zeros(len(going), dtype=bool)
        for halving in range(_MOST_HALVINGS):
            if not len(waiting):
                break
            part, own = 0.5**halving, going[waiting]
            trial = model.tree.integrate(here[:, own], part * v[:, waiting])
            trial, shut = close(model, model.groups, trial, task.tolerance)
            reached = _distance(task, q[:, own], trial)
            better = shut & (reached <= cost[own] - 1e-4 * part * gain[waiting] + 1e-14 * cost[own])
            here[:, own[better]], cost[own[better]] = trial[:, better], reached[better]
            moved[waiting[better]] = True
            waiting = waiting[~better]
        going = going[moved]
    return here.T, np.linalg.norm(model.residual(here), axis=0), closed


def _distance(task: _Task, q: Matrix, at: Matrix) -> Vector:
    """½ xᵀ W x (B,), x = at ⊖ q."""
    x = task.problem.tree.difference(q, at)
    return np.asarray(0.5 * np.einsum("ib,ij,jb->b", x, task.W, x))


def _gradient(task: _Task, q: Matrix, at: Matrix) -> Matrix:
    """The derivative (nv, B) of `_distance` by the motion of ``at``."""
    tree = task.problem.tree
    return tree.difference_derivative_times(q, at, task.W @ tree.difference(q, at))


def _step(task: _Task, q: Matrix, here: Matrix) -> tuple[Matrix, Vector]:
    """The Newton steps (nv, B) along the closed configurations, and how much they reduce the distance (B,)."""
    model = task.problem
    K = model.whole.jacobian(model.whole.at(here))
    v, gain = np.zeros((model.tree.nv, here.shape[1])), np.zeros(here.shape[1])
    for space in tangents(model, K):
        own: Indices = space.which
        Z, slope, H = _second_derivatives(task, q[:, own], here[:, own], K[:, :, own], space)
        H = np.where(np.isfinite(H).all(axis=(1, 2), keepdims=True), H, 0.0)
        values, vectors = np.linalg.eigh(0.5 * (H + np.swapaxes(H, 1, 2)))
        values = np.abs(values)
        least = np.maximum(1e-3 * values.max(axis=1, initial=0.0), 1e-300)
        values = np.maximum(values, least[:, None])
        along = np.einsum("bji,bj->bi", vectors, slope) / values
        step = -np.einsum("bij,bj->bi", vectors, along)
        v[:, own] = np.einsum("bnm,bm->nb", Z, step)
        gain[own] = -(slope * step).sum(axis=1)
    return v, gain


def _second_derivatives(
    task: _Task, q: Matrix, here: Matrix, K: Matrix, space: Tangents
) -> tuple[Matrix, Matrix, Matrix]:
    """Z (b, nv, m), and slope (b, m) and second derivative (b, m, m) of the distance along it."""
    model, Z = task.problem, space.basis
    g = _gradient(task, q, here)
    multipliers = np.einsum("bnc,nb->cb", space.inverse, g)
    normal = g - np.einsum("cnb,cb->nb", K, multipliers)
    H = np.empty((len(Z), Z.shape[2], Z.shape[2]))
    for column in range(Z.shape[2]):
        beside = model.tree.integrate(here, _DIFFERENCE * Z[:, :, column].T)
        K_beside = model.whole.jacobian(model.whole.at(beside))
        change = _gradient(task, q, beside) - np.einsum("cnb,cb->nb", K_beside, multipliers) - normal
        H[:, :, column] = np.einsum("bnm,nb->bm", Z, change) / _DIFFERENCE
    return Z, np.einsum("bnm,nb->bm", Z, g), H
