"""The path of the mesh that a URI names on this machine; nothing is ever downloaded."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import unquote

#: What to do where a file of a package is not found.
HINT = (
    "put them beside the URDF, or give the folder that contains their package with --package-dir (package_dirs= in "
    "Python), ROS_PACKAGE_PATH or AMENT_PREFIX_PATH"
)


class FileFinder:
    """Finds the files that mesh URIs of one URDF mean, on this machine (EU-SEC-003).

    ``package://name/rest`` is looked for in the package ``name``, in the folders of `package_homes`. A path is relative
    to the folder of the URDF.
    """

    def __init__(self, folder: Path, package_dirs: Sequence[str | os.PathLike[str]] = ()) -> None:
        """Look in some folders.

        Args:
            folder: Folder of the URDF.
            package_dirs: Folders that hold packages.
        """
        self._folder = folder
        self._homes = package_homes(folder, package_dirs)
        self._packages: dict[str, list[str]] = {}

    def find(self, uri: str) -> str | None:
        """The path of a file, or None where there is no such file.

        Args:
            uri: As the URDF writes it.
        """
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

    def _folders_of(self, package: str) -> list[str]:
        """The folders that may be a package."""
        if package not in self._packages:
            self._packages[package] = [
                candidate
                for home in self._homes
                for candidate in (os.path.join(home, package), *([str(home)] if home.name == package else []))
                if os.path.isdir(candidate)
            ]
        return self._packages[package]


def package_homes(folder: Path, package_dirs: Sequence[str | os.PathLike[str]] = ()) -> list[Path]:
    """The folders that a package is looked for in, each of which may be the package itself.

    First those given, then those of ``ROS_PACKAGE_PATH``, then ``share`` below each of ``AMENT_PREFIX_PATH``, then the
    folder of the URDF and the folders that hold it.

    Args:
        folder: Folder of the URDF.
        package_dirs: Folders that hold packages.
    """
    given = (package_dirs,) if isinstance(package_dirs, str | os.PathLike) else package_dirs
    homes = [Path(os.path.abspath(home)) for home in given]
    homes += [Path(home) for home in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if home]
    homes += [Path(home) / "share" for home in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if home]
    absolute = folder.absolute()
    return [*homes, absolute, *absolute.parents]


def _file(folder: str | Path, name: str) -> str | None:
    """The path if there is such a file, else None, also for a text that cannot be a path."""
    path = os.path.join(folder, name)
    return str(Path(path)) if os.path.isfile(path) else None
