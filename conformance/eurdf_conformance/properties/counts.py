"""nv, nc, rank and what follows from them, for the K of a parser: chapter Scope and terms."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.oracle import OracleRobot
from eurdf_conformance.oracle.dimensions import rank
from eurdf_conformance.properties.conditioning import scaled, selection
from eurdf_conformance.properties.mechanism import Configuration
from eurdf_conformance.properties.placement import Matrix

#: Of K and S, free of units: what is smaller is zero, but for what EU-PRO-008 allows. No example has any near it.
_RANK = 1e-5


@dataclass(frozen=True)
class Counts:
    """nv, nc, rank, mobility and the other dimensions at one configuration."""

    nv: int
    nc: int
    rank: int
    mobility: int
    redundant: int
    uncontrolled: int


def counts_of(K: Matrix, robot: OracleRobot, q: Configuration) -> Counts:
    """The counts of a constraint Jacobian.

    Args:
        K: All rows, the columns in the order of the oracle's.
        robot: The robot, for its size and its actuators.
        q: The configuration.
    """
    K, S = scaled(K, robot, q), selection(robot)
    (nc, nv), found = K.shape, rank(K, _RANK)
    return Counts(nv, nc, found, nv - found, nc - found, nv - rank(np.vstack([K, S]), _RANK))


def count_differences(expected: Counts, given: Counts, pointer: str) -> list[Difference]:
    """The counts that differ."""
    return [
        Difference(pointer, one, asdict(given)[word], f"{word}, of K at a closed configuration")
        for word, one in asdict(expected).items()
        if one != asdict(given)[word]
    ]
