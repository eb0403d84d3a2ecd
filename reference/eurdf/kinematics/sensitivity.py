"""Derivatives of the closed configuration and of frames with respect to the actuated coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pinocchio import LOCAL

from eurdf.array import Indices, Mask, Matrix, Vector, numbers
from eurdf.errors import DependentActuators
from eurdf.kinematics.closing import start
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.frame_jacobian import checked_reference, frame_jacobian, frames_of, in_reference
from eurdf.kinematics.metric import metric, orthonormal
from eurdf.kinematics.named import Named
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import numerical_rank, numerical_ranks, product
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# An actuated joint belongs to a dependency if its entry of the unit vector of that dependency is above this.
_PART = 1e-6


@overflow_refused("the derivative")
def dq_dq_actuated(robot: Robot, q: Named, *, weights: Named | Matrix | None = None) -> Matrix:
    """Derivative of the closed configuration with respect to the actuated coordinates: v = D u.

    D solves K D = 0, Sᵀ D = 1. Of all solutions, each column of D is the one with the least norm in the metric W, so
    uncontrolled motions are minimal. With K Z = 0 and Zᵀ W Z = 1, D = Z (Sᵀ Z)⁺.

    Source: `computeDerivative_dq_dqmot` of the toolbox of Batto, De Matteïs and Mansard, 2025, which uses the
    pseudoinverse of the columns of K of the joints that are not actuated.

    Args:
        robot: The robot.
        q: A closed configuration (nq,).
        weights: The metric W: a matrix (nv, nv), or its diagonal (nv,); the identity by default, in rad/s and m/s.

    Returns:
        D (nv, nu): velocity of each joint per velocity of each actuator, in the order of ``robot.actuation``.

    Raises:
        DependentActuators: The closures do not let the actuators move independently at q; the error names them. The
            criterion is the `numerical_rank` of Sᵀ Z, with Z orthonormal in units of the characteristic length: its
            singular values are the cosines between the actuated and the free motions.
        ValueError: ``q`` is not a configuration, or ``weights`` is not a metric.
    """
    q = start(robot, q, "q")
    W = None if weights is None else metric(robot, weights)
    velocities = robot.actuation.idx_v
    with working_memory(robot, Problem) as free, working_memory(robot, Problem, tuple(velocities.tolist())) as driven:
        (D,), (dependent,) = _derivatives(free, driven, W, q[None])
        if dependent:
            _refuse_dependent(robot, free, q)
    finite("the derivative", D)
    return np.asarray(D)


@overflow_refused("the Jacobian")
def actuated_jacobian(
    robot: Robot, frame: str, q: Named, *, reference: Any = LOCAL, weights: Named | Matrix | None = None
) -> Matrix:
    """Jacobian of a frame with respect to the actuated velocities: its twist is J D u.

    J is the frame's Jacobian in the spanning tree and D is that of `dq_dq_actuated`. The pseudoinverse of J D gives the
    actuated velocities for a desired twist, and D the velocities of all joints for these.

    Source: `computeClosedLoopFrameJacobian` and `inverseConstraintKinematicsSpeed` of the toolbox of Batto, De Matteïs
    and Mansard, 2025.

    Args:
        robot: The robot.
        frame: Name of a link, a joint (its frame on the child's side), or a frame of the description.
        q: A closed configuration (nq,).
        reference: Where the twist is expressed: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.
        weights: See `dq_dq_actuated`.

    Returns:
        (6, nu): linear (m/s), then angular (rad/s), over the units of the actuated velocities.

    Raises:
        DependentActuators: As in `dq_dq_actuated`.
        ValueError: The frame is unknown or ambiguous, ``q`` is not a configuration, or ``weights`` is not a metric.
    """
    q, W = start(robot, q, "q"), None if weights is None else metric(robot, weights)
    velocities = tuple(robot.actuation.idx_v.tolist())
    with working_memory(robot, Problem) as free, working_memory(robot, Problem, velocities) as driven:
        with working_memory(robot, frames_of, frame) as frames:
            (J,), (dependent,) = actuated_jacobians(
                JacobianTask(free, driven, frames, checked_reference(reference), W), q[None]
            )
        if dependent:
            _refuse_dependent(robot, free, q)
    finite("the Jacobian", J)
    return np.asarray(J)


class JacobianTask(NamedTuple):
    """What is the same for all elements.

    Attributes:
        free: The robot.
        driven: The robot with its actuated velocities given.
        frames: The frame.
        reference: The axes of the twist.
        W: The metric (nv, nv); None for the identity.
    """

    free: Problem
    driven: Problem
    frames: Any
    reference: Any
    W: Matrix | None


def actuated_jacobians(task: JacobianTask, q: Matrix) -> tuple[Matrix, Mask]:
    """`actuated_jacobian` (B, 6, nu) at q (B, nq), and where (B,) the actuators depend on each other."""
    J = in_reference(task.frames, q, task.reference)
    D, dependent = _derivatives(task.free, task.driven, task.W, q)
    return product(J, D), dependent


def _derivatives(free: Problem, driven: Problem, W: Matrix | None, q: Matrix) -> tuple[Matrix, Mask]:
    """`dq_dq_actuated` (B, nv, nu) at q (B, nq), and where (B,) the actuators depend on each other."""
    dependent, velocities = np.zeros(len(q), dtype=bool), driven.given
    if W is None:
        D, sure = driven.derivative(q)
        if np.count_nonzero(sure) == len(q):
            return D, dependent
    else:
        D, sure = np.full((len(q), free.tree.nv, len(velocities)), np.nan), np.zeros(len(q), dtype=bool)
    doubtful = np.flatnonzero(~sure)
    K = free.jacobian(q[doubtful])
    ok = np.isfinite(K).all(axis=(1, 2))
    D[doubtful[~ok]] = np.nan
    doubtful = doubtful[ok]
    for space in free.spaces.each(K[ok]):
        own, basis = doubtful[space.which], space.basis
        dependent[own] = _rank_of_actuators(free, basis, velocities) < len(velocities)
        Z = basis if W is None else orthonormal(basis, W)
        D[own] = Z @ np.linalg.pinv(Z[:, velocities])
    return D, dependent


def _rank_of_actuators(free: Problem, basis: Matrix, velocities: Indices) -> Indices:
    """Ranks (b,) of the choices of the actuated velocities that null spaces of K, with bases (b, nv, m), contain."""
    unit_free, _ = np.linalg.qr(basis / free.spaces.scale[:, None])
    values = np.linalg.svd(unit_free[:, velocities], compute_uv=False)
    return numerical_ranks(values, np.ones(len(basis)))


def _refuse_dependent(robot: Robot, free: Problem, q: Vector) -> None:
    """Raise, naming the actuators that depend on each other at q (nq,)."""
    rows, spaces = robot.actuation.idx_v, free.spaces
    unit_free, _ = np.linalg.qr(spaces.at(free.jacobian(q[None])[0]).basis / spaces.scale[:, None])
    left, values, _ = np.linalg.svd(unit_free[rows])
    rank = numerical_rank(values, 1.0)
    concerned = set(rows[np.abs(left[:, rank:]).max(axis=1) > _PART].tolist())
    names = [name for name in robot.actuation.joints if not concerned.isdisjoint(robot.tree.velocities_of(name))]
    raise DependentActuators(tuple(names), len(rows), rank)


class FrameVelocity(NamedTuple):
    """The result of `differential_inverse_kinematics`.

    Attributes:
        v: Velocity (nv,), rad/s and m/s, with K v = 0.
        actuated: Velocities (nu,) of the actuators, Sᵀ v, in the order of ``robot.actuation``.
        twist: Resulting twist (6,) of the frame, linear (m/s), then angular (rad/s), in the axes of ``reference``.
        rank: Number of independent motions of the frame that are used, at most 6.
    """

    v: Vector
    actuated: Vector
    twist: Vector
    rank: int

    def __repr__(self) -> str:
        return (
            f"<FrameVelocity: twist {numbers(self.twist)} m/s and rad/s, of rank {self.rank}; "
            f"actuated {numbers(self.actuated)} rad/s or m/s>"
        )


@overflow_refused("the velocity")
def differential_inverse_kinematics(
    robot: Robot, frame: str, q: Named, twist: ArrayLike, *, reference: Any = LOCAL, singular: float = 1e-3
) -> FrameVelocity:
    """The velocity of the closed mechanism for a desired twist of a frame.

    Let C (nv, r) be a basis of the motions that the actuators control, K C = 0, in which uncontrolled motions are
    minimal, and J the Jacobian of the frame. The result is v = C (J C)⁺ twist: of all velocities that bring the twist
    nearest to the desired one, the one with the slowest actuators. Lengths are in characteristic lengths. In the
    pseudoinverse, singular values of J C below the fraction ``singular`` of the largest one count as zero, so motions
    that need much faster actuators are left out, and velocities stay bounded near a singular configuration:
    |v_a| ≤ |twist| / (``singular`` σ₁).

    Source: `inverseConstraintKinematicsSpeed` of the toolbox of Batto, De Matteïs and Mansard, 2025, which does not
    truncate singular values.

    Args:
        robot: The robot. Its actuators may depend on one another.
        frame: Name of a link, a joint (its frame on the child side), or a frame of the description.
        q: A closed configuration (nq,).
        twist: Desired twist (6,) of the frame relative to the world: linear (m/s), then angular (rad/s).
        reference: The axes of the twist: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.
        singular: Fraction of the largest singular value below which a singular value counts as zero, between 0 and 1.

    Returns:
        The velocity and the resulting twist. If that differs from the desired one, the frame cannot move so, or only
        with much faster actuators.

    Raises:
        ValueError: The frame is unknown or ambiguous; ``q`` is not a configuration; ``twist`` is not six finite
            numbers; ``singular`` is not between 0 and 1.
    """
    wanted = checked_array("twist", twist, (6,))
    if not 0.0 < singular < 1.0:
        raise ValueError(f"singular is {singular!r}; give a number between 0 and 1")
    q = start(robot, q, "q")
    spaces = robot.cached(TangentSpaces)
    C = _actuated_motions(robot, q, spaces)
    J = frame_jacobian(robot, q, frame, reference)
    scale = np.array((1.0 / spaces.length,) * 3 + (1.0,) * 3)
    left, values, right = np.linalg.svd(scale[:, None] * (J @ C), full_matrices=False)
    rank = int(np.count_nonzero(values > singular * values.max(initial=0.0)))
    v = C @ (right[:rank].T @ ((left[:, :rank].T @ (scale * wanted)) / values[:rank]))
    finite("the velocity", v, J @ v)
    return FrameVelocity(v, v[robot.actuation.idx_v], J @ v, rank)


def _actuated_motions(robot: Robot, q: Vector, spaces: TangentSpaces) -> Matrix:
    """C (nv, r): motions that keep the loops closed and that the actuators control; Sᵀ C is orthonormal."""
    _, K = residual_and_jacobian(robot, q)
    free, _ = np.linalg.qr(spaces.at(K).basis / spaces.scale[:, None])
    _, values, right = np.linalg.svd(free[robot.actuation.idx_v], full_matrices=False)
    rank = numerical_rank(values, 1.0)
    return np.asarray(spaces.scale[:, None] * free @ (right[:rank].T / values[:rank]))
