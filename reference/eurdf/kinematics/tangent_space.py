"""The tangent space of the closed configurations: the velocities that keep the loops closed, ker K."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.finite import finite
from eurdf.kinematics.least_solution import CERTAIN, least_solution
from eurdf.kinematics.loop import LoopGroup, independent_groups
from eurdf.kinematics.rank import numerical_rank, numerical_ranks
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


#: From so many groups of one shape on, they are decomposed together; of fewer, each alone takes less time.
_MANY = 3


class _Block(NamedTuple):
    """The part of a tangent space in one group of loops.

    Attributes:
        velocities: Indices in v of the velocities of the group.
        rows: Its rows.
        free: Orthonormal basis (n, f) of its free motions, dimensionless.
        inverse: Pseudoinverse (n, m) of its block of K, dimensionless.
    """

    velocities: Indices
    rows: Indices
    free: Matrix
    inverse: Matrix


class TangentSpace:
    """The null space of K, and its pseudoinverse; each basis is computed when first asked for."""

    def __init__(self, blocks: Sequence[_Block], scale: Vector, row_scale: Vector, outside: Indices) -> None:
        self._blocks, self._outside = blocks, outside
        self._scale, self._row_scale = scale, row_scale

    @cached_property
    def basis(self) -> Matrix:
        """Z (nv, nv - rank) with K Z = 0 and Zᵀ Z = 1."""
        found = []
        for block in self._blocks:
            scale = self._scale[block.velocities]
            found.append(block.free if (scale == 1.0).all() else np.linalg.qr(scale[:, None] * block.free)[0])
        return self._whole(found)

    @cached_property
    def free(self) -> Matrix:
        """Z (nv, nv - rank) with K Z = 0 that is orthonormal in units of the characteristic length."""
        return self._whole([self._scale[block.velocities, None] * block.free for block in self._blocks])

    @cached_property
    def inverse(self) -> Matrix:
        """K⁺ (nv, nc): v = K⁺ b is the least-squares solution of K v = b with the least norm, dimensionless."""
        inverse = np.zeros((len(self._scale), len(self._row_scale)))
        for block in self._blocks:
            own = self._scale[block.velocities, None] * block.inverse * self._row_scale[block.rows]
            inverse[block.velocities[:, None], block.rows] = own
        return inverse

    def _whole(self, bases: Sequence[Matrix]) -> Matrix:
        """Bases of the groups, and the unit motions of the velocities outside of them, as columns (nv, …)."""
        count = sum(basis.shape[1] for basis in bases)
        whole = np.zeros((len(self._scale), count + len(self._outside)))
        column = 0
        for block, basis in zip(self._blocks, bases, strict=True):
            whole[block.velocities, column : column + basis.shape[1]] = basis
            column += basis.shape[1]
        whole[self._outside, np.arange(count, whole.shape[1])] = 1.0
        return whole


class TangentSpaces:
    """Computes tangent spaces of one robot; its structure is analysed once.

    Attributes:
        scale: Unit (nv,) of each velocity: the characteristic length for one of a loop that only translates, else 1.
        length: Characteristic length, m.
        row_scale: Factors (nc,) that make the rows of K dimensionless.
        dimensionless: Factors (nc, nv) that make K dimensionless.
    """

    def __init__(self, robot: Robot) -> None:
        self.length = characteristic_length(robot)
        self.scale = velocity_scale(robot, self.length)
        self.row_scale = row_scale(robot, self.length)
        self.dimensionless = self.row_scale[:, None] * self.scale
        groups = [group for group in independent_groups(robot) if len(group.velocities)]
        outside = np.ones(robot.tree.nv, dtype=bool)
        alike: dict[tuple[int, int], list[LoopGroup]] = {}  # by the numbers of their rows and velocities
        for group in groups:
            outside[group.velocities] = False
            alike.setdefault((len(group.rows), len(group.velocities)), []).append(group)
        self._outside = np.flatnonzero(outside)
        self._alike = [
            (groups, np.array([group.rows for group in groups]), np.array([group.velocities for group in groups]))
            for groups in alike.values()
        ]

    def least(self, K: Matrix, b: Vector) -> Vector:
        """K⁺ b (nv,), as `at` has it, but without a decomposition where the rows of K (nc, nv) are independent."""
        A = K * self.dimensionless
        norm = math.sqrt(float(np.vdot(A, A)))
        if math.isfinite(norm):
            solution = least_solution(A, self.row_scale * b, norm)
            if solution is not None:
                return self.scale * solution
        return self.at(K).inverse @ b

    def at(self, K: Matrix) -> TangentSpace:
        """The tangent space for the constraint Jacobian K (nc, nv).

        The rank is computed as in `eurdf.kinematics.analysis.analyze`: `numerical_rank` of the dimensionless K of each
        group of loops. At a singular configuration the space is larger than around it.
        """
        A = K * self.dimensionless
        finite("the constraint Jacobian", A)
        blocks: list[_Block] = []
        for groups, rows, velocities in self._alike:
            if len(groups) < _MANY:
                parts = [_part(A[group.rows[:, None], group.velocities]) for group in groups]
            else:
                parts = _parts(A[rows[:, :, None], velocities[:, None]])
            blocks += [_Block(group.velocities, group.rows, *part) for group, part in zip(groups, parts, strict=True)]
        return TangentSpace(blocks, self.scale, self.row_scale, self._outside)


_Part = tuple[Matrix, Matrix]  # free motions (n, f) and pseudoinverse (n, m) of a block of K (m, n)


def _part(A: Matrix) -> _Part:
    """Free motions and pseudoinverse of a block (m, n); the singular values decide on its rank where it is in doubt."""
    part = _of_independent_rows(A)
    if part is None:
        left, values, right = np.linalg.svd(A)
        rank = numerical_rank(values, values.max(initial=0.0))
        return right[rank:].T, (right[:rank].T / values[:rank]) @ left[:, :rank].T
    return part


def _parts(A: Matrix) -> list[_Part]:
    """The same of several blocks (g, m, n)."""
    squares = np.einsum("gij,gij->gi", A, A)
    # The smallest singular value is at most the norm of a row.
    may_be = squares.min(axis=1) > CERTAIN * CERTAIN * squares.sum(axis=1)
    found = [
        _of_independent_rows(each) if possible else None for each, possible in zip(A, may_be.tolist(), strict=True)
    ]
    doubtful = np.array([index for index, part in enumerate(found) if part is None], dtype=np.intp)
    if len(doubtful):
        left, values, right = np.linalg.svd(A[doubtful])
        ranks = numerical_ranks(values)
        for rank in set(ranks.tolist()):
            own = ranks == rank
            V, s, Ut = right[own].swapaxes(1, 2), values[own, None, :rank], left[own, :, :rank].swapaxes(1, 2)
            for index, *part in zip(doubtful[own].tolist(), V[:, :, rank:], (V[:, :, :rank] / s) @ Ut, strict=True):
                found[index] = tuple(part)
    return [part for part in found if part is not None]


def _of_independent_rows(A: Matrix) -> _Part | None:
    """The same of a block (m, n) whose rows are independent beyond doubt; None for any other."""
    m, n = A.shape
    if m > n:
        return None
    Q, R = np.linalg.qr(A.T, mode="complete")
    try:
        inverse = np.linalg.inv(R[:m])
    except np.linalg.LinAlgError:  # singular to the last digit
        return None
    # 1/|R⁻¹| bounds the smallest singular value of A from below.
    is_certain = CERTAIN * np.linalg.norm(A) * np.linalg.norm(inverse) < 1.0
    return (Q[:, m:], Q[:, :m] @ inverse.T) if is_certain else None
