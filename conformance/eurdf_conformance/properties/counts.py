"""nv, nc, rank and what follows from them, of what a reader says of K: chapter Scope and terms."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.oracle import OracleRobot
from eurdf_conformance.properties.conditioning import scaled, selection
from eurdf_conformance.properties.mechanism import Configuration

Matrix = NDArray[np.float64]

#: Of K and S, free of units: what is smaller is zero, but for what EU-PRO-008 allows. No example has any near it.
_RANK = 1e-5


@dataclass(frozen=True)
class Counts:
    """The words of dimension, at one configuration."""

    nv: int
    nc: int
    rank: int
    mobility: int
    redundant: int
    uncontrolled: int


def counts_of(K: Matrix, robot: OracleRobot, q: Configuration) -> Counts:
    """Of a constraint Jacobian.

    Args:
        K: All rows, the columns in the order of the oracle's.
        robot: The robot, for its size and its actuators.
        q: The configuration.
    """
    K, S = scaled(K, robot, q), selection(robot)
    (nc, nv), rank = K.shape, _rank(K)
    return Counts(nv, nc, rank, nv - rank, nc - rank, nv - _rank(np.vstack([K, S])))


def count_differences(expected: Counts, given: Counts, pointer: str) -> list[Difference]:
    """Where they are not the same."""
    return [
        Difference(pointer, one, asdict(given)[word], f"{word}, of K at a closed configuration")
        for word, one in asdict(expected).items()
        if one != asdict(given)[word]
    ]


def _rank(A: Matrix) -> int:
    if not A.size:
        return 0
    values = np.linalg.svd(A, compute_uv=False)
    return int(np.sum(values > _RANK * max(1.0, values[0])))
