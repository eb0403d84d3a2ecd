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

from eurdf.array import Indices, Matrix, Vector
from eurdf.closures.kind import ClosureKind, Contact
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Constraint
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.constraint import contacts_of, models_of
from eurdf.pinocchio.tree_dynamics import whole_matrix
from eurdf.pinocchio.tree_few import Site

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


#: Baumgarte gains kp, 1/s², and kd, 1/s.
Gains = tuple[float, float]

# μ regularizes only the first step of the solver; after the following steps the result does not depend on it. They end
# once f changes by at most _CHANGE, N and N·m, which is what Pinocchio compares with its relative accuracy: J a then
# misses its target by at most μ times as much.
_MU, _MOST_STEPS = 1e-8, 12
_CHANGE = 1e-5
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


class _Distances(NamedTuple):
    """The constraints of one kind whose rows are combinations of those that hold origins together: k of them.

    Attributes:
        kind: Evaluates them, by `ClosureKind.of_distance`.
        fixed: What it prepared.
        members: Their indices.
        rows: Their rows (k,).
        columns: Those (k, 3) of the contacts.
        positions: References to the origins p (3,) of B in A.
    """

    kind: type[ClosureKind]
    fixed: Any
    members: list[int]
    rows: Indices
    columns: Indices
    positions: list[Vector]


