"""Plain Newton on Pinocchio: what one writes without this package, with no check, no branch, no limit and no restart.

Each step evaluates the closures by `computeJointJacobians`, `getConstraintJacobian` and `log6`, and solves with
`numpy.linalg.lstsq`. It ends where every row of the closures is within 1e-10 (m, rad), and every frame within 1e-8.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

import eurdf

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
        self._models = robot.constraint_models
        self._datas = [model.createData() for model in self._models]
        self._six = [model.type == pin.ContactType.CONTACT_6D for model in self._models]
        self.driven, self._driven_q = robot.actuation.idx_v, robot.actuation.idx_q
        self.free = np.setdiff1d(np.arange(self.model.nv), self.driven)

    def closures(self, q: Vector) -> tuple[Vector, Matrix]:
        """Residual and its derivative."""
        pin.computeJointJacobians(self.model, self.data, q)
        r, K = [], []
        for model, data, six in zip(self._models, self._datas, self._six, strict=True):
            model.calc(self.model, self.data, data)
            J = pin.getConstraintJacobian(self.model, self.data, model, data)
            if six:
                r.append(pin.log6(data.c1Mc2).vector)
                K.append(pin.Jlog6(data.c1Mc2.inverse()) @ -J)
            else:
                r.append(data.c1Mc2.translation)
                K.append(-J)
        return np.concatenate(r), np.vstack(K)

    def constraint_jacobian_alone(self, q: Vector) -> list[Matrix]:
        """Pinocchio's own Jacobians: with neither a residual nor log6."""
        pin.computeJointJacobians(self.model, self.data, q)
        for model, data in zip(self._models, self._datas, strict=True):
            model.calc(self.model, self.data, data)
        pairs = zip(self._models, self._datas, strict=True)
        return [pin.getConstraintJacobian(self.model, self.data, model, data) for model, data in pairs]

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

    def inverse_kinematics(self, frame: int, target: Any, q0: Vector) -> Vector:
        """The closed configuration with a frame at a pose."""
        q = np.array(q0)
        for _ in range(_MOST_STEPS):
            r, K = self.closures(q)
            oMf = pin.updateFramePlacement(self.model, self.data, frame)
            J = pin.getFrameJacobian(self.model, self.data, frame, pin.LOCAL)
            away, turn = oMf.translation - target.translation, target.rotation.T @ oMf.rotation
            angle = pin.log3(turn)
            if np.abs(r).max() <= CLOSED and max(np.linalg.norm(away), np.linalg.norm(angle)) <= AT_TARGET:
                return q
            rows = np.vstack((K, oMf.rotation @ J[:3], pin.Jlog3(turn) @ J[3:]))
            v = np.linalg.lstsq(rows, -np.concatenate((r, away, angle)), rcond=None)[0]
            q = pin.integrate(self.model, q, v)
        raise NotConverged

    def dq_dq_actuated(self, q: Vector) -> Matrix:
        """The formula of the published toolbox: the pseudoinverse of the columns of K that are not actuated."""
        _, K = self.closures(q)
        D = np.zeros((self.model.nv, len(self.driven)))
        D[self.driven, np.arange(len(self.driven))] = 1.0
        D[self.free] = -np.linalg.pinv(K[:, self.free]) @ K[:, self.driven]
        return D
