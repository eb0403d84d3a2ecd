"""Accelerations and closure forces by Pinocchio's proximal solver.

Source: Carpentier, Budhiraja, Mansard, *Proximal and sparse resolution of constrained dynamic equations*, 2021.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.pinocchio.constraint import number_of_models
from eurdf.pinocchio.tree_dynamics import MOST_VELOCITIES_WITH_DATA, whole_matrix

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


#: Baumgarte gains kp, 1/s², and kd, 1/s.
Gains = tuple[float, float]

# μ regularizes only the first step of the solver; after the following steps the result does not depend on it.
_MU, _MOST_STEPS = 1e-8, 50
_ACCURACY = 1e-14


class ConstrainedMotion(NamedTuple):
    """A solution of M a + h = τ + Jᵀ f and J a = target, with its terms; it is valid until the solver is used again.

    The equations are those of the robot if the constraints hold and J v = 0.

    Attributes:
        a: Acceleration (nv,).
        on_a: The f (nc,): forces on the bodies A, which are -λ.
        J: Minus the derivative of the residual (nc, nv).
        target: What J a has to be (nc,).
        data: Memory with h in it.
        open_by: How far each constraint is open.
    """

    a: Vector
    on_a: Vector
    J: Matrix
    target: Vector
    data: pin.Data
    open_by: list[pin.Motion]

    @property
    def bias(self) -> Vector:
        """The h (nv,) of the equation."""
        return np.asarray(self.data.nle)

    @property
    def mass(self) -> Matrix:
        """The M (nv, nv) of the equation."""
        return whole_matrix(self.data.M)

    def closed_to(self, position: float) -> bool:
        """Whether each row of the residual is at most ``position``, m or rad."""
        return all(open_by.isZero(position) for open_by in self.open_by)


class ConstrainedDynamics:
    """The solver with its memory.

    It treats redundant rows that differ by rounding as independent rows, and needs inertia at every joint, even at one
    that the closures do not let move. Where this is not so, it can be wrong: judge its solution.
    """

    def __init__(self, model: pin.Model, constraint_models: Sequence[pin.RigidConstraintModel]) -> None:
        """Take a model without mimic joints, which the solver does not support, and its constraint models."""
        self._model = model
        self._models, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for constraint_model in constraint_models:
            self._models.append(constraint_model)
            self._datas.append(constraint_model.createData())
        # References to what the solver writes, since each attribute takes time.
        self._open_by = [data.contact_placement_error for data in self._datas]
        self._pairs = [
            (constraint_model, data, constraint_model.type == pin.ContactType.CONTACT_3D)
            for constraint_model, data in zip(self._models, self._datas, strict=True)
        ]
        self._settings = pin.ProximalSettings(_ACCURACY, _ACCURACY, _MU, _MOST_STEPS)
        self._gains: list[Gains] = []
        self._prepared: pin.Data | None = None

    def solve(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: pin.Data, is_own: bool
    ) -> ConstrainedMotion:
        """The solution at q (nq,) and v (nv,), which may be not finite.

        Args:
            q: Configuration (nq,).
            v: Velocity (nv,).
            force: Generalized force τ (nv,).
            gains: Baumgarte gains of each constraint.
            data: Memory of the whole tree.
            is_own: Whether no other solver of constrained dynamics uses this memory.
        """
        model, models, datas = self._model, self._models, self._datas
        if gains != self._gains:
            self._gains = gains
            for constraint_model, (kp, kd) in zip(models, gains, strict=True):
                parameters = constraint_model.m_baumgarte_parameters
                parameters.Kp, parameters.Kd = kp, kd
        if not is_own or self._prepared is not data:
            pin.initConstraintDynamics(model, data, models, datas)
            self._prepared = data if is_own else None
        a = np.array(pin.constraintDynamics(model, data, q, v, force, models, datas, self._settings))
        J = pin.getConstraintsJacobian(model, data, models, datas)
        if model.nv == 1:
            J = J.reshape(-1, 1)
        return ConstrainedMotion(a, data.lambda_c, J, data.primal_rhs_contact, data, self._open_by)

    def closures(self, q: Vector, data: pin.Data) -> tuple[Vector, Matrix]:
        """The residual (nc,) at q (nq,), and K (nc, nv), which is its derivative where the closures are closed."""
        model = self._model
        pin.computeJointJacobians(model, data, q)
        parts = []
        for constraint_model, found, is_point in self._pairs:
            constraint_model.calc(model, data, found)
            parts.append(found.c1Mc2.translation if is_point else pin.log6(found.c1Mc2).vector)
        J = pin.getConstraintsJacobian(model, data, self._models, self._datas)
        return np.concatenate(parts), -J.reshape(-1, model.nv)


def build_constrained_dynamics(robot: Robot) -> ConstrainedDynamics | None:
    """The solver for a robot; None if it is large, has mimic joints, or a constraint that is not one model."""
    model = robot.tree.model
    if model.nv > MOST_VELOCITIES_WITH_DATA:
        return None
    if not robot.constraints or len(model.mimicking_joints):
        return None
    if any(number_of_models(constraint) != 1 for constraint in robot.constraints):  # other rows than the model
        return None
    return ConstrainedDynamics(model, robot.constraint_models)


class StatedGains:
    """The Baumgarte gains that the constraint models of a robot have; zero where there are no models."""

    def __init__(self, robot: Robot) -> None:
        """Keep where they are, since they may change."""
        self._stated: list[tuple[str, list[Any]]] | None = None
        self._none = [(0.0, 0.0)] * len(robot.constraints)
        if all(map(number_of_models, robot.constraints)):
            models = iter(robot.constraint_models)
            self._stated = [
                (each.name, [model.m_baumgarte_parameters for model in islice(models, number_of_models(each))])
                for each in robot.constraints
            ]

    def now(self) -> list[Gains]:
        """Those of each constraint now.

        Raises:
            ValueError: The two models of a hinge have different gains.
        """
        return self._none if self._stated is None else [_common(*each) for each in self._stated]


def _common(constraint: str, stated: list[Any]) -> Gains:
    """The gains that all models of a constraint have."""
    first, *others = gains = [(parameters.Kp, parameters.Kd) for parameters in stated]
    if any(other != first for other in others):
        raise ValueError(
            f"the constraint models of the hinge '{constraint}' have different gains (Kp, Kd): "
            f"{', '.join(map(str, gains))}; set the same gains in both"
        )
    return first
