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


def resolve(uri: str, folder: Path, package_dirs: Sequence[str | os.PathLike[str]] = ()) -> str | None:
    """The file that a mesh URI of a URDF means, on this machine (EU-SEC-003).

    ``package://name/rest`` is looked for in the package ``name``, in the folders of `package_homes`. A path is relative
    to the folder of the URDF.

    Args:
        uri: As the URDF writes it.
        folder: Folder of the URDF.
        package_dirs: Folders that hold packages.

    Returns:
        A path, or None where there is no such file.
    """
    scheme, separator, rest = uri.partition("://")
    if not separator:
        return _file(folder / uri)
    if scheme == "file":
        return _file(folder / unquote(rest))
    if scheme not in ("package", "model"):
        return None
    package, _, rest = rest.partition("/")
    rest = rest.lstrip("/")
    for home in package_homes(folder, package_dirs):
        candidates = [home / package / rest]
        if home.name == package:
            candidates.append(home / rest)
        for candidate in candidates:
            if found := _file(candidate):
                return found
    return None


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


def _file(path: Path) -> str | None:
    """The path if there is such a file, else None, also for a text that cannot be a path."""
    return str(path) if os.path.isfile(path) else None
