"""A stand-in for `pinocchio.casadi`, which no wheel of Pinocchio has: what the published toolbox calls of it.

Symbols are CasADi's, coordinates Pinocchio's. Joints have one coordinate or are spherical, as those of the robots that
are tried.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import casadi
import numpy as np
import pinocchio as pin

#: Added to squares below a root, so that derivatives at zero are finite; far below rounding.
_TINY = 1e-24
#: Below this square of an angle (rad²), a series replaces its formula, which cancels.
_SMALL = 1e-4


class SE3:
    """A pose in symbols."""

    def __init__(self, rotation: Any, translation: Any = None) -> None:
        pose = rotation if translation is None else None
        self.rotation = casadi.SX(pose.rotation if pose else rotation)
        self.translation = casadi.SX(pose.translation if pose else translation)

    def __mul__(self, other: SE3) -> SE3:
        return SE3(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)

    def inverse(self) -> SE3:
        """The pose of the first frame in the second."""
        return SE3(self.rotation.T, -self.rotation.T @ self.translation)

    def actInv(self, other: SE3) -> SE3:  # noqa: N802 - as Pinocchio's
        """A pose of the first frame, in the second."""
        return self.inverse() * other


class Model:
    """A Pinocchio model whose configurations are symbols."""

    def __init__(self, model: Any) -> None:
        self.model, self.nq, self.nv = model, model.nq, model.nv

    def createData(self) -> Any:  # noqa: N802 - as Pinocchio's
        """Where poses are written to."""
        return SimpleNamespace(oMi=[], oMf=[])


class RigidConstraintModel:
    """A closure."""

    def __init__(self, constraint: Any) -> None:
        for name in ("type", "joint1_id", "joint2_id", "joint1_placement", "joint2_placement"):
            setattr(self, name, getattr(constraint, name))

    def createData(self) -> None:  # noqa: N802 - as Pinocchio's
        """Nothing is kept."""


def _root(square: Any) -> Any:
    return casadi.sqrt(square + _TINY)


def exp3(v: Any) -> Any:
    """The rotation matrix of a rotation vector (rad)."""
    angle, W = _root(casadi.dot(v, v)), casadi.skew(v)
    return casadi.SX.eye(3) + casadi.sin(angle) / angle * W + 2.0 * (casadi.sin(angle / 2.0) / angle) ** 2 * W @ W


def log6(pose: SE3) -> Any:
    """The twist, linear before angular, whose exponential is a pose that turns by less than π."""
    R = pose.rotation
    w = casadi.vertcat(R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]) / 2.0
    sine = _root(casadi.dot(w, w))
    angle = casadi.atan2(sine, (casadi.trace(R) - 1.0) / 2.0)
    omega = angle / sine * w
    square = angle**2
    by_formula = (1.0 - angle / 2.0 / casadi.tan(angle / 2.0)) / square
    W = casadi.skew(omega)
    factor = casadi.if_else(square < _SMALL, 1.0 / 12.0 + square / 720.0, by_formula)
    linear = pose.translation - W @ pose.translation / 2.0 + factor * W @ W @ pose.translation
    return SimpleNamespace(vector=casadi.vertcat(linear, omega))


def _times(q: Any, r: Any) -> Any:
    """Product of two quaternions, x y z w."""
    vector = q[3] * r[:3] + r[3] * q[:3] + casadi.cross(q[:3], r[:3])
    return casadi.vertcat(vector, q[3] * r[3] - casadi.dot(q[:3], r[:3]))


def _turned(q: Any, v: Any) -> Any:
    angle = _root(casadi.dot(v, v))
    return _times(q, casadi.vertcat(casadi.sin(angle / 2.0) / angle * v, casadi.cos(angle / 2.0)))


def _matrix(q: Any) -> Any:
    W = casadi.skew(q[:3])
    return casadi.SX.eye(3) + 2.0 * (q[3] * W + W @ W)


def _moved(joint: Any, q: Any) -> SE3:
    if joint.nq == 4:
        return SE3(_matrix(q), casadi.SX.zeros(3))
    data = joint.createData()
    joint.calc(data, np.zeros(joint.idx_q + 1))
    axis = np.array(data.S).reshape(6)
    return SE3(exp3(q * axis[3:]), q * axis[:3])


def integrate(model: Model, q: Any, v: Any) -> Any:
    """The configuration reached from another by a tangent vector."""
    parts = []
    for joint in list(model.model.joints)[1:]:
        if (joint.nq, joint.nv) not in ((1, 1), (4, 3)):
            raise NotImplementedError(f"a joint {joint.shortname()}")
        a, b = q[joint.idx_q : joint.idx_q + joint.nq], v[joint.idx_v : joint.idx_v + joint.nv]
        parts.append(_turned(a, b) if joint.nq == 4 else a + b)
    return casadi.vertcat(*parts)


def forwardKinematics(model: Model, data: Any, q: Any) -> None:  # noqa: N802 - as Pinocchio's
    """Write the poses of all joints."""
    of = model.model
    data.oMi = [SE3(pin.SE3.Identity())]
    for index in range(1, of.njoints):
        joint = of.joints[index]
        moved = SE3(of.jointPlacements[index]) * _moved(joint, q[joint.idx_q : joint.idx_q + joint.nq])
        data.oMi.append(data.oMi[of.parents[index]] * moved)


def framesForwardKinematics(model: Model, data: Any, q: Any) -> None:  # noqa: N802 - as Pinocchio's
    """Write the poses of all joints and frames."""
    forwardKinematics(model, data, q)
    data.oMf = [data.oMi[frame.parentJoint] * SE3(frame.placement) for frame in model.model.frames]
