"""The path of the mesh that a URI names on this machine; nothing is ever downloaded."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from urllib.parse import unquote

from eurdf.mesh_files.folders import MANIFEST, Folders, folders_of_robot
from eurdf.reading.source import begin_of_file

#: What to do where a file of a package is not found.
HINT = (
    "put them beside the URDF, or give the folder that contains their package with --package-dir (package_dirs= in "
    "Python), ROS_PACKAGE_PATH or AMENT_PREFIX_PATH"
)

_NAME = re.compile(rb"<name>\s*([^<>\s]+)\s*</name>")


class FileFinder:
    """Finds the files that mesh URIs of one URDF mean, on this machine (EU-SEC-003).

    A path is relative to the folder of the URDF. ``package://name/rest`` is looked for in the package ``name``: in the
    homes of packages that are given, then from the folder of the URDF up to that of the robot, which may be the
    package itself. Without a name, it is looked for in these folders.

    Attributes:
        folders: Where files may be: the robot's folder, and the homes of packages.
    """

    def __init__(
        self,
        folder: Path,
        package_dirs: Sequence[str | os.PathLike[str]] = (),
        *,
        real_folder: Path | None = None,
        allow_outside: bool = False,
    ) -> None:
        """Look in some folders.

        Args:
            folder: Folder of the URDF.
            package_dirs: Folders that hold packages, or are one.
            real_folder: Folder of the file that the URDF is a symbolic link to, where that may be a robot's folder: an
                installer that makes links of all files of a robot makes them into one other folder.
            allow_outside: Whether files may be anywhere; see `Folders`.
        """
        self._folder = folder
        self._given, self._installed = _given_homes(package_dirs), _installed_homes()
        named = folders_of_robot(folder)
        real = folders_of_robot(os.path.realpath(folder if real_folder is None else real_folder))
        self._around = dict.fromkeys((*named, *real))
        self.folders = Folders((named[-1], real[-1], *self._given, *self._installed), allow_outside=allow_outside)
        self._packages: dict[str, list[Path]] = {}

    def find(self, uri: str) -> str | None:
        """The path of a file, or None where there is no such file; `folders` says whether it may be read."""
        scheme, separator, rest = uri.partition("://")
        if not separator:
            return _file(self._folder, uri)
        if scheme == "file":
            return _file(self._folder, unquote(rest))
        if scheme not in ("package", "model"):
            return None
        package, _, rest = rest.partition("/")
        found = (_file(folder, rest.lstrip("/")) for folder in self._folders_of(package))
        return next((path for path in found if path is not None), None)

    def _folders_of(self, package: str) -> list[Path]:
        """The folders that may be a package."""
        if package not in self._packages:
            self._packages[package] = [each for each in self._candidates(package) if os.path.isdir(each)]
        return self._packages[package]

    def _candidates(self, package: str) -> Iterator[Path]:
        if package in (os.curdir, os.pardir) or os.path.basename(package) != package:
            return
        for home in (*self._given, *self._installed, *self._around):
            if not package:
                yield home
                continue
            yield home / package
            if home.name == package or _name_of_package(home) == package:
                yield home
            if home in self._installed:
                self._allow_source(home / package)

    def _allow_source(self, package: Path) -> None:
        """Allow where the files of an installed package are, if it was installed as symbolic links to its source."""
        manifest = package / MANIFEST
        if manifest.is_file():
            self.folders.add(os.path.dirname(os.path.realpath(manifest)))


def package_homes(folder: Path, package_dirs: Sequence[str | os.PathLike[str]] = ()) -> list[Path]:
    """The folders that a xacro finds packages in, each of which may be the package itself.

    First those given, then those of ``ROS_PACKAGE_PATH``, then ``share`` below each of ``AMENT_PREFIX_PATH``, then the
    folder of the xacro and the folders that hold it.
    """
    absolute = folder.absolute()
    return [*_given_homes(package_dirs), *_installed_homes(), absolute, *absolute.parents]


def _given_homes(package_dirs: Sequence[str | os.PathLike[str]]) -> list[Path]:
    given = (package_dirs,) if isinstance(package_dirs, str | os.PathLike) else package_dirs
    return [Path(os.path.abspath(home)) for home in given]


def _installed_homes() -> list[Path]:
    """The homes of packages that the variables of ROS name."""
    homes = [Path(home) for home in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if home]
    return homes + [Path(home) / "share" for home in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if home]


def _name_of_package(folder: Path) -> str:
    """The name that the manifest of a package states; empty if it states none, or there is no manifest."""
    try:
        found = _NAME.search(begin_of_file(folder / MANIFEST, 1 << 16))
    except OSError:
        return ""
    return "" if found is None else found[1].decode(errors="replace")


def _file(folder: str | Path, name: str) -> str | None:
    """The path if there is such a file, else None, also for a text that cannot be a path."""
    path = os.path.join(folder, name)
    return str(Path(path)) if os.path.isfile(path) else None
