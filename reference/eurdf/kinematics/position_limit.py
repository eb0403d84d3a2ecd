"""The position limits that an assembly can be asked to keep."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from eurdf.kinematics.array import Indices, Vector


@dataclass(frozen=True, slots=True, eq=False)
class PositionLimits:
    """Limits of the coordinates that are plain angles or lengths, by the velocity that drives them.

    The coordinates of quaternions, and of cosine and sine, have none; neither has a joint that mimics another.

    Attributes:
        coordinates: Index (nv,) in q of the coordinate that each velocity drives; 0 where there is no such one.
        lower: Lower limits (nv,), rad or m; -inf where there is none.
        upper: Upper limits (nv,); inf where there is none.
    """

    coordinates: Indices
    lower: Vector
    upper: Vector

    def clip(self, q: Vector, velocities: Indices) -> Vector:
        """The configuration with the coordinates that the given velocities drive brought into their limits."""
        within = np.array(q)
        bounded = velocities[np.isfinite(self.lower[velocities]) | np.isfinite(self.upper[velocities])]
        coordinates = self.coordinates[bounded]
        within[coordinates] = np.clip(q[coordinates], self.lower[bounded], self.upper[bounded])
        return within

    def room(self, q: Vector, velocities: Indices) -> tuple[Vector, Vector]:
        """How far each coordinate may go down (not above 0) and up (not below 0) from q, by velocity."""
        at = q[self.coordinates[velocities]]
        return np.minimum(self.lower[velocities] - at, 0.0), np.maximum(self.upper[velocities] - at, 0.0)


def position_limits(model: Any) -> PositionLimits:
    """Position limits of a model."""
    coordinates = np.zeros(model.nv, dtype=np.intp)
    lower, upper = np.full(model.nv, -np.inf), np.full(model.nv, np.inf)
    for joint in model.joints[1:]:
        if joint.nv == 0 or joint.nq != joint.nv:
            continue
        v, q = slice(joint.idx_v, joint.idx_v + joint.nv), slice(joint.idx_q, joint.idx_q + joint.nq)
        coordinates[v] = np.arange(q.start, q.stop)
        lower[v], upper[v] = model.lowerPositionLimit[q], model.upperPositionLimit[q]
    return PositionLimits(coordinates, lower, upper)
