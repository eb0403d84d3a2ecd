"""Vectors given as the values of joints, by their names: for one configuration, or for many."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.diagnostics.wording import enumerated, meant
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.arguments import are_by_name, checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: The values of joints by their names: one number, or a sequence of several.
ByJoint = Mapping[str, float | Sequence[float]]

#: A vector, or the values of joints by their names.
Named = Vector | ByJoint

#: Vectors (B, n), or the values of joints by their names: for each joint those of all B elements, or one for all.
NamedRows = Matrix | Mapping[str, Any]


def configuration_of(robot: Robot, given: Named, argument: str = "q") -> Vector:
    """A configuration (nq,), as `Robot.configuration` makes it where coordinates are given by name.

    Raises:
        ValueError: It does not fit the robot, or is not finite.
    """
    if are_by_name(given):
        try:
            given = robot.configuration(given)
        except ValueError as error:
            raise ValueError(f"{argument}: {error}") from None
    return checked_array(argument, given, (robot.tree.nq,))


def configurations_of(robot: Robot, given: Any, argument: str = "q") -> Any:
    """Configurations (B, nq) where coordinates are given by name; else what is given.

    Raises:
        ValueError: They do not fit the robot, or the joints have values of different numbers of elements.
    """
    if not are_by_name(given):
        return given
    each = {name: _values_of_each(robot, name, values, argument) for name, values in given.items()}
    counts = {len(rows) for rows in each.values()} - {1}
    if len(counts) > 1:
        raise ValueError(f"{argument} has values of {' and '.join(map(str, sorted(counts)))} elements")
    count = counts.pop() if counts else 1
    every = ({name: rows[index % len(rows)] for name, rows in each.items()} for index in range(count))
    rows = [configuration_of(robot, one, f"{argument}[{index}]") for index, one in enumerate(every)]
    return np.array(rows).reshape(count, robot.tree.nq)


def _values_of_each(robot: Robot, name: str, values: Any, argument: str) -> Any:
    """The values of a joint for each element; for one alone if they are those of all."""
    try:
        depth = np.ndim(values)
    except ValueError:
        raise ValueError(f"{argument}['{name}'] has elements of different lengths") from None
    several = name == ROOT_JOINT or (name in robot.slots and len(robot.slots[name].joint.type.coordinates) > 1)
    return np.asarray(values) if depth > several else [values]


def velocity_of(robot: Robot, given: Named, argument: str = "v", others: float = 0.0) -> Vector:
    """Velocities, accelerations, generalized forces or weights (nv,); ``others`` for joints that are not named.

    Raises:
        ValueError: It does not fit the robot, or is not finite.
    """
    if not are_by_name(given):
        return checked_array(argument, given, (robot.tree.nv,))
    names = robot.tree.velocity_names
    for name in given:
        if name not in names:
            raise ValueError(f"{argument}: {unknown_joint(robot, name)}")
    return vector_of(given, names, argument, others)


def motor_values_of(robot: Robot, given: Named, argument: str = "u", others: float = 0.0) -> Vector:
    """Values (nu,) of the actuated velocities, in their order; ``others`` for joints that are not named.

    Raises:
        ValueError: It does not fit the robot, or is not finite.
    """
    actuation = robot.actuation
    if not are_by_name(given):
        return checked_array(argument, given, actuation.idx_v.shape)
    return vector_of(given, [name for name in actuation.joints for _ in range(robot.slots[name].nv)], argument, others)


def vector_of(given: Named, names: Sequence[str], argument: str, others: float = 0.0) -> Vector:
    """A vector with an element for each name.

    Args:
        given: The vector, or values by name.
        names: The names; one that occurs several times has as many values.
        argument: Name of the argument.
        others: The element of a name that is not given.

    Raises:
        ValueError: A name is unknown, or the numbers of values differ, or something is no finite number.
    """
    if not are_by_name(given):
        return checked_array(argument, given, (len(names),))
    vector = np.full(len(names), others)
    require_names(given, names, argument)
    for name, values in given.items():
        at = [index for index, each in enumerate(names) if each == name]
        vector[at] = checked_array(f"{argument}['{name}']", values, (len(at),), *([()] if len(at) == 1 else []))
    return vector


def require_names(given: Iterable[str], names: Sequence[str], argument: str) -> None:
    """Refuse names that are not among those that an argument has.

    Raises:
        ValueError: A name is another one.
    """
    for name in given:
        if name not in names:
            raise ValueError(f"{argument}: there is no '{name}' among {enumerated(names)}{meant(name, names)}")


def unknown_joint(robot: Robot, name: str) -> ValueError:
    """The error for a name that is not that of a joint with coordinates of its own."""
    leaders = robot.mechanism.leaders
    if name in leaders:
        return ValueError(f"joint '{name}' is a mimic joint; give its leader '{leaders[name].joint}' instead")
    if any(joint.name == name for joint in robot.mechanism.joints):
        return ValueError(f"joint '{name}' is fixed")
    return ValueError(f"the robot has no joint '{name}'{meant(name, robot.slots)}")
