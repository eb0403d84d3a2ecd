"""The tangent space of the closed configurations: the velocities that keep the loops closed, ker K."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.kinematics.finite import finite, overflow_refused
from eurdf.kinematics.independence import norm
from eurdf.kinematics.loop import LoopGroup, independent_groups
from eurdf.kinematics.rank import inverses, least_by_squares, least_by_values, norms, numerical_ranks, product
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale
from eurdf.kinematics.tolerances import CERTAIN, MANY_ALIKE, MOST_VELOCITIES_AT_ONCE

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_ALONE = np.zeros(1, dtype=np.intp)

# A K⁺ is kept while so many corrections suffice for a b, m and rad, m/s and rad/s, up to this.
_MOST_CORRECTIONS, _SMALL = 4, 1e-8


class _Block(NamedTuple):
    """The part of a tangent space in one group of loops, of b elements.

    Attributes:
        group: The group.
        free: Orthonormal basis (b, n, f) of its free motions, dimensionless.
        inverse: Pseudoinverse (b, n, m) of its block of K, dimensionless.
    """

    group: LoopGroup
    free: Matrix
    inverse: Matrix


class SpacePart(NamedTuple):
    """Tangent spaces of b elements in g groups of loops with as many rows m, velocities n and free motions f.

    Attributes:
        velocities: Indices (g, n) in v.
        rows: Their rows (g, m) of K.
        basis: Z (b, g, n, f), orthonormal.
        inverse: K⁺ (b, g, n, m).
    """

    velocities: Indices
    rows: Indices
    basis: Matrix
    inverse: Matrix

    def of(self, K: Matrix) -> Matrix:
        """The blocks (b, g, m, n) of K (b, nc, nv)."""
        return K[:, self.rows[:, :, None], self.velocities[:, None]]


class TangentSpace:
    """The null spaces of K, and its pseudoinverses; each basis is computed when first asked for.

    Arrays are those of one element where `TangentSpaces.at` found it, and have the elements first where
    `TangentSpaces.each` did.

    Attributes:
        which: The elements (b,), by index.
    """

    def __init__(self, which: Indices, blocks: Sequence[_Block], spaces: TangentSpaces, alone: bool) -> None:
        self.which = which
        self._blocks, self._spaces, self._alone = blocks, spaces, alone

    @cached_property
    def basis(self) -> Matrix:
        """Z (nv, nv - rank) with K Z = 0 and Zᵀ Z = 1."""
        if self._spaces.all_turn:
            return self.free
        found = []
        for block in self._blocks:
            scale = self._spaces.scale[block.group.velocities]
            found.append(block.free if (scale == 1.0).all() else np.linalg.qr(scale[:, None] * block.free)[0])
        return self._whole(found)

    @cached_property
    def free(self) -> Matrix:
        """Z (nv, nv - rank) with K Z = 0 that is orthonormal in units of the characteristic length."""
        scale, free = self._spaces.scale, [block.free for block in self._blocks]
        if not self._spaces.all_turn:
            free = [scale[block.group.velocities, None] * block.free for block in self._blocks]
        return self._whole(free)

    @cached_property
    def inverse(self) -> Matrix:
        """K⁺ (nv, nc): v = K⁺ b is the least-squares solution of K v = b with the least norm, dimensionless."""
        scale, rows = self._spaces.scale, self._spaces.row_scale
        inverse = np.zeros((len(self.which), len(scale), len(rows)))
        for group, _, own in self._blocks:
            inverse[:, group.velocities[:, None], group.rows] = scale[group.velocities, None] * own * rows[group.rows]
        return inverse[0] if self._alone else inverse

    def parts(self, together: bool = False) -> list[SpacePart]:
        """The space by groups of loops that are alike, without what is outside of the loops; or all of it as one."""
        scale, row_scale = self._spaces.scale, self._spaces.row_scale
        if together:
            Z, inverse = (np.reshape(each, (-1, 1, *each.shape[-2:])) for each in (self.basis, self.inverse))
            return [SpacePart(np.arange(len(scale))[None], np.arange(len(row_scale))[None], Z, inverse)]
        found = []
        for velocities, rows, free, inverse in self.alike():
            unit = scale[velocities][:, :, None]
            Z = free if (unit == 1.0).all() else np.linalg.qr(unit * free)[0]
            found.append(SpacePart(velocities, rows, Z, unit * inverse * row_scale[rows][:, None]))
        return found

    def alike(self) -> Iterator[tuple[Indices, Indices, Matrix, Matrix]]:
        """Groups of loops that are alike.

        Returns:
            Their velocities (g, n) and rows (g, m), their bases (b, g, n, f) of the free motions and their
            pseudoinverses (b, g, n, m), dimensionless.
        """
        alike: dict[tuple[int, int, int], list[_Block]] = {}
        for block in self._blocks:
            alike.setdefault((*block.free.shape[1:], len(block.group.rows)), []).append(block)
        for blocks in alike.values():
            velocities = np.array([block.group.velocities for block in blocks])
            rows = np.array([block.group.rows for block in blocks])
            free, inverse = ([getattr(block, each) for block in blocks] for each in ("free", "inverse"))
            yield velocities, rows, np.stack(free, axis=1), np.stack(inverse, axis=1)

    def free_motions(self) -> Iterator[tuple[Indices, Matrix]]:
        """Velocities and bases as in `alike`, also those of the velocities outside; a small robot is one group."""
        count = len(self._spaces.scale)
        if count <= MOST_VELOCITIES_AT_ONCE:
            free = self.free / self._spaces.scale[:, None]
            yield np.arange(count)[None], free.reshape(len(self.which), 1, count, free.shape[-1])
            return
        for velocities, _, free, _ in self.alike():
            yield velocities, free
        outside = self._spaces.outside[:, None]
        if len(outside):
            yield outside, np.ones((len(self.which), len(outside), 1, 1))

    def nearest(self, W: Matrix, v: Vector) -> Vector:
        """The v' = Z y (nv,) nearest to v in the metric W: Z (Zᵀ W Z)⁻¹ Zᵀ W v."""
        if W.ndim == 2:
            Z = self.basis
            return np.asarray(Z @ np.linalg.solve(Z.T @ W @ Z, Z.T @ (W @ v)), dtype=np.float64)
        found = np.array(v, dtype=np.float64)  # what is outside of the loops is free
        for part in self.parts():
            (Z,), own = part.basis, part.velocities
            across = (W[own][:, :, None] * Z).swapaxes(1, 2)
            found[own] = (Z @ np.linalg.solve(across @ Z, across @ v[own][:, :, None]))[:, :, 0]
        return found

    def _whole(self, bases: Sequence[Matrix]) -> Matrix:
        """Bases of the groups, and the unit motions of the velocities outside of them, as columns (nv, …)."""
        count, outside = sum(basis.shape[2] for basis in bases), self._spaces.outside
        whole = np.zeros((len(self.which), len(self._spaces.scale), count + len(outside)))
        column = 0
        for block, basis in zip(self._blocks, bases, strict=True):
            whole[:, block.group.velocities, column : column + basis.shape[2]] = basis
            column += basis.shape[2]
        whole[:, outside, np.arange(count, whole.shape[2])] = 1.0
        return whole[0] if self._alone else whole


