"""Vectors given as the values of joints, by their names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Vector
from eurdf.diagnostics.wording import enumerated, meant
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: The values of joints by their names: one number, or a sequence of several.
ByJoint = Mapping[str, float | Sequence[float]]

#: A vector, or the values of joints by their names.
Named = Vector | ByJoint


def configuration_of(robot: Robot, given: Named, argument: str = "q") -> Vector:
    """A configuration (nq,), as `Robot.configuration` makes it where coordinates are given by name.

    Raises:
        ValueError: It does not fit the robot, or is not finite.
    """
    if isinstance(given, Mapping):
        try:
            given = robot.configuration(given)
        except ValueError as error:
            raise ValueError(f"{argument}: {error}") from None
    return checked_array(argument, given, (robot.tree.nq,))


def velocity_of(robot: Robot, given: Named, argument: str = "v") -> Vector:
    """Velocities, accelerations or generalized forces (nv,); zero for joints that are not named.

    Raises:
        ValueError: It does not fit the robot, or is not finite.
    """
    if not isinstance(given, Mapping):
        return checked_array(argument, given, (robot.tree.nv,))
    names = robot.tree.velocity_names
    for name in given:
        if name not in names:
            raise ValueError(f"{argument}: {unknown_joint(robot, name)}")
    return vector_of(given, names, argument)


def motor_values_of(robot: Robot, given: Named, argument: str = "u") -> Vector:
    """Values (nu,) of the actuated velocities, in the order of the actuation; zero for joints that are not named.

    Raises:
        ValueError: It does not fit the robot, or is not finite.
    """
    actuation = robot.actuation
    if not isinstance(given, Mapping):
        return checked_array(argument, given, actuation.idx_v.shape)
    return vector_of(given, [name for name in actuation.joints for _ in range(robot.slots[name].nv)], argument)


def vector_of(given: Named, names: Sequence[str], argument: str) -> Vector:
    """A vector with an element for each name; zero for those that are not named.

    Args:
        given: The vector, or values by name.
        names: The names; one that occurs several times has as many values.
        argument: Name of the argument.

    Raises:
        ValueError: A name is unknown, or the numbers of values differ, or something is no finite number.
    """
    if not isinstance(given, Mapping):
        return checked_array(argument, given, (len(names),))
    vector = np.zeros(len(names))
    for name, values in given.items():
        at = [index for index, each in enumerate(names) if each == name]
        if not at:
            raise ValueError(f"{argument}: there is no '{name}' among {enumerated(names)}{meant(name, names)}")
        vector[at] = checked_array(f"{argument}['{name}']", values, (len(at),), *([()] if len(at) == 1 else []))
    return vector


def unknown_joint(robot: Robot, name: str) -> ValueError:
    """The error for a name that is not that of a joint with coordinates of its own."""
    leaders = robot.mechanism.leaders
    if name in leaders:
        return ValueError(f"joint '{name}' is a mimic joint; give its leader '{leaders[name].joint}' instead")
    if any(joint.name == name for joint in robot.mechanism.joints):
        return ValueError(f"joint '{name}' is fixed")
    return ValueError(f"the robot has no joint '{name}'{meant(name, robot.slots)}")
