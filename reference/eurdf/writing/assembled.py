"""The description of a robot with a closed configuration written into it, such as ``assembled``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from eurdf.diagnostics import Diagnostics
from eurdf.kinematics.array import Vector
from eurdf.kinematics.residual import residual
from eurdf.linking.description import Described
from eurdf.mechanism.mechanism import ROOT_JOINT, root_joint
from eurdf.pinocchio.robot import Robot

NAME = "assembled"

#: Largest row of the residual, m or rad, at which a configuration written to a file counts as closed in full.
CLOSED_IN_FULL = 1e-12

#: Two configurations whose entries differ by no more are the same.
_SAME = 1e-12

#: Decimals, of m or rad, beyond which a coordinate is noise.
_DECIMALS = 15


def is_stated(robot: Robot, q: Vector, name: str = NAME) -> bool:
    """Whether a named configuration of a robot is this one, to 1e-12 in each entry of q (nq,)."""
    stated = robot.configurations.get(name)
    return stated is not None and bool(np.abs(stated - q).max(initial=0.0) <= _SAME)


def with_closed_configuration(
    description: Described, robot: Robot, q: Vector, name: str = NAME
) -> tuple[str, Diagnostics]:
    """The text of a description in which a named configuration is q.

    Joints at their neutral are left out, unless the file states them already. Numbers are rounded to 15 decimals where
    the loops stay as closed.

    Args:
        description: Of version 2.
        robot: The robot built from it, with its own root.
        q: Configuration (nq,).
        name: Name of the configuration; an existing one is replaced.

    Returns:
        The text, and its diagnostics, such as a coordinate beyond its limits.

    Raises:
        NotEditable: The file has a form in which the configuration cannot be changed alone.
    """
    # Only now: `eurdf check` uses other functions of this module.
    from eurdf.linking.rereading import reread
    from eurdf.writing.edit_configuration import with_configuration

    document = description.extension.document
    exact = robot.coordinates(q)
    enough = max(CLOSED_IN_FULL, _largest_row(robot, q))
    rounded = {joint: tuple(round(value, _DECIMALS) for value in values) for joint, values in exact.items()}
    text, diagnostics = "", Diagnostics()
    for coordinates in (rounded, exact):
        text = with_configuration(document, name, _to_state(description, robot, coordinates, name))
        mechanism, diagnostics = reread(text, description.urdf, document.source.file)
        if mechanism is None:
            break
        back = robot.configuration(mechanism.configurations[name])
        if _largest_row(robot, back) <= enough:
            break
    return text, diagnostics


def _to_state(
    description: Described, robot: Robot, coordinates: Mapping[str, Sequence[float]], configuration: str
) -> dict[str, Sequence[float]]:
    """The coordinates of the joints that a file has to state."""
    entries = {entry.name: entry.joints for entry in description.extension.configurations}
    stated = entries.get(configuration, {})
    neutral = {joint.name: joint.type.neutral for joint in robot.mechanism.joints}
    neutral[ROOT_JOINT] = root_joint("").type.neutral
    return {name: values for name, values in coordinates.items() if name in stated or tuple(values) != neutral[name]}


def _largest_row(robot: Robot, q: Vector) -> float:
    return float(np.abs(residual(robot, q)).max(initial=0.0))
