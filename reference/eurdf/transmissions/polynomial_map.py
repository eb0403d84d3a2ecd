"""The positions of motors as polynomials of those of the joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated

import numpy as np
from numpy.polynomial import chebyshev

from eurdf.array import Matrix, Vector
from eurdf.json_schema import HIDDEN, LISTS, ROW, ROWS
from eurdf.kinematics.named import NamedRows, require_names
from eurdf.pinocchio.arguments import checked_array
from eurdf.transmissions.reachable_set import Workspace

# Points for each coefficient of the polynomials.
_POINTS_A_COEFFICIENT = 3


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class PolynomialMap:
    """Motor positions as Chebyshev polynomials of joint positions, fitted where the joints can be.

    With xⱼ the position of joint j scaled from its range to -1…1, qᵢ = Σ cᵢ[a, b, …] T_a(x₁) T_b(x₂) ….

    Attributes:
        joints: Names of the joints, nJ.
        motors: Names of the motors, nm.
        lower: Smallest positions (nJ,), rad or m.
        upper: Largest positions (nJ,).
        coefficients: cᵢ (nm, degree + 1, …), nJ times degree + 1; rad or m.
        error: Largest error (nm,) of the positions at the points tested, rad or m.
        error_of_G: Largest error (nm, nJ) of their derivative there.
    """

    joints: tuple[str, ...] = field(metadata=HIDDEN)
    motors: tuple[str, ...] = field(metadata=HIDDEN)
    lower: Annotated[Vector, ROW]
    upper: Annotated[Vector, ROW]
    coefficients: Annotated[Matrix, LISTS]
    error: Annotated[Vector, ROW]
    error_of_G: Annotated[Matrix, ROWS]  # noqa: N815 - the field's own symbol

    @property
    def degree(self) -> int:
        """Degree in each joint."""
        return int(self.coefficients.shape[-1]) - 1

    def motor_positions(self, positions: NamedRows) -> Matrix:
        """Positions (..., nm) of the motors at positions (..., nJ) of the joints, inside their ranges."""
        x = self._scaled(positions)
        basis = design(x.reshape(-1, x.shape[-1]), self.degree)
        return np.asarray((basis @ self.coefficients.reshape(len(self.motors), -1).T).reshape(*x.shape[:-1], -1))

    def G(self, positions: NamedRows) -> Matrix:  # noqa: N802 - the field's own symbol
        """Derivative (..., nm, nJ) of the motor positions."""
        x = self._scaled(positions)
        columns, basis = [], design(x.reshape(-1, x.shape[-1]), self.degree)
        for axis in range(x.shape[-1]):
            own = chebyshev.chebder(np.moveaxis(self.coefficients, 1 + axis, 0))
            own = np.concatenate((own, np.zeros((1, *own.shape[1:])))) if self.degree else 0.0 * own
            flat = np.moveaxis(own, 0, 1 + axis).reshape(len(self.motors), -1)
            half = 0.5 * (self.upper[axis] - self.lower[axis])
            columns.append((basis @ flat.T).reshape(*x.shape[:-1], -1) / half)
        return np.stack(columns, axis=-1)

    def _scaled(self, positions: NamedRows) -> Matrix:
        if isinstance(positions, Mapping):
            require_names(positions, self.joints, "positions")
            each = np.broadcast_arrays(*(positions.get(name, 0.0) for name in self.joints))
            positions = np.stack(each, axis=-1)
        given = np.asarray(positions, dtype=np.float64)
        given = checked_array("positions", given, (*given.shape[:-1], len(self.joints)))
        return scaled(given, self.lower, self.upper)

    def __repr__(self) -> str:
        return f"<PolynomialMap of degree {self.degree}: error {self.error.max():.2g}>"


def scaled(positions: Matrix, lower: Vector, upper: Vector) -> Matrix:
    """Positions (..., nJ) scaled from their ranges to -1…1."""
    return np.asarray((2.0 * positions - lower - upper) / (upper - lower))


def design(x: Matrix, degree: int) -> Matrix:
    """The products of Chebyshev polynomials (B, (degree + 1)^nJ) at scaled positions (B, nJ)."""
    basis = np.ones((len(x), 1))
    for column in x.T:
        own = chebyshev.chebvander(column, degree)
        basis = (basis[:, :, None] * own[:, None, :]).reshape(len(x), -1)
    return basis


def fitted_map(found: Workspace, degree: int) -> PolynomialMap:
    """Polynomials through the points of a workspace, tested between them.

    Args:
        found: The workspace.
        degree: Degree in each joint; lowered where the workspace has too few points.
    """
    joints, motors = found.selections
    n = len(joints)
    while degree > 1 and _POINTS_A_COEFFICIENT * (degree + 1) ** n > len(found.q):
        degree -= 1
    lower, upper = np.array([(axis[0], axis[-1]) for axis in found.axes]).T
    start = motors.read(found.first)
    at = motors.nearest(motors.read(found.q), start)
    solution = np.linalg.lstsq(design(scaled(found.positions, lower, upper), degree), at, rcond=None)[0]
    coefficients = np.asarray(solution.T.reshape(len(motors), *(degree + 1,) * n), np.float64)
    none = np.full((len(motors), n), np.nan)
    fit = PolynomialMap(joints.names, motors.names, lower, upper, coefficients, none[:, 0], none)
    where = found.positions + 0.5 * np.array([axis[1] - axis[0] for axis in found.axes])
    tested = found.moved(found.q, where)
    reached = np.isfinite(tested).all(axis=1)
    if not reached.any():
        return fit
    tested, where = tested[reached], where[reached]
    error = np.abs(fit.motor_positions(where) - motors.nearest(motors.read(tested), start)).max(axis=0)
    error_of_G = np.nanmax(np.abs(fit.G(where) - found.transmissions_at(tested).G), axis=0)
    return replace(fit, error=error, error_of_G=error_of_G)
