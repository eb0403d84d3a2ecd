"""A closed configuration saved to the file of a description, which keeps everything else."""

from __future__ import annotations

import os
from pathlib import Path

from eurdf.exceptions import EurdfError
from eurdf.kinematics.array import Vector
from eurdf.linking.robot_files import ReadRobot
from eurdf.pinocchio.robot import Robot
from eurdf.reading.robot_source import RobotSource
from eurdf.reading.source import BOM
from eurdf.writing.assembled import NAME, is_stated, with_closed_configuration
from eurdf.writing.atomic_file import write_atomically
from eurdf.writing.edit_configuration import NotEditable


class CannotSave(EurdfError, ValueError):  # noqa: N818 - shown to the user as it is
    """A configuration cannot be saved; the text says why."""


class ConfigurationExists(CannotSave):
    """There is a different configuration of this name, which may be replaced if the user agrees."""


def file_to_save_to(path: RobotSource, read: ReadRobot) -> str:
    """The file of a description that configurations can be saved to.

    Args:
        path: What the user gave.
        read: What was read from it.

    Raises:
        CannotSave: There is none.
    """
    source = read.description.document.source
    if not source.is_file:
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

    Args:
        read: Of version 2, from a file.
        robot: The robot built from it, with its own root.
        q: Closed configuration (nq,).
        name: Name of the configuration.
        force: Whether to replace a different configuration of this name.

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
