"""Accelerations and closure forces by Pinocchio's proximal solver.

Source: Carpentier, Budhiraja, Mansard, *Proximal and sparse resolution of constrained dynamic equations*, 2021.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from eurdf.array import Matrix, Vector
from eurdf.closures.kind import ClosureKind
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Constraint
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.constraint import contacts_of, models_of
from eurdf.pinocchio.tree_few import Site

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


#: Baumgarte gains kp, 1/s², and kd, 1/s.
Gains = tuple[float, float]

# μ regularizes only the first step of the solver; after the following steps the result does not depend on it.
_MU, _MOST_STEPS = 1e-8, 50
_ACCURACY = 1e-14
# Of a response, which is multiplied by forces that a solution is short of.
_RESPONSE = 1e-12


class ConstrainedMotion(NamedTuple):
    """A solution of M a + h = τ + Jᵀ f and J a = target, with its terms; it is valid until the solver is used again.

    The equations are those of the constraints if these hold and J v = 0.

    Attributes:
        a: Acceleration (nv,).
        on_a: The f (m,): forces on the bodies A, which are -λ.
        J: Minus the derivative of the residual (m, nv).
        target: What J a has to be (m,).
    """

    a: Vector
    on_a: Vector
    J: Matrix
    target: Vector


class ConstrainedDynamics:
    """The solver with its memory, for constraints that Pinocchio has models for.

    It treats redundant rows that differ by rounding as independent rows, and needs inertia at every joint, even at one
    that the closures do not let move. Where this is not so, it can be wrong: judge its solution.
    """

    def __init__(self, model: pin.Model, constraints: Sequence[Constraint], site: Callable[[Anchor], Site]) -> None:
        """Take a model without mimic joints, which the solver does not support, and where anchors are in it."""
        self._model = model
        self._models, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        self._owners: list[int] = []  # of each model its constraint
        contacts = []
        for index, constraint in enumerate(constraints):
            for contact, found in zip(contacts_of(constraint), models_of(constraint, model, site), strict=True):
                contacts.append(contact)
                self._models.append(found)
                self._datas.append(found.createData())
                self._owners.append(index)
        # Pinocchio has a matrix of one column as a vector, and reads memory that is not its own for one without rows.
        self._is_plain = bool(self._owners) and model.nv > 1
        # References to what the solver writes, since each attribute takes time; and the lever of what may be open.
        self._open_by = [
            (data.contact_placement_error, min(1.0, math.hypot(*contact.a) or 1.0))
            for contact, data in zip(contacts, self._datas, strict=True)
        ]
        self._each = [
            (found, data, contact.is_frame)
            for found, data, contact in zip(self._models, self._datas, contacts, strict=True)
        ]
        self._forces = _forces_of_contacts(constraints)
        # With L the map of the forces, Lᵀ K is the Jacobian of the contacts.
        self._rows = None if self._forces is None else np.asarray(np.linalg.pinv(self._forces).T)
        self._settings = pin.ProximalSettings(_ACCURACY, _ACCURACY, _MU, _MOST_STEPS)
        self._gains: list[Gains] = []
        self._prepared: pin.Data | None = None
        self._last: tuple[Matrix, Any] = np.empty((0, 0)), None

    def solve(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: pin.Data, is_own: bool
    ) -> ConstrainedMotion:
        """The solution at q (nq,) and v (nv,), which may be not finite.

        Args:
            q: Configuration (nq,).
            v: Velocity (nv,).
            force: Generalized force τ (nv,).
            gains: Baumgarte gains of each constraint.
            data: Memory of the whole model.
            is_own: Whether no other solver of constrained dynamics uses this memory.
        """
        model, models, datas = self._model, self._models, self._datas
        if gains != self._gains:
            self._gains = gains
            for constraint_model, owner in zip(models, self._owners, strict=True):
                parameters = constraint_model.m_baumgarte_parameters
                parameters.Kp, parameters.Kd = gains[owner]
        if not is_own or self._prepared is not data:
            pin.initConstraintDynamics(model, data, models, datas)
            self._prepared = data if is_own else None
        a = np.array(pin.constraintDynamics(model, data, q, v, force, models, datas, self._settings))
        J = pin.getConstraintsJacobian(model, data, models, datas) if self._is_plain else self._jacobian(data)
        self._last = J, data
        if self._forces is None or self._rows is None:
            return ConstrainedMotion(a, data.lambda_c, J, data.primal_rhs_contact)
        target = self._rows.dot(data.primal_rhs_contact)
        return ConstrainedMotion(a, self._forces.dot(data.lambda_c), self._rows.dot(J), target)

    def closed_to(self, position: float) -> bool:
        """Whether each row of the residual is at most ``position``, m or rad, where `solve` was last."""
        return all(open_by.isZero(lever * position) for open_by, lever in self._open_by)

    def respond(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """The changes of a (nv, k) and of f (m, k) by generalized forces (nv, k), where `solve` was last."""
        J, data = self._last
        m, given = len(J), np.zeros((len(J) + len(forces), forces.shape[1]))
        given[m:] = forces
        cholesky, f = data.constraint_chol, given[:m].copy()
        for _ in range(_MOST_STEPS):
            before = f
            given[:m] = _MU * before
            found = cholesky.solve(given).reshape(given.shape)  # Pinocchio has one column as a vector
            a, f = found[m:], -found[:m]
            missed = (f - before).ravel()
            if not _MU * math.sqrt(missed.dot(missed)) > _RESPONSE * math.sqrt(a.ravel().dot(a.ravel())):
                break
        return a, f if self._forces is None else self._forces.dot(f)

    def closures(self, q: Vector, data: pin.Data) -> tuple[Vector, Matrix]:
        """The residual (m,) at q (nq,), and K (m, nv), which is its derivative where the closures are closed."""
        model = self._model
        pin.computeJointJacobians(model, data, q)
        parts = []
        for constraint_model, found, is_frame in self._each:
            constraint_model.calc(model, data, found)
            parts.append(pin.log6(found.c1Mc2).vector if is_frame else found.c1Mc2.translation)
        r, K = np.concatenate(parts) if parts else np.empty(0), -self._jacobian(data)
        return (r, K) if self._rows is None else (self._rows.dot(r), self._rows.dot(K))

    def _jacobian(self, data: pin.Data) -> Matrix:
        if not self._owners:
            return np.empty((0, self._model.nv))
        J = pin.getConstraintsJacobian(self._model, data, self._models, self._datas)
        return np.asarray(J.reshape(-1, self._model.nv))


def _forces_of_contacts(constraints: Sequence[Constraint]) -> Matrix | None:
    """λ (m,) of the constraints over those of their contacts; None if they are the same."""
    parts: list[tuple[Matrix | None, int]] = [
        (constraint.forces_of_contacts(), constraint.rows)
        for constraint in constraints
        if isinstance(constraint, ClosureKind)
    ]
    if all(own is None for own, _ in parts):
        return None
    blocks = [np.eye(rows) if own is None else own for own, rows in parts]
    L = np.zeros(tuple(np.sum([block.shape for block in blocks], axis=0)))
    row = column = 0
    for block in blocks:
        L[row : row + block.shape[0], column : column + block.shape[1]] = block
        row, column = row + block.shape[0], column + block.shape[1]
    return L


class StatedGains:
    """The Baumgarte gains that the constraint models of a robot have; zero where there are no models."""

    def __init__(self, robot: Robot) -> None:
        """Keep where they are, since they may change."""
        self._stated: list[tuple[str, Any, Sequence[Any]]] | None = None
        self._none = [(0.0, 0.0)] * len(robot.constraints)
        numbers = [len(contacts_of(each)) for each in robot.constraints]
        if all(numbers):
            models = (model.m_baumgarte_parameters for model in robot.constraint_models)
            self._stated = [
                (each.name, next(models), list(islice(models, number - 1)))
                for each, number in zip(robot.constraints, numbers, strict=True)
            ]

    def now(self) -> list[Gains]:
        """Those of each constraint now.

        Raises:
            ValueError: The two models of a hinge have different gains.
        """
        if self._stated is None:
            return self._none
        return [
            _common(name, first, *others) if others else (first.Kp, first.Kd) for name, first, others in self._stated
        ]

    def given(self, gains: ArrayLike | None) -> list[Gains]:
        """The given kp and kd for each constraint; those of `now` if they are None.

        Raises:
            ValueError: They are not two finite numbers.
        """
        if gains is None:
            return self.now()
        kp, kd = checked_array("gains", gains, (2,)).tolist()
        return [(kp, kd)] * len(self._none)


def _common(constraint: str, *stated: Any) -> Gains:
    """The gains that all models of a constraint have."""
    first, *others = gains = [(parameters.Kp, parameters.Kd) for parameters in stated]
    if any(other != first for other in others):
        raise ValueError(
            f"the constraint models of the hinge '{constraint}' have different gains (Kp, Kd): "
            f"{', '.join(map(str, gains))}; set the same gains in both"
        )
    return first
