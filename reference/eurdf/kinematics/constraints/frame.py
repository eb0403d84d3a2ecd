"""6d: B is at A, in position and orientation (EU-CLO-008)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from pinocchio import Motion

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.constraints.kind import Closures
from eurdf.kinematics.constraints.relative_motion import RelativeMotions
from eurdf.mechanism.constraint import FrameClosure
from eurdf.pinocchio.logarithm import log3, log6, log6_derivative

# Terms of the series of the derivative of exp6: the last is below 1e-17 for rotations of up to half a turn.
_TERMS = 32


class FrameClosures(Closures[FrameClosure]):
    """r = log6(ᴬM_B), (linear, angular), m and rad."""

    data = FrameClosure

    def rows(self, placements: Sequence[Any]) -> Matrix:
        """log6(ᴬM_B)."""
        return log6(placements)

    def rows_of_twist(self, placements: Sequence[Any]) -> Matrix:
        """Jlog6(ᴬM_B) · Ad(ᴮM_A) = Jlog6(ᴮM_A)."""
        return log6_derivative([aMb.inverse() for aMb in placements])

    def rows_of_motion(self, motions: RelativeMotions) -> Matrix:
        """J⁻¹ (ξ̇ - J̇ ṙ), with ξ = J(r) ṙ and J the right Jacobian of exp6.

        J̇ vanishes where the closure is closed.
        """
        drift = np.empty((len(motions.placements), 6))
        logarithms, derivatives = log6(motions.placements), log6_derivative(motions.placements)
        each = zip(logarithms, derivatives, motions.twists, motions.accelerations, strict=True)
        for index, (r, to_log, twist, acceleration) in enumerate(each):
            bend = _bend(Motion(r), Motion(to_log @ twist.vector))
            drift[index] = to_log @ (acceleration.vector - bend)
        return drift

    def opening(self, aMb: Any, index: int) -> tuple[float, float]:
        """|p| and the angle of ᴬR_B."""
        return math.hypot(*aMb.translation), math.hypot(*log3(aMb.rotation))


def _bend(r: Any, rate: Any) -> Vector:
    """J̇ ṙ (6,), with J(r) = Σ (-ad r)ⁿ / (n + 1)!, term by term: each is (-ad r) of the one before, over n + 1."""
    term, derivative, total = rate, Motion.Zero(), np.zeros(6)
    for n in range(1, _TERMS + 1):
        derivative = -(rate.cross(term) + r.cross(derivative)) * (1.0 / (n + 1))
        term = -r.cross(term) * (1.0 / (n + 1))
        total += derivative.vector
        if max(np.abs(term.vector).max(), np.abs(derivative.vector).max()) < 1e-17:  # soon, where it is closed
            break
    return total
