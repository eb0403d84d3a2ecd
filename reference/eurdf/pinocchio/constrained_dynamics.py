"""Accelerations and closure forces by Pinocchio's proximal solver.

Source: Carpentier, Budhiraja, Mansard, *Proximal and sparse resolution of constrained dynamic equations*, 2021.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from eurdf.pinocchio.constraint import has_constraint_models

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]

#: Baumgarte gains kp, 1/s², and kd, 1/s.
Gains = tuple[float, float]

# μ regularizes only the first step of the solver; after the following steps the result does not depend on it.
_MU, _MOST_STEPS = 1e-8, 50
_ACCURACY = 1e-14


class ConstrainedMotion(NamedTuple):
    """See `eurdf.kinematics.tree_kinematics.ConstrainedMotion`."""

    a: Vector
    lambdas: Vector
    bias: Vector
    r: Vector
    K: Matrix
    target: Vector


class ConstrainedDynamics:
    """The solver with its memory; see `eurdf.kinematics.tree_kinematics.ConstrainedDynamics`.

    It treats redundant rows that differ by rounding as independent rows, and needs inertia at every joint, even at one
    that the closures do not let move.
    """

    def __init__(self, model: pin.Model, constraint_models: Sequence[pin.RigidConstraintModel]) -> None:
        """Take a model without mimic joints, which the solver does not support, and its constraint models."""
        self._model = model
        self._models, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for constraint_model in constraint_models:
            self._models.append(constraint_model)
            self._datas.append(constraint_model.createData())
        self._rows = [
            (data, 3 if constraint_model.type == pin.ContactType.CONTACT_3D else 6)
            for constraint_model, data in zip(self._models, self._datas, strict=True)
        ]
        self._gains: list[Gains] = []
        self._settings = pin.ProximalSettings(_ACCURACY, _ACCURACY, _MU, _MOST_STEPS)

    def solve(self, q: Vector, v: Vector, force: Vector, gains: Sequence[Gains], data: pin.Data) -> ConstrainedMotion:
        """See `eurdf.kinematics.tree_kinematics.ConstrainedDynamics`."""
        self._set(gains)
        model, models, datas = self._model, self._models, self._datas
        pin.initConstraintDynamics(model, data, models, datas)
        a = np.array(pin.constraintDynamics(model, data, q, v, force, models, datas, self._settings))
        return ConstrainedMotion(
            a,
            -data.lambda_c,
            np.array(data.nle),
            -np.concatenate([found.contact_placement_error.vector[:count] for found, count in self._rows]),
            -pin.getConstraintsJacobian(model, data, models, datas).reshape(-1, model.nv),
            -data.primal_rhs_contact,
        )

    def _set(self, gains: Sequence[Gains]) -> None:
        if gains != self._gains:
            self._gains = list(gains)
            for constraint_model, (kp, kd) in zip(self._models, gains, strict=True):
                parameters = constraint_model.m_baumgarte_parameters
                parameters.Kp, parameters.Kd = kp, kd


def build_constrained_dynamics(robot: Robot) -> ConstrainedDynamics | None:
    """The solver for a robot; None if Pinocchio has none, for its kinds of constraint or for mimic joints."""
    model = robot.tree.model
    if not robot.constraints or len(model.mimicking_joints) or not has_constraint_models(robot.constraints):
        return None
    return ConstrainedDynamics(model, robot.constraint_models)


def stated_gains(robot: Robot) -> list[Gains]:
    """The Baumgarte gains that the constraint models have, of each constraint; zero where there are no models."""
    if not has_constraint_models(robot.constraints):
        return [(0.0, 0.0)] * len(robot.constraints)
    each = [constraint_model.m_baumgarte_parameters for constraint_model in robot.constraint_models]
    return [(parameters.Kp, parameters.Kd) for parameters in each]
