"""A closed configuration written into the description of a robot, such as ``assembled``, and saved to its file."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from eurdf.array import Vector
from eurdf.diagnostics import Diagnostics
from eurdf.errors import EurdfError
from eurdf.kinematics.residual import residual
from eurdf.linking.link import reread
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import ROOT_JOINT, root_joint
from eurdf.pinocchio.configuration import configuration_vector
from eurdf.pinocchio.robot import Robot
from eurdf.reading.robot_source import RobotSource
from eurdf.reading.source import BOM
from eurdf.writing.atomic_file import write_atomically
from eurdf.writing.edit_configuration import with_configuration
from eurdf.writing.yaml_edits import NotEditable

NAME = "assembled"

#: Largest row of the residual, m or rad, at which a configuration written to a file counts as closed in full.
CLOSED_IN_FULL = 1e-12

#: Two configurations whose entries differ by no more are the same.
_SAME = 1e-12

#: Decimals, of m or rad, beyond which a coordinate is noise.
DECIMALS = 15


class CannotSave(EurdfError, ValueError):  # noqa: N818 - shown to the user as it is
    """A configuration cannot be saved; the text says why."""


class ConfigurationExists(CannotSave):
    """There is a different configuration of this name, which may be replaced if the user agrees."""


def file_to_save_to(path: RobotSource, read: ReadRobot) -> str:
    """The file of a description that configurations can be saved to; `CannotSave` if there is none."""
    source = read.description.document.source
    if not source.is_file or isinstance(path, Mapping):
        raise CannotSave(f"saving needs a file, but the description came from {source.file}")
    if read.description.version == "1":
        raise CannotSave(
            f"'{source.file}' has version 1, which has no configurations; `eurdf migrate` converts it to version 2"
        )
    if not os.path.lexists(path):
        folder = Path(source.file).parent
        raise CannotSave(
            f"'{os.fsdecode(path)}' is a robot of the collection; copy its folder '{folder}' and change the copy"
        )
    return source.file


def save_configuration(read: ReadRobot, robot: Robot, q: Vector, name: str = NAME, *, force: bool) -> bool:
    """Save a configuration under a name.

    Returns:
        Whether the file changed; it does not if it has this configuration.

    Raises:
        ConfigurationExists: There is a different one and `force` is False.
        CannotSave: The file cannot be changed without changing more, or it cannot be written.
    """
    source = read.description.document.source
    file = source.file
    if is_stated(robot, q, name):
        return False
    if name in robot.configurations and not force:
        raise ConfigurationExists(f"'{file}' already has a different configuration '{name}'")
    try:
        text, diagnostics = with_closed_configuration(read, robot, q, name)
    except NotEditable as reason:
        raise CannotSave(f"cannot write to '{file}': {reason}; edit the file by hand") from None
    if diagnostics.errors:
        raise CannotSave(f"cannot write to '{file}': {diagnostics.errors[0]}")
    before = Path(file).read_bytes()
    if before.removeprefix(BOM) != source.data:
        raise CannotSave(f"another program changed '{file}' in the meantime; nothing was written, try again")
    try:
        write_atomically(file, text if before == source.data else BOM.decode() + text)
    except OSError as error:
        raise CannotSave(f"cannot write '{file}': {error.strerror or error}") from error
    return True


def is_stated(robot: Robot, q: Vector, name: str = NAME) -> bool:
    """Whether a named configuration of a robot is this one, to 1e-12 in each entry of q (nq,)."""
    stated = robot.configurations.get(name)
    return stated is not None and bool(np.abs(stated - q).max(initial=0.0) <= _SAME)


def with_closed_configuration(read: ReadRobot, robot: Robot, q: Vector, name: str = NAME) -> tuple[str, Diagnostics]:
    """The text of a description in which a named configuration is q.

    Joints at their neutral are left out, unless the file states them already. Numbers are rounded to 15 decimals where
    the loops stay as closed.

    Returns:
        The text, and its diagnostics, such as a coordinate beyond its limits.

    Raises:
        NotEditable: The file has a form in which the configuration cannot be changed alone.
    """
    document = read.description.document
    exact = robot.joint_positions(q)
    enough = max(CLOSED_IN_FULL, _largest_row(robot, q))
    rounded = {joint: tuple(round(value, DECIMALS) for value in values) for joint, values in exact.items()}
    text, diagnostics = "", Diagnostics()
    for coordinates in (rounded, exact):
        text = with_configuration(document, name, _to_state(read, robot, coordinates, name))
        mechanism, diagnostics = reread(text, read.urdf, document.source.file)
        if mechanism is None:
            break
        back = configuration_vector(robot.mechanism, robot.model, mechanism.configurations[name])
        if _largest_row(robot, back) <= enough:
            break
    return text, diagnostics


def _to_state(
    read: ReadRobot, robot: Robot, coordinates: Mapping[str, Sequence[float]], configuration: str
) -> dict[str, Sequence[float]]:
    """The coordinates of the joints that a file has to state."""
    stated = read.description.configurations.get(configuration, {})
    neutral = {joint.name: joint.type.neutral for joint in robot.mechanism.joints}
    neutral[ROOT_JOINT] = root_joint("").type.neutral
    return {name: values for name, values in coordinates.items() if name in stated or tuple(values) != neutral[name]}


def _largest_row(robot: Robot, q: Vector) -> float:
    return float(np.abs(residual(robot, q)).max(initial=0.0))
