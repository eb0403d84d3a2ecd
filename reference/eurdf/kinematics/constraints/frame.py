"""6d: B is at A, in position and orientation (EU-CLO-008)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.constraints.kind import Closures
from eurdf.kinematics.constraints.vector import cross
from eurdf.kinematics.tree_kinematics import RelativeMotions
from eurdf.mechanism.constraint import FrameClosure

# Terms of the series of the derivative of exp6: the last is below 1e-17 for rotations of up to half a turn.
_TERMS = 32


class FrameClosures(Closures[FrameClosure]):
    """r = log6(ᴬM_B), (linear, angular), m and rad."""

    data = FrameClosure

    def rows(self, placements: Sequence[Any]) -> Matrix:
        """log6(ᴬM_B)."""
        return np.array([pin.log6(aMb).vector for aMb in placements])

    def rows_of_twist(self, placements: Sequence[Any]) -> Matrix:
        """Jlog6(ᴬM_B) · Ad(ᴮM_A) = Jlog6(ᴮM_A)."""
        return np.array([pin.Jlog6(aMb.inverse()) for aMb in placements])

    def rows_of_motion(self, motions: RelativeMotions) -> Matrix:
        """J⁻¹ (ξ̇ - J̇ ṙ), with ξ = J(r) ṙ the twist of B in its own axes, and J the right Jacobian of exp6.

        J̇ vanishes where the closure is closed.
        """
        inward = np.swapaxes(motions.rotation, 1, 2)
        linear = motions.acceleration - cross(motions.omega, motions.velocity)
        drift = np.empty((len(inward), 6))
        for index, bRa in enumerate(inward):
            aMb = pin.SE3(motions.rotation[index], motions.position[index])
            twist = np.concatenate((bRa @ motions.velocity[index], bRa @ motions.omega[index]))
            acceleration = np.concatenate((bRa @ linear[index], bRa @ motions.alpha[index]))
            to_log = pin.Jlog6(aMb)
            drift[index] = to_log @ (acceleration - _bend(pin.log6(aMb), pin.Motion(to_log @ twist)))
        return drift

    def opening(self, aMb: Any, index: int) -> tuple[float, float]:
        """|p| and the angle of ᴬR_B."""
        return math.hypot(*aMb.translation), math.hypot(*pin.log3(aMb.rotation))


def _bend(r: Any, rate: Any) -> Vector:
    """J̇ ṙ (6,), with J(r) = Σ (-ad r)ⁿ / (n + 1)!, term by term: each is (-ad r) of the one before, over n + 1."""
    term, derivative, total = rate, pin.Motion.Zero(), np.zeros(6)
    for n in range(1, _TERMS + 1):
        derivative = -(rate.cross(term) + r.cross(derivative)) * (1.0 / (n + 1))
        term = -r.cross(term) * (1.0 / (n + 1))
        total += derivative.vector
        if max(np.abs(term.vector).max(), np.abs(derivative.vector).max()) < 1e-17:  # soon, where it is closed
            break
    return total
