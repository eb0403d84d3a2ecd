"""The motions that keep the loops closed, ker K, of many elements at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from eurdf.kinematics.array import Indices, Matrix
from eurdf.kinematics.batch.problem import Group, Problem
from eurdf.kinematics.rank import numerical_ranks

#: If the smallest pivot of K Kᵀ is above this part of its largest diagonal entry, K has full rank beyond doubt; if not,
#: singular values decide.
SURE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Tangents:
    """Tangent spaces of some elements, all of one dimension; see `eurdf.kinematics.tangent_space.TangentSpace`.

    Attributes:
        which: The elements, by index (b,).
        basis: Z (b, nv, m) with K Z = 0 and Zᵀ Z = 1.
        inverse: K⁺ (b, nv, nc).
    """

    which: Indices
    basis: Matrix
    inverse: Matrix


class _Factors(NamedTuple):
    """The singular value decompositions of K of one group, and the ranks (B,)."""

    group: Group
    left: Matrix
    values: Matrix
    right: Matrix
    ranks: Indices


def tangents(problem: Problem, K: Matrix) -> Iterator[Tangents]:
    """The tangent spaces of all elements, for K (nc, nv, B) in m and rad.

    They are those of `eurdf.kinematics.tangent_space.TangentSpaces`, in which the numerical rank decides.
    """
    parts = []
    for group in problem.groups:
        velocities = group.stack.velocities
        if len(velocities):
            A = np.moveaxis(K[np.ix_(group.rows, velocities)] * group.factors, -1, 0)
            A = np.where(np.isfinite(A).all(axis=(1, 2), keepdims=True), A, 0.0)  # what overflows has no rank
            left, values, right = np.linalg.svd(A)
            parts.append(_Factors(group, left, values, right, numerical_ranks(values)))
    ranks = np.zeros((K.shape[2], len(parts)), dtype=np.intp)
    for index, part in enumerate(parts):
        ranks[:, index] = part.ranks
    for own in np.unique(ranks, axis=0):
        which = np.flatnonzero((ranks == own).all(axis=1))
        yield _tangents(problem, parts, own.tolist(), which)


def _tangents(problem: Problem, parts: Sequence[_Factors], ranks: Sequence[int], which: Indices) -> Tangents:
    b, nv, nc = len(which), problem.tree.nv, problem.whole.m
    outside = np.ones(nv, dtype=bool)
    blocks, inverse = [], np.zeros((b, nv, nc))
    for part, rank in zip(parts, ranks, strict=True):
        group = part.group
        outside[group.stack.velocities] = False
        right = np.swapaxes(part.right[which], 1, 2)
        Z, _ = np.linalg.qr(group.unit[:, None] * right[:, :, rank:])
        blocks.append((group.stack.velocities, Z))
        scaled = right[:, :, :rank] / part.values[which, None, :rank]
        pseudoinverse = scaled @ np.swapaxes(part.left[which][:, :, :rank], 1, 2)
        at = np.ix_(np.arange(b), group.stack.velocities, group.rows)
        inverse[at] = group.unit[:, None] * pseudoinverse * group.row_scale
    free = np.flatnonzero(outside)
    blocks.append((free, np.broadcast_to(np.eye(len(free)), (b, len(free), len(free)))))
    basis = np.zeros((b, nv, sum(Z.shape[2] for _, Z in blocks)))
    column = 0
    for velocities, Z in blocks:
        basis[:, velocities, column : column + Z.shape[2]] = Z
        column += Z.shape[2]
    return Tangents(which, basis, inverse)


def following(problem: Problem, K: Matrix, given: Indices, v_given: Matrix, fastest: float) -> Matrix:
    """The least motions (nv, B) with K v = 0 and the given velocities: v = Z (Z_g)⁺ v_g.

    Args:
        problem: The robot.
        K: (nc, nv, B).
        given: Indices (g,) in v.
        v_given: Their velocities (g, B).
        fastest: Directions in which other joints would have to move this many times faster do not count.
    """
    v = np.zeros((problem.tree.nv, K.shape[2]))
    for space in tangents(problem, K):
        Z = space.basis
        y = np.linalg.pinv(Z[:, given], rcond=1.0 / fastest) @ v_given.T[space.which][:, :, None]
        v[:, space.which] = (Z @ y)[:, :, 0].T
    return v
