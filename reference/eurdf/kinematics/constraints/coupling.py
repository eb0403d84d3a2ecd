"""coupling: a linear relation of joint coordinates."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from eurdf.kinematics.array import Indices, Matrix
from eurdf.kinematics.constraints.kind import Kind, State
from eurdf.kinematics.constraints.relative_motion import RelativeMotions
from eurdf.kinematics.tree_kinematics import TreeKinematics
from eurdf.mechanism.constraint import Coupling


class Couplings(Kind[Coupling]):
    """EU-CPL-005: r = Σ cᵢ qᵢ - offset, in the unit of cᵢ qᵢ."""

    data = Coupling

    def __init__(
        self, constraints: Sequence[Coupling], pairs: Sequence[int], tree: TreeKinematics, velocities: Indices
    ) -> None:
        """See `Kind`."""
        k = len(constraints)
        self._offsets = np.array([constraint.offset for constraint in constraints])
        entries: list[tuple[int, int, float]] = []
        self._K = np.zeros((k, len(velocities)))
        self._largest = np.zeros(k)
        self._translates = np.zeros(k, dtype=bool)
        column = {velocity: index for index, velocity in enumerate(velocities.tolist())}
        for row, constraint in enumerate(constraints):
            for name, coefficient in constraint.coefficients:
                coordinate = tree.coordinate(name)
                entries.append((row, coordinate.idx_q, coefficient))
                if coordinate.idx_v in column:
                    self._K[row, column[coordinate.idx_v]] += coefficient
                if abs(coefficient) > self._largest[row]:
                    self._largest[row], self._translates[row] = abs(coefficient), coordinate.translates
        rows, coordinates, coefficients = zip(*entries, strict=True)
        self._rows, self._coordinates = np.array(rows, dtype=np.intp), np.array(coordinates, dtype=np.intp)
        self._coefficients = np.array(coefficients)

    def residual(self, at: State) -> Matrix:
        """Σ cᵢ qᵢ - offset."""
        sums = np.bincount(self._rows, self._coefficients * at.q[self._coordinates], len(self._offsets))
        return np.asarray(sums - self._offsets)[:, None]

    def jacobian(self, at: State) -> Matrix:
        """The coefficients, in the columns of their joints."""
        return np.array(self._K)

    def drift(self, motions: RelativeMotions) -> Matrix:
        """0."""
        return np.zeros((len(self._K), 1))

    def scale(self, length: float) -> Matrix:
        """1/max |cᵢ|, and 1/length where the joint with the largest cᵢ translates."""
        return np.asarray(np.where(self._translates, 1.0 / length, 1.0) / self._largest)[:, None]

    def openings(self, at: State) -> list[tuple[float, float]]:
        """|r| / max |cᵢ|: what the joint with the largest cᵢ would have to move to close it."""
        amounts = np.abs(self.residual(at)[:, 0]) / self._largest
        return [
            (amount, 0.0) if translates else (0.0, amount)
            for amount, translates in zip(amounts.tolist(), self._translates.tolist(), strict=True)
        ]
