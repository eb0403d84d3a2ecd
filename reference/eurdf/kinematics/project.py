"""Projections onto the closures: of a configuration, a velocity and an acceleration.

Source: `configurationProjection`, `velocityProjection` and `accelerationProjection` of the toolbox of Batto, De Matteïs
and Mansard, 2025.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.errors import NotClosable
from eurdf.kinematics.assembly import assembled
from eurdf.kinematics.closing import close, start
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.metric import metric, weighted
from eurdf.kinematics.named import Named, velocity_of
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.residual import acceleration_drift, residual_and_jacobian
from eurdf.kinematics.tangent_space import SpacePart, TangentSpaces
from eurdf.kinematics.tolerances import RESTARTS, SOLVED
from eurdf.pinocchio.arguments import checked_tolerance
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_MOST_STEPS = 50
_MOST_HALVINGS = 20

# Step of the finite differences for second derivatives, which only guide the search.
_DIFFERENCE = 1e-6


@overflow_refused("the configuration")
def project_configuration(
    robot: Robot, q: Named, *, weights: Named | Matrix | None = None, tolerance: float = SOLVED
) -> Vector:
    """The closed configuration nearest to q.

    It minimises ½ xᵀ W x subject to r(q ⊕ x) = 0, where x = q' ⊖ q is the velocity (nv,) that leads from q to q' in
    unit time: W x is normal to the closed configurations. The loops are closed first; then Newton steps move q' along
    the closed configurations to a local minimum of the distance. If W is diagonal, joints outside the loops do not
    move.

    Args:
        robot: The robot.
        q: Any configuration (nq,).
        weights: The metric W: a matrix (nv, nv), or its diagonal (nv,). The default is the identity: the sum of squares
            of all motions, in rad and m.
        tolerance: Bound of each row of the residual for closed loops, m or rad.

    Returns:
        q' (nq,); q itself if it is closed. If rounding makes redundant rows contradict each other, it is closed as far
        as `assemble` can close it.

    Raises:
        NotClosable: No closed configuration was found; the error lists the closures that stay open.
        ValueError: ``q`` is not a configuration, or ``weights`` is not a metric.
    """
    W, tolerance = metric(robot, weights), checked_tolerance(tolerance)
    q = start(robot, q, "q")
    with working_memory(robot, Problem) as problem:
        found, closed = nearest_closed(ProjectionTask(problem, W, tolerance), q[None])
        if not closed[0]:
            finite("the residual", problem.residual(q[None]))
            assembly = assembled(problem, q, tolerance)
            raise NotClosable("no closed configuration was found near the given one", assembly.open, assembly.q)
    finite("the configuration", found)
    return np.array(found[0])


class ProjectionTask(NamedTuple):
    """What is the same for all elements.

    Attributes:
        problem: The robot.
        W: The metric (nv, nv), or its diagonal (nv,).
        tolerance: Bound of each row of the residual for closed loops, m or rad.
    """

    problem: Problem
    W: Matrix
    tolerance: float


def nearest_closed(task: ProjectionTask, q: Matrix) -> tuple[Matrix, Mask]:
    """The nearest closed configurations (B, nq) to q (B, nq), and where (B,) one was found; else the least open one."""
    problem = task.problem
    here, closed = np.array(q), np.ones(len(q), dtype=bool)
    going = np.flatnonzero(~(np.abs(problem.residual(q)).max(axis=1, initial=0.0) <= task.tolerance))
    if len(going):
        found = close(problem, q[going], task.tolerance, RESTARTS)
        here[going], closed[going] = found.q, found.closes
    going = going[closed[going]]
    cost = _distance(task, q, here)
    for _ in range(_MOST_STEPS):
        if not len(going):
            break
        v, gain = _step(task, q[going], here[going])
        far = gain > 1e-14 * cost[going]
        going, v, gain = going[far], v[far], gain[far]
        waiting, moved = np.arange(len(going)), np.zeros(len(going), dtype=bool)
        part = 1.0
        for _ in range(_MOST_HALVINGS):
            if not len(waiting):
                break
            own = going[waiting]
            trial = close(problem, problem.tree.integrate(here[own], part * v[waiting]), task.tolerance)
            reached = _distance(task, q[own], trial.q)
            better = trial.closes & (reached <= cost[own] - 1e-4 * part * gain[waiting] + 1e-14 * cost[own])
            here[own[better]], cost[own[better]] = trial.q[better], reached[better]
            moved[waiting[better]] = True
            waiting, part = waiting[~better], 0.5 * part
        going = going[moved]
    return here, closed


def _distance(task: ProjectionTask, q: Matrix, at: Matrix) -> Vector:
    """½ xᵀ W x (B,), x = at ⊖ q."""
    x = task.problem.tree.difference(q, at)
    return np.asarray(0.5 * (weighted(task.W, x.T).T * x).sum(axis=1))


def _gradient(task: ProjectionTask, q: Matrix, at: Matrix) -> Matrix:
    """The derivative (B, nv) of `_distance` by the motion of ``at``."""
    tree = task.problem.tree
    return np.asarray(tree.difference_derivative_times(q, at, weighted(task.W, tree.difference(q, at).T).T))


def _step(task: ProjectionTask, q: Matrix, here: Matrix) -> tuple[Matrix, Vector]:
    """The Newton steps (B, nv) along the closed configurations, and how much they reduce the distance (B,)."""
    problem = task.problem
    K = problem.jacobian(here)
    v, gain = np.zeros((len(q), problem.tree.nv)), np.zeros(len(q))
    for space in problem.spaces.each(K):
        own: Indices = space.which
        # With a diagonal metric, groups of loops do not depend on each other, and the others have no slope.
        parts = space.parts(together=task.W.ndim == 2)
        slopes, second = _derivatives(task, q[own], here[own], K[own], parts)
        for part, slope, step in zip(parts, slopes, _downhill(second, slopes), strict=True):
            v[own[:, None, None], part.velocities] = (part.basis @ step[..., None])[..., 0]
            gain[own] -= (slope * step).sum(axis=(1, 2))
    return v, gain


def _derivatives(
    task: ProjectionTask, q: Matrix, here: Matrix, K: Matrix, parts: Sequence[SpacePart]
) -> tuple[list[Matrix], list[Matrix]]:
    """Of each part the slope (b, g, f) and the second derivative (b, g, f, f) of the distance along its basis.

    One motion of all parts shows a column of each, since they do not depend on each other.
    """
    problem, g = task.problem, _gradient(task, q, here)
    slopes, normals = [], []
    for part in parts:
        own = g[:, part.velocities][:, :, None]
        multipliers = own @ part.inverse
        normals.append((multipliers, own - multipliers @ part.of(K)))
        slopes.append((own @ part.basis)[:, :, 0])
    changes = [np.empty(part.basis.shape) for part in parts]
    for column in range(max((part.basis.shape[3] for part in parts), default=0)):
        moving = [index for index, part in enumerate(parts) if column < part.basis.shape[3]]
        v = np.zeros(g.shape)
        for index in moving:
            v[:, parts[index].velocities] = parts[index].basis[..., column]
        beside = problem.tree.integrate(here, _DIFFERENCE * v)
        there, K_there = _gradient(task, q, beside), problem.jacobian(beside)
        for index in moving:
            part, (multipliers, normal) = parts[index], normals[index]
            along = multipliers @ part.of(K_there)
            change = there[:, part.velocities][:, :, None] - along - normal
            changes[index][..., column] = change[:, :, 0] / _DIFFERENCE
    second = [part.basis.swapaxes(2, 3) @ change for part, change in zip(parts, changes, strict=True)]
    return slopes, second


@overflow_refused("the velocity")
def project_velocity(robot: Robot, q: Named, v: Named, *, weights: Named | Matrix | None = None) -> Vector:
    """The velocity nearest to v that keeps the loops closed.

    The orthogonal projection onto ker K(q): v' = Z (Zᵀ W Z)⁻¹ Zᵀ W v with K Z = 0, which minimises (v' - v)ᵀ W (v' - v)
    subject to K v' = 0. With the mass matrix as W it is the velocity after an impulse that closes the closures.

    Args:
        robot: The robot.
        q: Configuration (nq,), closed or open. At a singular q, motions that are free to first order count as free.
        v: Velocity (nv,), rad/s or m/s.
        weights: The metric W: a matrix (nv, nv), or its diagonal (nv,); the identity by default.

    Returns:
        v' (nv,).

    Raises:
        ValueError: ``q`` or ``v`` has another shape or is not finite, or ``weights`` is not a metric.
    """
    W = metric(robot, weights)
    v = velocity_of(robot, v)
    _, K = residual_and_jacobian(robot, start(robot, q, "q"))
    projected = robot.cached(TangentSpaces).at(K).nearest(W, v)
    finite("the velocity", projected)
    return projected


@overflow_refused("the acceleration")
def project_acceleration(
    robot: Robot, q: Named, v: Named, a: Named, *, weights: Named | Matrix | None = None
) -> Vector:
    """The acceleration nearest to a that keeps the loops closed.

    It minimises (a' - a)ᵀ W (a' - a) subject to K(q) a' + K̇ v = 0, with K̇ v from `acceleration_drift`.

    Args:
        robot: The robot.
        q: Configuration (nq,).
        v: Velocity (nv,), rad/s or m/s. It should keep the loops closed, K v = 0. If it does not, redundant rows can
            contradict each other; they are then satisfied in the least-squares sense, in units of the characteristic
            length.
        a: Acceleration (nv,), rad/s² or m/s².
        weights: The metric W: a matrix (nv, nv), such as the mass matrix (Gauss' principle of least constraint), or
            its diagonal (nv,); the identity by default.

    Returns:
        a' (nv,).

    Raises:
        ValueError: ``q``, ``v`` or ``a`` has another shape or is not finite, or ``weights`` is not a metric.
    """
    W = metric(robot, weights)
    v, a, q = velocity_of(robot, v), velocity_of(robot, a, "a"), start(robot, q, "q")
    _, K = residual_and_jacobian(robot, q)
    space = robot.cached(TangentSpaces).at(K)
    forced = -space.inverse @ acceleration_drift(robot, q, v)
    projected = forced + space.nearest(W, a - forced)
    finite("the acceleration", projected)
    return projected


def _downhill(second: Sequence[Matrix], slopes: Sequence[Matrix]) -> list[Matrix]:
    """The Newton steps -H⁻¹ slope (b, g, f) of each part, with H (b, g, f, f) made positive definite if it is not."""
    found, most = [], np.zeros(len(slopes[0]) if slopes else 0)
    for H in second:
        H = np.where(np.isfinite(H).all(axis=(2, 3), keepdims=True), H, 0.0)
        values, vectors = np.linalg.eigh(0.5 * (H + H.swapaxes(2, 3)))
        found.append((np.abs(values), vectors))
        most = np.maximum(most, found[-1][0].max(axis=(1, 2), initial=0.0))
    least = np.maximum(1e-3 * most, 1e-300)[:, None, None]
    return [
        -(vectors @ ((slope[:, :, None] @ vectors)[:, :, 0] / np.maximum(values, least))[..., None])[..., 0]
        for (values, vectors), slope in zip(found, slopes, strict=True)
    ]
