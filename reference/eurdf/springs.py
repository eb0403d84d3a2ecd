"""Springs of joints, which Pinocchio's model does not have.

To use Pinocchio's algorithms on a robot with springs, add `spring_force` to the generalized force; the functions of
this package include it.
"""

from __future__ import annotations

from eurdf.kinematics import springs
from eurdf.loading import of_any_robot as _of_any_robot

spring_energy = _of_any_robot(springs.spring_energy)
spring_force = _of_any_robot(springs.spring_force)