@dataclass(frozen=True, eq=False)
class AlikeBlocks:
    """Blocks of K that have the same numbers m of rows and n of velocities.

    Attributes:
        rows: Their rows (g, m).
        velocities: Their velocities (g, n).
        weights: Factors (g, m) that make the rows dimensionless.
        unit: Units (g, n) of the velocities.
        is_whole: Whether the only block is K itself.
    """

    rows: Indices
    velocities: Indices
    weights: Matrix
    unit: Matrix
    is_whole: bool

    @classmethod
    def of_units(cls, rows: Indices, velocities: Indices, row_scale: Vector, scale: Vector) -> AlikeBlocks:
        """Take where the blocks are, and the units of all rows and velocities."""
        is_whole = (len(rows), rows.shape[1], velocities.shape[1]) == (1, len(row_scale), len(scale))
        return cls(rows, velocities, row_scale[rows], scale[velocities], is_whole)

    @cached_property
    def factors(self) -> Matrix:
        """Factors (g, m, n) that make K dimensionless."""
        with np.errstate(over="ignore", invalid="ignore"):  # lengths such as 1e200 m
            return self.weights[:, :, None] * self.unit[:, None]

    def of(self, K: Matrix) -> Matrix:
        """The blocks (…, g, m, n) of K (…, nc, nv)."""
        return K[..., None, :, :] if self.is_whole else K[..., self.rows[:, :, None], self.velocities[:, None]]


