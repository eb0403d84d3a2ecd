"""Force and energy of the springs of a robot's joints; the public names are those of `eurdf.springs`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eurdf.kinematics.array import Vector
from eurdf.kinematics.named import Named, configuration_of

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def spring_force(robot: Robot, q: Named) -> Vector:
    """Generalized force of the springs (EU-JNT-035).

    A spring with the stiffness k on a coordinate c has the force -k (c - rest). That of a mimic joint acts on its
    leader, multiplied by the multiplier.

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Returns:
        The force (nv,), N·m and N; zero where there is no spring.

    Raises:
        ValueError: ``q`` has a wrong shape or is not finite.
    """
    return robot.tree.springs.force(configuration_of(robot, q), robot.tree.nv)


def spring_energy(robot: Robot, q: Named) -> float:
    """Energy that the springs store, Σ ½ k (c - rest)², J.

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Raises:
        ValueError: ``q`` has a wrong shape or is not finite.
    """
    return robot.tree.springs.energy(configuration_of(robot, q))
