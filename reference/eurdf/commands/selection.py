"""Which robots a path on the command line stands for."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from pathlib import Path

from eurdf.collection import find_robot
from eurdf.commands.cannot_run import CannotRun
from eurdf.exceptions import RobotNotFound
from eurdf.reading.given import is_stream, is_text
from eurdf.reading.source import FILE_LIMIT

_DESCRIPTIONS = ("robot.yaml", "robot.yml")
_YAML_SUFFIXES = (".yaml", ".yml")
# The ending of a description in a folder with other YAML files, which catalogues of schemas know.
_OWN_SUFFIXES = (".eurdf.yaml", ".eurdf.yml")

# A key at the top level that only a description of a robot has, in version 2 or in version 1.
_FORMAT_KEY = re.compile(rb"""^(["']?)(?:extended_urdf|closed_loop)\1[ \t]*:""", re.MULTILINE)


def select(paths: Iterable[str], allow_none: bool = False) -> list[str]:
    """The robots that paths stand for, each once, in the order given.

    A folder with a ``robot.yaml`` or ``robot.yml`` is one robot. Any other folder is searched: each folder in it with
    such a file is a robot; in the others, each YAML file is one that is named ``*.eurdf.yaml``, or that has
    ``extended_urdf`` or ``closed_loop`` at its top level. Hidden folders and links to folders are not entered. What is
    no folder, or a folder in which nothing is found so, is what it is to `eurdf.load`.

    Args:
        paths: As the user gave them.
        allow_none: Whether a folder may hold no robot. Its only YAML file is then one as those of any other folder are.

    Raises:
        RobotNotFound: There is no such path, or no robot in it.
        CannotRun: A folder cannot be read.
    """
    return list(dict.fromkeys(robot for path in paths for robot in _robots_at(path, allow_none)))


def select_one(path: str) -> str:
    """The one robot that a path stands for.

    Raises:
        RobotNotFound: There is none.
        CannotRun: There are several.
    """
    robots = select([path])
    if len(robots) > 1:
        raise CannotRun(f"'{path}' holds {len(robots)} robots, such as '{robots[0]}'; name one of them")
    return robots[0]


def _robots_at(path: str, allow_none: bool) -> list[str]:
    if os.path.isdir(path) and not any(os.path.isfile(os.path.join(path, name)) for name in _DESCRIPTIONS):
        found = _robots_below(path)
        if found:
            return found
        if allow_none:
            return [path] if _holds_urdf(path) else []
    if not (is_stream(path) or is_text(path)):  # what is in them is found when they are checked, and read once
        find_robot(path)
    return [path]


def _holds_urdf(folder: str) -> bool:
    """Whether a folder without a description is a robot, for the URDF in it."""
    try:
        return find_robot(folder).description is None
    except RobotNotFound:
        return False


def _robots_below(folder: str) -> list[str]:
    def refuse(error: OSError) -> None:
        raise CannotRun(f"cannot read the folder '{error.filename}': {error.strerror}") from error

    found = []
    for place, folders, files in os.walk(folder, onerror=refuse):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        if any(name in _DESCRIPTIONS for name in files):
            found.append(place)
            continue
        found += [
            os.path.join(place, name)
            for name in sorted(files)
            if name.endswith(_OWN_SUFFIXES) or (name.endswith(_YAML_SUFFIXES) and _describes_robot(Path(place, name)))
        ]
    return found


def _describes_robot(file: Path) -> bool:
    try:
        if not file.is_file():
            return False
        with file.open("rb") as stream:
            return _FORMAT_KEY.search(stream.read(FILE_LIMIT)) is not None
    except OSError:
        return False