class TangentSpaces:
    """Computes tangent spaces of one robot; its structure is analysed once. Plain data, which can be pickled.

    Attributes:
        length: Characteristic length, m.
        scale: Unit (nv,) of each velocity: the characteristic length for one of a loop that only translates, else 1.
        row_scale: Factors (nc,) that make the rows of K dimensionless.
        outside: Indices of the velocities outside of all loops.
        all_turn: Whether every unit is 1: none of a velocity of a loop is a length.
        alike: Groups of loops with as many rows and velocities, and their blocks of K.
    """

    def __init__(self, robot: Robot) -> None:
        self.length = characteristic_length(robot)
        self.scale = velocity_scale(robot, self.length)
        self.row_scale = row_scale(robot, self.length)
        self.all_turn = bool((self.scale == 1.0).all())
        outside = np.ones(robot.tree.nv, dtype=bool)
        alike: dict[tuple[int, int], list[LoopGroup]] = {}  # by the numbers of their rows and velocities
        for group in independent_groups(robot):
            if len(group.velocities):
                outside[group.velocities] = False
                alike.setdefault((len(group.rows), len(group.velocities)), []).append(group)
        self.outside = np.flatnonzero(outside)
        units = self.row_scale, self.scale
        self.alike = [
            (
                groups,
                AlikeBlocks.of_units(
                    np.array([group.rows for group in groups]), np.array([group.velocities for group in groups]), *units
                ),
            )
            for groups in alike.values()
        ]

    @cached_property
    def whole(self) -> AlikeBlocks:
        """K as one block."""
        rows, velocities = np.arange(len(self.row_scale)), np.arange(len(self.scale))
        return AlikeBlocks.of_units(rows[None], velocities[None], self.row_scale, self.scale)

    @property
    def dimensionless(self) -> Matrix:
        """Factors (nc, nv) that make K dimensionless."""
        factors: Matrix = self.whole.factors[0]
        return factors

    def at(self, K: Matrix) -> TangentSpace:
        """The tangent space for the constraint Jacobian K (nc, nv).

        The rank is computed as in `eurdf.kinematics.analysis.analyze`: `numerical_rank` of the dimensionless K of each
        group of loops. At a singular configuration the space is larger than around it.

        Raises:
            NumericalOverflow: K is not finite.
        """
        blocks = self._blocks(K[None])
        finite("the constraint Jacobian", *blocks)
        (space,) = self._spaces(blocks, 1, alone=True)
        return space

    def each(self, K: Matrix) -> Iterator[TangentSpace]:
        """The tangent spaces for K (B, nc, nv): those of one dimension together. A K that is not finite has no rank."""
        blocks, ok = self._blocks(K), np.ones(len(K), dtype=bool)
        for block in blocks:
            ok &= np.isfinite(block).all(axis=(1, 2, 3))
        if not ok.all():
            blocks = [np.where(ok[:, None, None, None], block, 0.0) for block in blocks]
        return self._spaces(blocks, len(K), alone=False)

    def _blocks(self, K: Matrix) -> list[Matrix]:
        """The dimensionless blocks (B, g, m, n) of K (B, nc, nv) of the groups that are alike."""
        return [alike.of(K) * alike.factors for _, alike in self.alike]

    def _spaces(self, blocks: Sequence[Matrix], count: int, alone: bool) -> Iterator[TangentSpace]:
        """The spaces of so many K, by their ranks, from their dimensionless blocks."""
        bases: list[tuple[LoopGroup, _Decomposed]] = []
        for (groups, _), own in zip(self.alike, blocks, strict=True):
            if count == 1 and len(groups) < MANY_ALIKE:
                each_of = [decomposed(block[None]) for block in own[0]]
            else:
                parts = decomposed(own.reshape(-1, *own.shape[2:]))
                each_of = [parts.of(slice(first, None, len(groups))) for first in range(len(groups))]
            bases += zip(groups, each_of, strict=True)
        ranks = np.array([each.rank for _, each in bases], dtype=np.intp).reshape(len(bases), count).T
        for of_kind in np.unique(ranks, axis=0) if count > 1 else ranks:
            which = np.flatnonzero((ranks == of_kind).all(axis=1)) if count > 1 else _ALONE
            chosen = which if len(which) < count else slice(None)
            found = [
                _Block(group, each.right[chosen, :, rank:], each.inverse[chosen])
                for (group, each), rank in zip(bases, of_kind.tolist(), strict=True)
            ]
            yield TangentSpace(which, found, self, alone)


