"""Derivatives of the closed configuration and of frames with respect to the actuated coordinates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from pinocchio import LOCAL

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import start
from eurdf.kinematics.derived import borrowed, derived
from eurdf.kinematics.driven_motion import DrivenMotion
from eurdf.kinematics.exceptions import DependentActuators
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.frame_jacobian import frame_jacobian
from eurdf.kinematics.metric import metric, orthonormal
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# An actuated joint belongs to a dependency if its entry of the unit vector of that dependency is above this.
_PART = 1e-6


@overflow_refused("the derivative")
def dq_dq_actuated(robot: Robot, q: Vector, weights: Vector | Matrix | None = None) -> Matrix:
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
    if weights is None:
        with borrowed(robot, DrivenMotion, tuple(robot.actuation.idx_v.tolist())) as driven:
            certain = driven.derivative(q)
        if certain is not None:
            finite("the derivative", certain)
            return certain
    W = metric(weights, robot.tree.nv)
    _, K = residual_and_jacobian(robot, q)
    spaces = derived(robot, TangentSpaces)
    basis = spaces.at(K).basis
    selection = robot.actuation.selection.T
    _refuse_dependent(robot, spaces.scale, basis)
    Z = orthonormal(basis, W)
    D = np.asarray(Z @ np.linalg.pinv(selection @ Z), dtype=np.float64)
    finite("the derivative", D)
    return D


@overflow_refused("the Jacobian")
def actuated_jacobian(
    robot: Robot, q: Vector, frame: str, reference: Any = LOCAL, weights: Vector | Matrix | None = None
) -> Matrix:
    """Jacobian of a frame with respect to the actuated velocities: its twist is J D u.

    J is the frame's Jacobian in the spanning tree and D is that of `dq_dq_actuated`. The pseudoinverse of J D gives the
    actuated velocities for a desired twist, and D the velocities of all joints for these.

    Source: `computeClosedLoopFrameJacobian` and `inverseConstraintKinematicsSpeed` of the toolbox of Batto, De Matteïs
    and Mansard, 2025.

    Args:
        robot: The robot.
        q: A closed configuration (nq,).
        frame: Name of a link, a joint (its frame on the child's side), or a frame of the description.
        reference: Where the twist is expressed: ``pin.LOCAL``, ``pin.WORLD`` or ``pin.LOCAL_WORLD_ALIGNED``.
        weights: See `dq_dq_actuated`.

    Returns:
        (6, nu): linear (m/s), then angular (rad/s), over the units of the actuated velocities.

    Raises:
        DependentActuators: As in `dq_dq_actuated`.
        ValueError: The frame is unknown or ambiguous, ``q`` is not a configuration, or ``weights`` is not a metric.
    """
    q = start(robot, q, "q")
    J = frame_jacobian(robot, q, frame, reference)
    actuated = np.asarray(J @ dq_dq_actuated(robot, q, weights), dtype=np.float64)
    finite("the Jacobian", actuated)
    return actuated


def _refuse_dependent(robot: Robot, scale: Vector, basis: Matrix) -> None:
    """Raise if the null space of K, spanned by the basis, does not contain every choice of the actuated velocities."""
    rows = robot.actuation.idx_v
    unit_free, _ = np.linalg.qr(basis / scale[:, None])
    left, values, _ = np.linalg.svd(unit_free[rows])
    rank = numerical_rank(values, 1.0)
    if rank == len(rows):
        return
    concerned = rows[np.abs(left[:, rank:]).max(axis=1) > _PART]
    names = [
        name
        for name in robot.actuation.joints
        if not set(robot.tree.velocities_of(name)).isdisjoint(concerned.tolist())
    ]
    raise DependentActuators(tuple(names), len(rows), rank)
