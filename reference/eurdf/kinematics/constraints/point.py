"""3d: the origin of B is at the origin of A (EU-CLO-009)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.constraints.kind import Closures
from eurdf.kinematics.constraints.relative_motion import RelativeMotions
from eurdf.kinematics.constraints.vector import origins, velocity_of_origin
from eurdf.mechanism.constraint import PointClosure


class PointClosures(Closures[PointClosure]):
    """r = ᴬp_B, m."""

    data = PointClosure

    def rows(self, placements: Sequence[Any]) -> Matrix:
        """P."""
        return origins(placements)

    def rows_of_twist(self, placements: Sequence[Any]) -> Matrix:
        """[1, -skew(p)]."""
        return velocity_of_origin(origins(placements))

    def rows_of_motion(self, motions: RelativeMotions) -> Matrix:
        """p̈."""
        return motions.acceleration

    def opening(self, aMb: Any, index: int) -> tuple[float, float]:
        """|p|; the angle is free."""
        return math.hypot(*aMb.translation), 0.0
