"""Rank of K, mobility and the other dimensions: chapter Scope and terms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from eurdf_conformance.oracle.spatial import Array

#: Singular values of the unit-free K below this are rounding.
ROUNDING = 1e-9

#: Loops that are open by more are not closed; the rank is then that of the open loops.
CLOSED = 1e-6


@dataclass(frozen=True)
class Dimensions:
    """The dimensions of a mechanism at one configuration."""

    nv: int
    nc: int
    rank: int
    mobility: int
    uncontrolled: int


def dimensions(K: Array, S: Array, open_by: float, rows: Array, columns: Array) -> Dimensions:
    """The dimensions of a mechanism whose loops are open by at most `open_by`.

    Units are taken out first: a row in metres is divided by the size of the robot, a column of a joint that slides is
    multiplied by it. A loop that is left open by rounded numbers makes redundant rows independent by about as much, so
    what is no larger than that does not count.

    Args:
        K: The constraint Jacobian.
        S: The selection of the actuated velocities.
        open_by: Largest residual, by the size of the robot.
        rows: The divisor of each row.
        columns: The factor of each column.
    """
    nc, nv = K.shape
    scaled = K / rows[:, None] * columns
    least = ROUNDING + 10.0 * min(open_by, CLOSED)
    found = rank(scaled, least)
    held = rank(np.vstack([scaled, S]), least)
    return Dimensions(nv, nc, found, nv - found, nv - held)


def rank(A: Array, least: float) -> int:
    """Number of singular values above `least`, or above `least` times the largest where that is more than 1."""
    if not A.size:
        return 0
    values = np.linalg.svd(A, compute_uv=False)
    return int(np.sum(values > least * max(1.0, values[0])))
