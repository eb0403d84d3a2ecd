"""The files of a robot that is looked at: loaded again when they change."""

from __future__ import annotations

import os
from typing import Any

from eurdf.array import Vector
from eurdf.errors import InvalidRobot
from eurdf.kinematics.residual import closure_openings
from eurdf.linking.robot_files import ReadRobot, read_robot, read_valid
from eurdf.loading import load
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.reading.robot_source import RobotSource, is_stream, is_text
from eurdf.viewing.live_robot import PageRobot, page_robot
from eurdf.viewing.shown import carried_to
from eurdf.writing.saved_configuration import CannotSave, file_to_save_to, save_configuration

#: Time and size of a file; None if there is none.
Stamp = tuple[int, int] | None


class RobotOnDisk:
    """A robot and where it comes from.

    Attributes:
        path: What the user gave.
        options: Keyword arguments of `eurdf.load`.
    """

    def __init__(self, path: RobotSource, options: dict[str, Any]) -> None:
        self.path = path
        self.options = options
        given = [path, options.get("urdf")]
        self._can_reread = not any(each is not None and (is_stream(each) or is_text(each)) for each in given)
        self._stamps: dict[str, Stamp] = {}

    def read(self) -> ReadRobot:
        """Read and link the files."""
        return read_robot(self.path, **self.options)

    def load(self) -> Robot:
        """Load it, and remember the state of its files.

        Raises:
            InvalidRobot: It cannot be built without guessing.
            RobotNotFound: There are no such files.
        """
        if not self._can_reread:
            return load(self.path, check_loops=True, **self.options)
        files = set(self._stamps) | _files(self.read())
        stamps = {file: _stamp(file) for file in files}
        self._stamps = stamps  # before it is loaded: a file that changes meanwhile is loaded again
        robot = load(self.path, check_loops=True, **self.options)
        self._stamps = {file: _stamp(file) for file in _meshes(robot)} | stamps
        return robot

    def page_robot(self) -> PageRobot | None:
        """What a page shows it from: its own files; None if they cannot be read again."""
        return page_robot(self.path, **self.options) if self._can_reread else None

    @property
    def can_save(self) -> bool:
        """Whether configurations can be saved to its description."""
        if not self._can_reread:
            return False
        read = self.read()
        try:
            return read.yaml is not None and bool(file_to_save_to(self.path, read))
        except CannotSave:
            return False

    def save(self, name: str, shown: Robot, at: Vector, *, replace: bool = False) -> str:
        """Save a configuration under a name.

        The change of the file does not count as one that another program makes.

        Args:
            name: The name.
            shown: The robot, as it was loaded.
            at: The configuration (nq,).
            replace: Whether to replace a different configuration of this name.

        Returns:
            What was done.

        Raises:
            ConfigurationExists: There is a different configuration of this name, and `replace` is False.
            CannotSave: The loops are open, or the file cannot be changed.
        """
        # The root may have been chosen for the page alone.
        try:
            read = read_valid(self.path, **{**self.options, "root": None})
        except InvalidRobot:
            raise CannotSave("the files have errors; nothing was written") from None
        if not name.strip():
            raise CannotSave("the configuration needs a name")
        robot = build_robot(read.mechanism, geometry=False)
        q = robot.configuration(carried_to(shown, at, robot))
        if any(opening.is_open for opening in closure_openings(robot, q)):
            raise CannotSave("the loops are open; assemble first")
        file = file_to_save_to(self.path, read)
        is_foreign = self.has_changed
        changed = save_configuration(read, robot, q, name, force=replace)
        if not is_foreign and file in self._stamps:
            self._stamps[file] = _stamp(file)
        return f"saved configuration '{name}' to '{file}'" if changed else f"'{file}' already has this configuration"

    @property
    def has_changed(self) -> bool:
        """Whether a file differs from what was loaded."""
        return any(_stamp(file) != stamp for file, stamp in self._stamps.items())


def _files(read: ReadRobot) -> set[str]:
    """The description and the URDF, or the files that a xacro includes."""
    sources = [] if read.tree is None else [read.urdf.document.source]
    if read.yaml is not None:
        sources.append(read.description.document.source)
    return {file for source in sources for file in source.files}


def _meshes(robot: Robot) -> set[str]:
    if robot.geometry is None:
        return set()
    paths = {shape.meshPath for model in robot.geometry for shape in model.geometryObjects}
    return {path for path in paths if os.path.isfile(path)}


def _stamp(file: str) -> Stamp:
    try:
        status = os.stat(file)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
