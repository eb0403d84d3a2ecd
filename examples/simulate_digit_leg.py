"""Simulates a leg of Digit under gravity, its motors held as by springs with dampers.

Run as ``python examples/simulate_digit_leg.py``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

import eurdf

Array = npt.NDArray[np.float64]

DURATION = 1.0  # s
STEP = 2e-3  # s

# Of each motor: hips and knee are stiff, the two of the foot move little.
STIFFNESS = np.array([2000.0, 1000.0, 2000.0, 2000.0, 300.0, 300.0])  # N·m/rad
DAMPING = np.array([60.0, 30.0, 60.0, 60.0, 1.0, 1.0])  # N·m·s/rad


class Held(NamedTuple):
    """How the leg hangs.

    Attributes:
        motion: What was simulated.
        sag: Largest deflection of each motor (nu,), rad.
        opening: How far closures come open, at most: the largest row of their residual, m or rad.
        energy: Kinetic and potential energy (n + 1,), J.
        energy_error: What the energy differs by from what the motors put into it, at most, J.
    """

    motion: eurdf.results.Simulation
    sag: Array
    opening: float
    energy: Array
    energy_error: float


def main() -> Held:
    """Let the leg hang from its torso, from rest, where it is drawn."""
    robot = eurdf.load("digit_leg")
    start = robot.configurations["assembled"]
    held_at, _ = eurdf.split_configuration(robot, start)

    def hold(t: float, q: Array, v: Array) -> Array:
        at, _ = eurdf.split_configuration(robot, q)
        rate, _ = eurdf.kinematics.split_velocity(robot, v)
        torque: Array = STIFFNESS * (held_at - at) - DAMPING * rate
        return torque

    motion = eurdf.simulate(robot, start, duration=DURATION, step=STEP, control=hold)

    return Held(
        motion,
        sag=np.abs(motion.q[:, robot.actuation.idx_q] - held_at).max(axis=0),
        opening=max(float(np.abs(eurdf.residual(robot, q)).max()) for q in motion.q),
        energy=motion.kinetic + motion.potential,
        energy_error=motion.energy_error,
    )


if __name__ == "__main__":
    result = main()
    print(f"simulated          {result.motion.t[-1]:.3f} s in {len(result.motion.t) - 1} steps")
    print(f"largest motor deflection {np.degrees(result.sag).max():.3f} degrees")
    print(f"closures open by   {result.opening:.1e} m or rad at most")
    print(f"energy             from {result.energy[0]:.4f} J to {result.energy[-1]:.4f} J")
    print(f"unexplained of it  {result.energy_error:.1e} J at most")