class _Decomposed(NamedTuple):
    """Blocks (b, m, n) of K, decomposed.

    Attributes:
        right: Orthonormal bases (b, n, n): after the first columns, as many as the rank, they span the free motions.
        inverse: Pseudoinverses (b, n, m).
        rank: (b,).
    """

    right: Matrix
    inverse: Matrix
    rank: Indices

    def of(self, which: slice) -> _Decomposed:
        """Some of them."""
        return _Decomposed(self.right[which], self.inverse[which], self.rank[which])


def decomposed(A: Matrix) -> _Decomposed:
    """Decompose blocks; the singular values decide on the rank of those that are in doubt."""
    m, n = A.shape[1:]
    if m <= n:
        squares = np.einsum("bij,bij->bi", A, A)
        total = squares.sum(axis=1)
        # The smallest singular value is at most the norm of a row.
        if (squares.min(axis=1, initial=np.inf) > CERTAIN * CERTAIN * total).all():
            Q, R = np.linalg.qr(A.swapaxes(1, 2), mode="complete")
            inverse = inverses(R[:, :m])
            # 1/|R⁻¹| bounds the smallest singular value of A from below.
            if (CERTAIN * np.sqrt(total * np.einsum("bij,bij->b", inverse, inverse)) < 1.0).all():
                return _Decomposed(Q, product(Q[:, :, :m], inverse.swapaxes(1, 2)), np.full(len(A), m))
    left, values, right = np.linalg.svd(A)
    rank = numerical_ranks(values)
    counts = np.arange(values.shape[1]) < rank[:, None]
    reciprocal = np.divide(1.0, values, out=np.zeros(values.shape), where=counts)
    right, k = right.swapaxes(1, 2), values.shape[1]
    return _Decomposed(right, product(right[:, :, :k] * reciprocal[:, None], left[:, :, :k].swapaxes(1, 2)), rank)


class LeastSolutions:
    """The v = K⁺ b of least norm, dimensionless, for one K after the other; those are near one another.

    K⁺ is kept while it serves to solve K v = b.
    """

    def __init__(self, spaces: TangentSpaces) -> None:
        self._by_group = [blocks for _, blocks in spaces.alike]
        # While the rows are independent, those of a small robot are solved all at once.
        self._blocks = [spaces.whole] if len(spaces.scale) <= MOST_VELOCITIES_AT_ONCE else self._by_group
        self._redundant: set[int] = set()  # the blocks some of whose rows depended on each other
        self._kept: Matrix | None = None  # the transpose of a K⁺

    def of(self, K: Matrix, b: Matrix, rounding: float) -> Matrix:
        """K⁺ b (k, nv), of K (nc, nv) and several b (k, nc).

        Of a small b the v is the least one to a tenth; K v - b is at most ``rounding``.

        Raises:
            NumericalOverflow: K is not finite.
        """
        kept, size = self._kept, norm(b.ravel())
        if kept is not None and size <= _SMALL:
            v, left = np.zeros((len(b), len(kept.T))), b
            for _ in range(_MOST_CORRECTIONS):
                v += left.dot(kept)
                left = b - v.dot(K.T)
                if norm(left.ravel()) <= rounding:
                    return v
        self._kept = kept = self._inverse(K).T
        return np.asarray(b.dot(kept))

    @overflow_refused("the constraint Jacobian")
    def _inverse(self, K: Matrix) -> Matrix:
        """K⁺ (nv, nc)."""
        inverse = np.zeros(K.shape[::-1])
        for index, block in enumerate(self._blocks):
            A, rows = block.of(K) * block.factors, block.weights[:, :, None] * np.eye(block.rows.shape[1])
            size = norms(A)
            if not np.isfinite(size).all():
                finite("the constraint Jacobian", A)
            if index not in self._redundant:
                x, sure = least_by_squares(A, rows, size)
                if np.count_nonzero(sure) < len(A):
                    self._redundant.add(index)
            if index in self._redundant:
                if self._blocks is not self._by_group:
                    self._blocks, self._redundant = self._by_group, set()
                    return self._inverse(K)
                x = least_by_values(A, rows)
            inverse[block.velocities[:, :, None], block.rows[:, None]] = block.unit[:, :, None] * x
        return inverse
