"""The folders that the files of a robot may be in."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

#: What makes a folder a ROS package.
MANIFEST = "package.xml"


class Folders:
    """The folders that the files of a robot may be in, with every symbolic link followed.

    Attributes:
        allow_outside: Whether other files are read too.
        let_through: Paths of the files that were read because of that, in order.
    """

    def __init__(self, folders: Iterable[str | os.PathLike[str]] = (), *, allow_outside: bool = False) -> None:
        """Allow some folders, and all that is below them."""
        self._real: dict[str, None] = {}
        self.allow_outside = allow_outside
        self.let_through: dict[str, None] = {}
        for folder in folders:
            self.add(folder)

    def __str__(self) -> str:
        first, *others = (f"'{folder}'" for folder in self._real or ("",))
        return f"{first} (and outside {', '.join(others)})" if others else first

    @property
    def real(self) -> tuple[str, ...]:
        """Their real paths."""
        return tuple(self._real)

    def add(self, folder: str | os.PathLike[str]) -> None:
        """Allow one more folder."""
        self._real[os.path.realpath(folder)] = None

    def contains(self, path: str | os.PathLike[str]) -> bool:
        """Whether a file is in one of the folders; no path that cannot be one is."""
        try:
            real = os.path.realpath(path)
        except (OSError, ValueError):
            return False
        return any(real.startswith(folder.rstrip(os.sep) + os.sep) for folder in self._real)

    def admit(self, path: str | os.PathLike[str]) -> bool:
        """Whether a file may be read; one that is outside and may is remembered in `let_through`."""
        if self.contains(path):
            return True
        if self.allow_outside:
            self.let_through[os.fspath(path)] = None
        return self.allow_outside


def folders_of_robot(folder: str | os.PathLike[str]) -> tuple[Path, ...]:
    """The folder of a file, and those above it up to the robot's folder, which is the last one.

    That is the nearest folder that is a ROS package; without one, the folder of the file.
    """
    start = Path(os.path.abspath(folder))
    found = (start, *start.parents)
    for number, each in enumerate(found):
        if os.path.isfile(each / MANIFEST):
            return found[: number + 1]
    return found[:1]


def folders_of_files(paths: Iterable[str | os.PathLike[str]], *, allow_outside: bool = False) -> Folders:
    """The folders of robots that some files are in: what they name may be there.

    For the meshes of a robot that was built already, as where it was read from is not known.
    """
    homes: dict[str, None] = {}
    for path in paths:
        for place in (path, os.path.realpath(path)):
            homes[os.path.dirname(os.path.abspath(place))] = None
    return Folders((folders_of_robot(home)[-1] for home in homes), allow_outside=allow_outside)
