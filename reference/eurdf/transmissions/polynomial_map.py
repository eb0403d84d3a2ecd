"""The positions of motors as polynomials of those of the joints."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.polynomial import chebyshev

from eurdf.json_schema import HIDDEN, LISTS, ROW, ROWS
from eurdf.kinematics.array import Matrix, Vector
from eurdf.pinocchio.arguments import checked_array


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

    def motor_positions(self, positions: Matrix) -> Matrix:
        """Positions (..., nm) of the motors at positions (..., nJ) of the joints, inside their ranges."""
        x = self._scaled(positions)
        basis = design(x.reshape(-1, x.shape[-1]), self.degree)
        return np.asarray((basis @ self.coefficients.reshape(len(self.motors), -1).T).reshape(*x.shape[:-1], -1))

    def G(self, positions: Matrix) -> Matrix:  # noqa: N802 - the field's own symbol
        """Derivative (..., nm, nJ) of the motor positions."""
        x = self._scaled(positions)
        columns = []
        for axis in range(x.shape[-1]):
            own = chebyshev.chebder(np.moveaxis(self.coefficients, 1 + axis, 0))
            own = np.concatenate((own, np.zeros((1, *own.shape[1:])))) if self.degree else 0.0 * own
            basis = design(x.reshape(-1, x.shape[-1]), self.degree)
            flat = np.moveaxis(own, 0, 1 + axis).reshape(len(self.motors), -1)
            half = 0.5 * (self.upper[axis] - self.lower[axis])
            columns.append((basis @ flat.T).reshape(*x.shape[:-1], -1) / half)
        return np.stack(columns, axis=-1)

    def _scaled(self, positions: Matrix) -> Matrix:
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


def fitted(x: Matrix, values: Matrix, degree: int) -> Matrix:
    """Coefficients (nm, degree + 1, …) of the least-squares fit of values (B, nm) at scaled positions (B, nJ)."""
    solution = np.linalg.lstsq(design(x, degree), values, rcond=None)[0]
    return np.asarray(solution.T.reshape(values.shape[1], *(degree + 1,) * x.shape[1]))