class ConstrainedDynamics:
    """The solver with its memory, for constraints whose rows are combinations of those of contacts.

    It treats redundant rows that differ by rounding as independent rows, and needs inertia at every joint, even at one
    that the closures do not let move. Where this is not so, it can be wrong: judge its solution.

    Attributes:
        solves: Whether it solves the equation of motion; it has only the `terms` of rows that depend on distances.
    """

    def __init__(self, model: pin.Model, constraints: Sequence[Constraint], site: Callable[[Anchor], Site]) -> None:
        """Take a model without mimic joints, which the solver does not support, and where anchors are in it."""
        self._model = model
        self._models, self._datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        self._owners: list[int] = []  # of each model its constraint
        contacts = []
        for index, constraint in enumerate(constraints):
            own = rows_of_contacts(constraint)
            for contact, found in zip(own, models_of(constraint, own, model, site), strict=True):
                contacts.append(contact)
                self._models.append(found)
                self._datas.append(found.createData())
                self._owners.append(index)
        # Pinocchio has a matrix of one column as a vector, and reads memory that is not its own for one without rows.
        self._is_plain = bool(self._owners) and model.nv > 1
        self._distances = self._find_distances(constraints, contacts)
        self.solves = not self._distances
        self._by_distance = {index for each in self._distances for index in each.members}
        # References to what the solver writes, since each attribute takes time; and the lever of what may be open.
        self._open_by = [
            (data.contact_placement_error, min(1.0, math.hypot(*contact.a) or 1.0))
            for contact, data, owner in zip(contacts, self._datas, self._owners, strict=True)
            if owner not in self._by_distance
        ]
        self._each = [
            (found, data, contact.is_frame)
            for found, data, contact in zip(self._models, self._datas, contacts, strict=True)
        ]
        self._forces = _forces_of_contacts(constraints)
        # With L the map of the forces, Lᵀ K is the Jacobian of the contacts.
        self._rows = None if self._forces is None else np.asarray(np.linalg.pinv(self._forces).T)
        self._settings = pin.ProximalSettings(0.0, _CHANGE, _MU, _MOST_STEPS)
        self._one_step = pin.ProximalSettings(0.0, _CHANGE, _MU, 1)
        self._gains: list[Gains] = []
        self._is_damped = False
        self._prepared: pin.Data | None = None
        self._data: Any = None  # where `acceleration` was last
        self._response = np.empty((0, 0))  # the f of the last response, near which the next one is
        self._size = sum(contact.rows for contact in contacts)
        self._lengths: list[Vector] = []  # the r of distances where they were last

    def _find_distances(self, constraints: Sequence[Constraint], contacts: Sequence[Contact]) -> list[_Distances]:
        of_kind: dict[type[ClosureKind], list[int]] = {}
        for index, constraint in enumerate(constraints):
            if isinstance(constraint, ClosureKind) and not constraint.contacts():
                of_kind.setdefault(type(constraint), []).append(index)
        row = np.cumsum([0, *(each.rows for each in constraints)])
        column = np.cumsum([0, *(contact.rows for contact in contacts)])
        found = []
        for kind, members in of_kind.items():
            at = [self._owners.index(index) for index in members]
            positions = [self._datas[index].c1Mc2.translation for index in at]
            fixed = kind.prepare([each for each in constraints if type(each) is kind])
            found.append(_Distances(kind, fixed, members, row[members], column[at][:, None] + np.arange(3), positions))
        return found

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
        a = self.acceleration(q, v, force, gains, data, is_own)
        J = self._jacobian(data)
        if self._forces is None or self._rows is None:
            return ConstrainedMotion(a, data.lambda_c, J, data.primal_rhs_contact)
        target = self._rows.dot(data.primal_rhs_contact)
        return ConstrainedMotion(a, self._forces.dot(data.lambda_c), self._rows.dot(J), target)

    def acceleration(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: pin.Data, is_own: bool
    ) -> Vector:
        """The a (nv,) of `solve`, as of which `is_solved`."""
        return np.array(self._run(q, v, force, gains, data, is_own, self._settings))

    def terms(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: pin.Data, is_own: bool
    ) -> tuple[Matrix, Vector]:
        """J (m, nv) and the target (m,) of `solve`, which finds no solution; M and h are then in the data."""
        self._run(q, v, force, gains, data, is_own, self._one_step)
        J, target = self._jacobian(data), data.primal_rhs_contact
        if self._rows is None:
            return J, target
        extra = self._turn_distances(-J.dot(v)) if self._distances else ()
        J, target = self._rows.dot(J), self._rows.dot(target)
        for each, (r, own) in zip(self._distances, extra, strict=True):
            target[each.rows] += own
            if self._is_damped:
                kp, kd = np.array([gains[index] for index in each.members]).T
                target[each.rows] += kp * r - kd * J[each.rows].dot(v)
        return J, target

    def _run(
        self, q: Vector, v: Vector, force: Vector, gains: list[Gains], data: pin.Data, is_own: bool, settings: Any
    ) -> Vector:
        model, models, datas = self._model, self._models, self._datas
        if gains is not self._gains and gains != self._gains:
            self._gains, self._is_damped = gains, any(map(any, gains))
            for constraint_model, owner in zip(models, self._owners, strict=True):
                parameters = constraint_model.m_baumgarte_parameters
                parameters.Kp, parameters.Kd = (0.0, 0.0) if owner in self._by_distance else gains[owner]
        if not is_own or self._prepared is not data:
            pin.initConstraintDynamics(model, data, models, datas)
            self._prepared = data if is_own else None
        self._data = data
        a: Vector = pin.constraintDynamics(model, data, q, v, force, models, datas, settings)
        return a

    def _turn_distances(self, velocities: Vector) -> list[tuple[Vector, Vector]]:
        """Make the rows of distances those of where the solver is; their r, and what r̈ has besides, of each kind."""
        found = []
        assert self._rows is not None
        for kind, fixed, _, rows, columns, positions in self._distances:
            of_rows = kind.of_distance(np.array(positions), velocities[columns], fixed)
            assert of_rows is not None
            r, gradient, extra = of_rows
            self._rows[rows[:, None], columns] = gradient
            found.append((r, extra))
        self._lengths = [r for r, _ in found]
        return found

    def is_solved(self) -> bool:
        """Whether the steps of the solver ended before their bound, where it was last."""
        return bool(self._settings.iter < _MOST_STEPS)

    def closed_to(self, position: float) -> bool:
        """Whether each row of the residual is at most ``position``, m or rad, where it was last."""
        if not all((np.abs(r) <= position).all() for r in self._lengths):
            return False
        return all(open_by.isZero(lever * position) for open_by, lever in self._open_by)

    def respond(self, forces: Matrix) -> tuple[Matrix, Matrix]:
        """The changes of a (nv, k) and of f (m, k) by generalized forces (nv, k), where `solve` was last."""
        m, given = self._size, np.zeros((self._size + len(forces), forces.shape[1]))
        given[m:] = forces
        cholesky, f = self._data.constraint_chol, self._response
        if f.shape != (m, forces.shape[1]):
            f = np.zeros((m, forces.shape[1]))
        for _ in range(_MOST_STEPS):
            before = f
            given[:m] = _MU * before
            found = cholesky.solve(given).reshape(given.shape)  # Pinocchio has one column as a vector
            a, f = found[m:], -found[:m]
            missed = (f - before).ravel()
            if not _MU * math.sqrt(missed.dot(missed)) > _RESPONSE * math.sqrt(a.ravel().dot(a.ravel())):
                break
        if missed.dot(missed) < math.inf:
            self._response = f
        return a, f if self._forces is None else self._forces.dot(f)

    def inverse_mass(self, q: Vector, data: pin.Data) -> Matrix:
        """M⁻¹ (nv, nv) at q (nq,)."""
        return whole_matrix(pin.computeMinverse(self._model, data, q))

    def closures(self, q: Vector, data: pin.Data) -> tuple[Vector, Matrix]:
        """The residual (m,) at q (nq,), and K (m, nv), which is its derivative where the closures are closed."""
        model = self._model
        pin.computeJointJacobians(model, data, q)
        parts = []
        for constraint_model, found, is_frame in self._each:
            constraint_model.calc(model, data, found)
            parts.append(pin.log6(found.c1Mc2).vector if is_frame else found.c1Mc2.translation)
        r, K = np.concatenate(parts) if parts else np.empty(0), -self._jacobian(data)
        if self._rows is None:
            return r, K
        lengths = self._turn_distances(np.zeros(len(r))) if self._distances else ()
        r, K = self._rows.dot(r), self._rows.dot(K)
        for each, (own, _) in zip(self._distances, lengths, strict=True):
            r[each.rows] = own
        return r, K

    def _jacobian(self, data: pin.Data) -> Matrix:
        if not self._owners:
            return np.empty((0, self._model.nv))
        J: Matrix = pin.getConstraintsJacobian(self._model, data, self._models, self._datas)
        return J if self._is_plain else np.asarray(J.reshape(-1, self._model.nv))


def rows_of_contacts(constraint: Constraint) -> tuple[Contact, ...]:
    """The contacts whose rows are combined to those of a constraint; nothing if there are none."""
    own = contacts_of(constraint)
    if own or not isinstance(constraint, ClosureKind) or type(constraint).of_distance is ClosureKind.of_distance:
        return own
    return (Contact(),)


def _forces_of_contacts(constraints: Sequence[Constraint]) -> Matrix | None:
    """λ (m,) of the constraints over those of their contacts; None if they are the same.

    Those of distances depend on the configuration: here, their rows are any.
    """
    parts: list[tuple[Matrix | None, int]] = [
        (constraint.forces_of_contacts() if contacts_of(constraint) else np.eye(1, 3), constraint.rows)
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
