"""Plain Newton on Pinocchio: what one writes without this package, with no check, no branch, no limit and no restart.

Each step evaluates the closures by `computeJointJacobians`, `getConstraintJacobian` and `log6`, and solves with
`numpy.linalg.lstsq`. A hinge is two 3d closures, a distance is the length of a 3d residual. It ends where every row of
the closures is within 1e-10 (m, rad), and every frame within 1e-8.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf
from eurdf.closures.distance import DistanceClosure
from eurdf.closures.point import PointClosure
from eurdf.mechanism.constraint import Constraint, Coupling
from eurdf.pinocchio.constraint import build_constraint_models

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]

CLOSED = 1e-10
AT_TARGET = 1e-8
_MOST_STEPS = 50


class NotConverged(Exception):  # noqa: N818 - no error of the package
    """It did not converge in 50 steps."""


class PlainNewton:
    """The methods for one robot, whose memory is made once."""

    def __init__(self, robot: eurdf.Robot) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self._pairs: list[tuple[pin.RigidConstraintModel, pin.RigidConstraintData, float | None]] = []
        self._C, self._offset = np.zeros((0, self.model.nv)), np.zeros(0)
        self._coordinates = np.zeros(self.model.nv, dtype=int)
        each: Constraint
        for each in robot.constraints:
            if isinstance(each, Coupling):
                self._add_coupling(robot, each)
                continue
            length = None
            if isinstance(each, DistanceClosure):
                length, each = each.length, PointClosure(each.name, each.a, each.b)
            for model in build_constraint_models([each], robot.tree):
                self._pairs.append((model, model.createData(), length))
        self.driven, self._driven_q = robot.actuation.idx_v, robot.actuation.idx_q
        self.free = np.setdiff1d(np.arange(self.model.nv), self.driven)

    def _add_coupling(self, robot: eurdf.Robot, coupling: Coupling) -> None:
        row = np.zeros((1, self.model.nv))
        for name, coefficient in coupling.coefficients:
            row[0, robot.slots[name].idx_v] = coefficient
            self._coordinates[robot.slots[name].idx_v] = robot.slots[name].idx_q
        self._C, self._offset = np.vstack((self._C, row)), np.append(self._offset, coupling.offset)

    def closures(self, q: Vector) -> tuple[Vector, Matrix]:
        """Residual and its derivative."""
        pin.computeJointJacobians(self.model, self.data, q)
        r, K = [self._C @ q[self._coordinates] - self._offset], [self._C]
        for model, data, length in self._pairs:
            model.calc(self.model, self.data, data)
            J = pin.getConstraintJacobian(self.model, self.data, model, data)
            position = data.c1Mc2.translation
            if model.type == pin.ContactType.CONTACT_6D:
                r.append(pin.log6(data.c1Mc2).vector)
                K.append(pin.Jlog6(data.c1Mc2.inverse()) @ -J)
            elif length is None:
                r.append(position)
                K.append(-J)
            else:
                distance = np.linalg.norm(position)
                r.append(np.array([distance - length]))
                K.append((position / -distance) @ J)
        return np.concatenate(r), np.vstack(K)

    def constraint_jacobian_alone(self, q: Vector) -> list[Matrix]:
        """Pinocchio's own Jacobians: with neither a residual nor log6."""
        pin.computeJointJacobians(self.model, self.data, q)
        for model, data, _ in self._pairs:
            model.calc(self.model, self.data, data)
        return [pin.getConstraintJacobian(self.model, self.data, model, data) for model, data, _ in self._pairs]

    def forward_kinematics(self, actuated: Vector, q0: Vector) -> Vector:
        """The closed configuration with the actuated coordinates given."""
        q = np.array(q0)
        q[self._driven_q] = actuated
        for _ in range(_MOST_STEPS):
            r, K = self.closures(q)
            if np.abs(r).max() <= CLOSED:
                return q
            v = np.zeros(self.model.nv)
            v[self.free] = np.linalg.lstsq(K[:, self.free], -r, rcond=None)[0]
            q = pin.integrate(self.model, q, v)
        raise NotConverged

    def at(self, frame: int, target: Any) -> tuple[Vector, Matrix, float]:
        """Of a frame's pose, rows of the error (6,) and its derivative (6, nv), and the error, m or rad."""
        oMf = pin.updateFramePlacement(self.model, self.data, frame)
        J = pin.getFrameJacobian(self.model, self.data, frame, pin.LOCAL)
        away, turn = oMf.translation - target.translation, target.rotation.T @ oMf.rotation
        angle = pin.log3(turn)
        rows = np.vstack((oMf.rotation @ J[:3], pin.Jlog3(turn) @ J[3:]))
        return np.concatenate((away, angle)), rows, float(max(np.linalg.norm(away), np.linalg.norm(angle)))

    def errors(self, frame: int, target: Any, q: Vector) -> tuple[float, float]:
        """How far the closures are open, and how far a frame is from its target, m or rad."""
        r, _ = self.closures(q)
        return float(np.abs(r).max(initial=0.0)), self.at(frame, target)[2]

    def inverse_kinematics(self, frame: int, target: Any, q0: Vector) -> Vector:
        """The closed configuration with a frame at a pose."""
        q = np.array(q0)
        for _ in range(_MOST_STEPS):
            r, K = self.closures(q)
            error, J, size = self.at(frame, target)
            if np.abs(r).max(initial=0.0) <= CLOSED and size <= AT_TARGET:
                return q
            v = np.linalg.lstsq(np.vstack((K, J)), -np.concatenate((r, error)), rcond=None)[0]
            q = pin.integrate(self.model, q, v)
        raise NotConverged

    def dq_dq_actuated(self, q: Vector) -> Matrix:
        """The formula of the published toolbox: the pseudoinverse of the columns of K that are not actuated."""
        _, K = self.closures(q)
        D = np.zeros((self.model.nv, len(self.driven)))
        D[self.driven, np.arange(len(self.driven))] = 1.0
        D[self.free] = -np.linalg.pinv(K[:, self.free]) @ K[:, self.driven]
        return D
