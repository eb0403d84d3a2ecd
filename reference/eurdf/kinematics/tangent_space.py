"""The tangent space of the closed configurations: the velocities that keep the loops closed, ker K."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.finite import finite
from eurdf.kinematics.loop import independent_groups
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class TangentSpace:
    """The null space of K, and its pseudoinverse.

    Attributes:
        basis: Z (nv, nv - rank) with K Z = 0 and Zᵀ Z = 1.
        inverse: K⁺ (nv, nc): v = K⁺ b is the least-squares solution of K v = b with the least norm, in units of the
            characteristic length.
    """

    basis: Matrix
    inverse: Matrix


class TangentSpaces:
    """Computes tangent spaces of one robot; its structure is analysed once.

    Attributes:
        scale: Unit (nv,) of each velocity: the characteristic length for one of a loop that only translates, else 1.
        length: Characteristic length, m.
        dimensionless: Factors (nc, nv) that make K dimensionless.
    """

    def __init__(self, robot: Robot) -> None:
        self.length = characteristic_length(robot)
        self.scale = velocity_scale(robot, self.length)
        self._row_scale = row_scale(robot, self.length)
        self.dimensionless = self._row_scale[:, None] * self.scale
        self._groups = independent_groups(robot)

    def at(self, K: Matrix) -> TangentSpace:
        """The tangent space for the constraint Jacobian K (nc, nv).

        The rank is computed as in `eurdf.kinematics.analysis.analyze`: `numerical_rank` of the dimensionless K of each
        group of loops. At a singular configuration the space is larger than around it.
        """
        nc, nv = K.shape
        blocks, inverse = [], np.zeros((nv, nc))
        outside = np.ones(nv, dtype=bool)
        for group in self._groups:
            rows, velocities = group.rows, group.velocities
            if not len(velocities):
                continue
            outside[velocities] = False
            scale = self.scale[velocities]
            A = self._row_scale[rows, None] * K[np.ix_(rows, velocities)] * scale
            finite("the constraint Jacobian", A)
            left, values, right = np.linalg.svd(A)
            rank = numerical_rank(values, values.max(initial=0.0))
            Z, _ = np.linalg.qr(scale[:, None] * right[rank:].T)
            blocks.append((velocities, Z))
            pseudoinverse = (right[:rank].T / values[:rank]) @ left[:, :rank].T
            inverse[np.ix_(velocities, rows)] = scale[:, None] * pseudoinverse * self._row_scale[rows]
        blocks.append((np.flatnonzero(outside), np.eye(int(outside.sum()))))
        basis = np.zeros((nv, sum(Z.shape[1] for _, Z in blocks)))
        column = 0
        for velocities, Z in blocks:
            basis[velocities, column : column + Z.shape[1]] = Z
            column += Z.shape[1]
        return TangentSpace(basis, inverse)
