"""The motions that keep the loops closed, ker K, of many elements at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from eurdf.kinematics.array import Indices, Matrix
from eurdf.kinematics.batch.problem import Problem
from eurdf.kinematics.rank import FLOOR, NOTHING


def numerical_ranks(values: Matrix) -> Indices:
    """`eurdf.kinematics.rank.numerical_rank` of singular values (B, k), descending, relative to the first of each."""
    B, k = values.shape
    if k == 0:
        return np.zeros(B, dtype=np.intp)
    reference = values[:, :1]
    nothing = ~(reference[:, 0] > NOTHING)
    relative = np.clip(values / np.where(reference > NOTHING, reference, 1.0), FLOOR, 1.0)
    ladder = np.concatenate((np.ones((B, 1)), relative, np.full((B, 1), FLOOR)), axis=1)
    return np.where(nothing, 0, np.argmax(ladder[:, :-1] / ladder[:, 1:], axis=1))


def free_motions(problem: Problem, K: Matrix) -> Iterator[tuple[Indices, Matrix]]:
    """Orthonormal bases of ker K, as `eurdf.kinematics.tangent_space.TangentSpaces` has them.

    Args:
        problem: The robot.
        K: (nc, nv, B), in m and rad.

    Yields:
        Indices (b,) of elements whose bases have the same number of columns, and the bases (b, nv, nv - rank).
    """
    B, nv = K.shape[2], K.shape[1]
    parts: list[tuple[Indices, Matrix, Indices]] = []  # velocities, all right singular vectors and ranks
    outside = np.ones(nv, dtype=bool)
    for group in problem.groups:
        velocities = group.stack.velocities
        if not len(velocities):
            continue
        outside[velocities] = False
        A = np.moveaxis(K[np.ix_(group.rows, velocities)] * group.factors, -1, 0)
        _, values, right = np.linalg.svd(A)
        parts.append((velocities, np.swapaxes(right, 1, 2), numerical_ranks(values)))
    ranks = np.stack([rank for _, _, rank in parts], axis=1) if parts else np.zeros((B, 0), dtype=np.intp)
    for own in np.unique(ranks, axis=0):
        which = np.flatnonzero((ranks == own).all(axis=1))
        yield which, _basis(problem, parts, own.tolist(), which, np.flatnonzero(outside))


def _basis(
    problem: Problem,
    parts: Sequence[tuple[Indices, Matrix, Indices]],
    ranks: Sequence[int],
    which: Indices,
    outside: Indices,
) -> Matrix:
    nv = problem.tree.nv
    blocks = []
    for (velocities, right, _), rank in zip(parts, ranks, strict=True):
        Z, _ = np.linalg.qr(problem.scale[velocities, None] * right[which][:, :, rank:])
        blocks.append((velocities, Z))
    blocks.append((outside, np.broadcast_to(np.eye(len(outside)), (len(which), len(outside), len(outside)))))
    basis = np.zeros((len(which), nv, sum(Z.shape[2] for _, Z in blocks)))
    column = 0
    for velocities, Z in blocks:
        basis[:, velocities, column : column + Z.shape[2]] = Z
        column += Z.shape[2]
    return basis


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
    for which, Z in free_motions(problem, K):
        y = np.linalg.pinv(Z[:, given], rcond=1.0 / fastest) @ v_given.T[which][:, :, None]
        v[:, which] = (Z @ y)[:, :, 0].T
    return v
