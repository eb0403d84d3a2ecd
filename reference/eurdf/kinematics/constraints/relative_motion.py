"""How pairs of frames move while every joint keeps its velocity."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.constraints.vector import cross, origins


@dataclass(frozen=True, eq=False)
class RelativeMotions:
    """How frames B move against frames A while every joint keeps its velocity; k pairs.

    Attributes:
        placements: ᴬM_B, `pin.SE3`.
        twists: ξ, the twist of B against A in the axes of B, `pin.Motion`, m/s and rad/s.
        accelerations: ξ̇, `pin.Motion`, m/s² and rad/s².
    """

    placements: Sequence[Any]
    twists: Sequence[Any]
    accelerations: Sequence[Any]

    def of(self, which: Sequence[int]) -> RelativeMotions:
        """Those of some pairs, by index."""
        if len(which) == len(self.placements):
            return self
        return RelativeMotions(
            *([part[index] for index in which] for part in (self.placements, self.twists, self.accelerations))
        )

    @cached_property
    def rotation(self) -> Matrix:
        """ᴬR_B (k, 3, 3)."""
        return np.array([aMb.rotation for aMb in self.placements])

    @cached_property
    def position(self) -> Matrix:
        """Origin p of B in A (k, 3), m."""
        return origins(self.placements)

    @cached_property
    def velocity(self) -> Matrix:
        """ṗ (k, 3), m/s, in the axes of A."""
        return self._in_a(self._twist[:, :3])

    @cached_property
    def omega(self) -> Matrix:
        """Angular velocity ω of B against A (k, 3), rad/s, in the axes of A."""
        return self._in_a(self._twist[:, 3:])

    @cached_property
    def acceleration(self) -> Matrix:
        """p̈ (k, 3), m/s², in the axes of A."""
        linear, angular = self._twist[:, :3], self._twist[:, 3:]
        return self._in_a(self._rate[:, :3] + cross(angular, linear))  # ξ̇ lacks what turns with B

    @cached_property
    def alpha(self) -> Matrix:
        """ω̇ (k, 3), rad/s², in the axes of A."""
        return self._in_a(self._rate[:, 3:])

    @cached_property
    def _twist(self) -> Matrix:
        return np.array([twist.vector for twist in self.twists])

    @cached_property
    def _rate(self) -> Matrix:
        return np.array([rate.vector for rate in self.accelerations])

    def _in_a(self, vectors: Matrix) -> Matrix:
        return np.asarray((self.rotation @ vectors[:, :, None])[:, :, 0])
