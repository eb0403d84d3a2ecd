"""The robots that a path on the command line selects, and the configuration that a name selects."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from eurdf.collection import DESCRIPTIONS, find_robot, has_urdf, is_description
from eurdf.diagnostics import FileError
from eurdf.errors import CannotRun, RobotNotFound
from eurdf.reading.robot_source import is_stream, is_text
from eurdf.reading.source import FILE_LIMIT, begin_of_file

if TYPE_CHECKING:
    from eurdf.array import Vector
    from eurdf.pinocchio.robot import Robot

#: The name of the neutral configuration, unless the description has one of this name.
NEUTRAL = "neutral"


def select(paths: Iterable[str], allow_none: bool = False) -> list[str]:
    """The robots that paths select, each once, in the given order.

    A folder with a ``robot.yaml`` or ``robot.yml`` is one robot. Any other folder is searched: each folder in it with
    such a file is a robot; in the others, a YAML file is a robot if its name is ``*.eurdf.yaml``, or if it has the
    top-level key ``extended_urdf`` or ``closed_loop``. Hidden folders and links to folders are skipped. Any other path,
    and a folder in which no robot is found, is passed to `eurdf.load`. If ``allow_none``, a folder can contain no
    robot, and its only YAML file is treated like one of any other folder.

    Raises:
        RobotNotFound: A path does not exist, or contains no robot.
        CannotRun: A folder cannot be read.
    """
    return list(dict.fromkeys(robot for path in paths for robot in _robots_at(path, allow_none)))


def without_robot(paths: Sequence[str]) -> list[str]:
    """The folders without a robot among several paths: those that ``robots/*/`` also stands for.

    Empty if no path is left without them: that is an error of the caller. `CannotRun` if a folder cannot be read.
    """
    found = [path for path in paths if os.path.isdir(path) and not _has_robot(path)]
    return [] if len(found) == len(paths) else list(dict.fromkeys(found))


def _has_robot(folder: str) -> bool:
    try:
        return has_urdf(Path(folder)) or bool(_robots_below(folder))
    except FileError:
        return True  # it is reported when the robot is checked


def select_one(path: str) -> str:
    """The single robot that a path selects, as `select` does; several are refused by `CannotRun`."""
    robots = select([path])
    if len(robots) > 1:
        raise CannotRun(f"'{path}' contains {len(robots)} robots, such as '{robots[0]}'; give one of them")
    return robots[0]


def named_configuration(robot: Robot, name: str) -> Vector:
    """A configuration of the description, or the neutral one; `CannotRun` if there is none of this name."""
    import pinocchio as pin

    from eurdf.diagnostics import did_you_mean

    if name in robot.configurations:
        return robot.configurations[name]
    if name == NEUTRAL:
        return pin.neutral(robot.model)  # type: ignore[no-any-return]
    known = [*robot.configurations, NEUTRAL]
    hint = did_you_mean(name, known) or f"the configurations are: {', '.join(known)}"
    raise CannotRun(f"there is no configuration '{name}'; {hint}")


def _robots_at(path: str, allow_none: bool) -> list[str]:
    if os.path.isdir(path) and not any(os.path.isfile(os.path.join(path, name)) for name in DESCRIPTIONS):
        found = _robots_below(path)
        if found:
            return found
        if allow_none:
            return [path] if _holds_urdf(path) else []
    if not (is_stream(path) or is_text(path)):  # their content is read once, when they are checked
        with contextlib.suppress(FileError):  # it is reported when the robot is checked
            find_robot(path)
    return [path]


def _holds_urdf(folder: str) -> bool:
    """Whether a folder without a description is a robot because of a URDF in it."""
    try:
        return find_robot(folder).description is None
    except RobotNotFound:
        return False
    except FileError:
        return True  # it is reported when the robot is checked


def _robots_below(folder: str) -> list[str]:
    def refuse(error: OSError) -> None:
        raise CannotRun(f"cannot read the folder '{error.filename}': {error.strerror}") from error

    found = []
    for place, folders, files in os.walk(folder, onerror=refuse):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        if any(name in DESCRIPTIONS for name in files):
            found.append(place)
            continue
        found += [
            os.path.join(place, name)
            for name in sorted(files)
            if is_description(name, partial(_begin, Path(place, name)))
        ]
    return found


def _begin(file: Path) -> bytes:
    try:
        return begin_of_file(file, FILE_LIMIT)
    except OSError:
        return b""
