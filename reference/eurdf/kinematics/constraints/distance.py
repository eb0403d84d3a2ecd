"""distance: the origins of A and B are as far apart as a rod is long."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.constraints.kind import Closures
from eurdf.kinematics.constraints.relative_motion import RelativeMotions
from eurdf.kinematics.constraints.vector import cross, dot, origins
from eurdf.kinematics.tree_kinematics import TreeKinematics
from eurdf.mechanism.constraint import DistanceClosure


class DistanceClosures(Closures[DistanceClosure]):
    """EU-CLO-015: r = |p| - length, m, with p = ᴬp_B.

    At p = 0, where r has no derivative, u = p/|p| is taken along x of A.
    """

    data = DistanceClosure

    def __init__(
        self, constraints: Sequence[DistanceClosure], pairs: Sequence[int], tree: TreeKinematics, velocities: Indices
    ) -> None:
        """See `Kind`."""
        super().__init__(constraints, pairs, tree, velocities)
        self._lengths = np.array([constraint.length for constraint in constraints])

    def rows(self, placements: Sequence[Any]) -> Matrix:
        """|p| - length."""
        return np.asarray(np.linalg.norm(origins(placements), axis=1) - self._lengths)[:, None]

    def rows_of_twist(self, placements: Sequence[Any]) -> Matrix:
        """[uᵀ, 0]: u is across ω × p."""
        u, _ = _direction(origins(placements))
        return np.concatenate((u, np.zeros_like(u)), axis=1)[:, None]

    def rows_of_motion(self, motions: RelativeMotions) -> Matrix:
        """U · p̈ + |u × ṗ|² / |p|."""
        u, distance = _direction(motions.position)
        across = cross(u, motions.velocity)
        turning = np.divide(dot(across, across), distance, out=np.zeros_like(distance), where=distance > 0.0)
        return np.asarray(dot(u, motions.acceleration) + turning)[:, None]

    def opening(self, aMb: Any, index: int) -> tuple[float, float]:
        """|r|."""
        return abs(float(np.linalg.norm(aMb.translation) - self._lengths[index])), 0.0


def _direction(p: Matrix) -> tuple[Matrix, Vector]:
    """U (k, 3) and |p| (k,)."""
    distance = np.linalg.norm(p, axis=1)
    u = np.tile([1.0, 0.0, 0.0], (len(p), 1))
    np.divide(p, distance[:, None], out=u, where=distance[:, None] > 0.0)
    return u, distance
