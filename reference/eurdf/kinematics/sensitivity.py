"""How the closed mechanism moves with its actuated joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import start
from eurdf.kinematics.exceptions import DependentActuators
from eurdf.kinematics.frame_index import frame_index
from eurdf.kinematics.metric import metric, orthonormal
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# An actuated joint has a part in a dependency if its share of the unit vector that states it is above this.
_PART = 1e-6


def dq_dq_actuated(robot: Robot, q: Vector, weights: Vector | Matrix | None = None) -> Matrix:
    """Derivative of the closed configuration by the actuated coordinates: v = D u.

    D solves K D = 0, Sᵀ D = 1. Motion that no actuator controls is at rest as far as it can be: of all solutions, each
    column of D is the shortest, in the metric W. With K Z = 0 and Zᵀ W Z = 1, D = Z (Sᵀ Z)⁺.

    Source: `computeDerivative_dq_dqmot` of the toolbox of Batto, De Matteïs and Mansard, 2025, there through the
    pseudoinverse of the columns of K that are not actuated.

    Args:
        robot: The robot.
        q: A closed configuration (nq,).
        weights: The metric W: a matrix (nv, nv), or its diagonal (nv,); the identity by default, rad/s and m/s alike.

    Returns:
        D (nv, nu): the velocity of each joint over that of each actuator, in the order of ``robot.actuation``.

    Raises:
        DependentActuators: The closures do not let the actuators move independently at q; it names those concerned.
            The rank of Sᵀ Z that says so is that of `numerical_rank`, Z orthonormal with lengths counted in
            characteristic lengths: its singular values are then cosines between the motions asked for and those free.
        ValueError: ``q`` is no configuration, or ``weights`` are no metric.
    """
    W = metric(weights, robot.model.nv)
    _, K = residual_and_jacobian(robot, start(robot, q))
    spaces = TangentSpaces(robot)
    basis = spaces.at(K).basis
    selection = robot.actuation.selection.T
    _refuse_dependent(robot, spaces.scale, basis)
    Z = orthonormal(basis, W)
    return np.asarray(Z @ np.linalg.pinv(selection @ Z), dtype=np.float64)


def actuated_jacobian(
    robot: Robot, q: Vector, frame: str, reference: Any = pin.LOCAL, weights: Vector | Matrix | None = None
) -> Matrix:
    """Jacobian of a frame by the actuated velocities: its twist is J D u.

    J is the frame's Jacobian in the spanning tree and D that of `dq_dq_actuated`. The actuated velocities that give the
    frame a wanted twist are those of the pseudoinverse of J D, and D makes the velocity of all joints of them.

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
        DependentActuators: As from `dq_dq_actuated`.
        ValueError: There is no such frame, or its name stands for two; ``q`` is no configuration; ``weights`` are no
            metric.
    """
    model, index = robot.model, frame_index(robot.model, frame)
    q = start(robot, q)
    J = pin.computeFrameJacobian(model, model.createData(), q, index, reference)
    return np.asarray(J.reshape(6, -1) @ dq_dq_actuated(robot, q, weights), dtype=np.float64)


def _refuse_dependent(robot: Robot, scale: Vector, basis: Matrix) -> None:
    """Raise if ker K, spanned by the basis, does not hold every choice of the actuated velocities."""
    rows = robot.actuation.idx_v
    unit_free, _ = np.linalg.qr(basis / scale[:, None])
    left, values, _ = np.linalg.svd(unit_free[rows])
    rank = numerical_rank(values, 1.0)
    if rank == len(rows):
        return
    concerned = rows[np.abs(left[:, rank:]).max(axis=1) > _PART]
    joints = robot.model.joints
    names = [
        name
        for name in robot.actuation.joints
        if _velocities(joints[robot.model.getJointId(name)]).intersection(concerned.tolist())
    ]
    raise DependentActuators(tuple(names), len(rows), rank)


def _velocities(joint: Any) -> set[int]:
    return set(range(joint.idx_v, joint.idx_v + joint.nvExtended))
