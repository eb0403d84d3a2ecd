"""Force and energy of the springs of a robot's joints.

Pinocchio's model has no springs. To use its algorithms on a robot with springs, add `spring_force` to the generalized
force; the functions of this package include it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from eurdf.kinematics.array import Vector
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def spring_force(robot: Robot, q: Vector) -> Vector:
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
    return robot.tree.springs.force(checked_array("q", q, (robot.tree.nq,)), robot.tree.nv)


def spring_energy(robot: Robot, q: Vector) -> float:
    """Energy that the springs store, Σ ½ k (c - rest)², J.

    Args:
        robot: The robot.
        q: Configuration (nq,).

    Raises:
        ValueError: ``q`` has a wrong shape or is not finite.
    """
    return robot.tree.springs.energy(checked_array("q", q, (robot.tree.nq,)))
