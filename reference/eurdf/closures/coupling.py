"""coupling: a linear relation of joint coordinates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.mechanism.constraint import Coupling


class Coordinate(NamedTuple):
    """The coordinate of a joint that has one.

    Attributes:
        joint: Index of the joint that has it as its own.
        idx_q: Its index in q.
        idx_v: Index of its velocity in v.
        translates: Whether it is a length, m; else it is an angle, rad.
    """

    joint: int
    idx_q: int
    idx_v: int
    translates: bool


class Couplings:
    """EU-CPL-005: k couplings: r = Σ cᵢ qᵢ - offset, each in the unit of its cᵢ qᵢ.

    Attributes:
        K: The derivative (k, n) of r by the velocities, which is constant: r̈ is 0 while every joint keeps its velocity.
    """

    def __init__(
        self, couplings: Sequence[Coupling], coordinate: Callable[[str], Coordinate], velocities: Indices
    ) -> None:
        """Prepare what does not depend on the configuration.

        Args:
            couplings: The couplings, k.
            coordinate: Where the coordinate of a joint is, by its name.
            velocities: Indices (n,) in v of the columns of K.
        """
        at = {name: coordinate(name) for coupling in couplings for name in coupling.joints}
        place = {name: index for index, name in enumerate(at)}
        C = np.zeros((len(couplings), len(at)))
        for row, coupling in enumerate(couplings):
            for name, coefficient in coupling.coefficients:
                C[row, place[name]] += coefficient
        self._C, self._offsets = C, np.array([coupling.offset for coupling in couplings])
        self._coordinates = np.array([each.idx_q for each in at.values()], dtype=np.intp)
        idx_v = np.array([each.idx_v for each in at.values()], dtype=np.intp)
        self.K = C @ np.equal(idx_v[:, None], velocities)
        largest = np.abs(C).argmax(axis=1)
        self._largest = np.abs(C).max(axis=1)
        self._translates = np.array([each.translates for each in at.values()])[largest]

    def residual(self, q: Matrix) -> Matrix:
        """Σ cᵢ qᵢ - offset (EU-CPL-005), (B, k), at q (B, nq)."""
        return np.asarray(q[:, self._coordinates] @ self._C.T - self._offsets)

    def scale(self, length: float) -> Vector:
        """Factors (k,) that make the rows dimensionless: 1/max |cᵢ|, and over the length if that joint translates."""
        return np.asarray(np.where(self._translates, 1.0 / length, 1.0) / self._largest)

    def opening(self, q: Matrix) -> tuple[Matrix, Matrix]:
        """|r| / max |cᵢ|, (B, k), m and rad: what the joint with the largest cᵢ would have to move to close it."""
        amounts = np.abs(self.residual(q)) / self._largest
        return np.where(self._translates, amounts, 0.0), np.where(self._translates, 0.0, amounts)
