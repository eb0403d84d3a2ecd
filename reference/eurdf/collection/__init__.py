"""The robots that come with the package, and where the files of a robot are."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from eurdf.exceptions import RobotNotFound

_HERE = Path(__file__).parent
_YAML = (".yaml", ".yml")
_URDF = (".urdf", ".xml")


@dataclass(frozen=True, slots=True)
class RobotFiles:
    """The files of one robot: a description that names its URDF, or a URDF alone."""

    description: Path | None
    urdf: Path | None


def collection_folder() -> Path | None:
    """The folder of the collection: in an installed package beside this file, in a checkout at its root."""
    for folder in (_HERE / "robots", _HERE.parents[2] / "robots"):
        if folder.is_dir():
            return folder
    return None


def collection_names() -> list[str]:
    """Names of the robots that come with the package."""
    folder = collection_folder()
    return [] if folder is None else sorted(path.parent.name for path in folder.glob("*/robot.yaml"))


def find_robot(path: str | os.PathLike[str], urdf: str | os.PathLike[str] | None = None) -> RobotFiles:
    """Find the files of a robot.

    Args:
        path: A folder, a YAML file, a bare URDF, or the name of a robot of the collection. A file is told by its
            ending: ``.urdf`` and ``.xml`` are URDFs, anything else is a description.
        urdf: A URDF in place of the one that the description names.

    Raises:
        RobotNotFound: Where there is no such thing.
    """
    where = Path(path)
    given = Path(urdf) if urdf is not None else None
    # os.path takes a text that no file system does for a path of nothing; Path raises.
    if os.path.isdir(where):
        return _in_folder(where, given)
    if os.path.lexists(where):
        if where.suffix.lower() in _URDF:
            if given is not None:
                raise RobotNotFound(str(path), f"'{path}' is a URDF itself; give the YAML file to use it with '{urdf}'")
            return RobotFiles(None, where)
        return RobotFiles(where, given)
    folder = collection_folder()
    name = os.fspath(path)
    if folder is not None and "/" not in name and os.sep not in name and os.path.isfile(folder / name / "robot.yaml"):
        return RobotFiles(folder / name / "robot.yaml", given)
    known = ", ".join(collection_names())
    message = f"there is no '{name}': it is no file, no folder, and no robot of the collection ({known})"
    raise RobotNotFound(name, message)


def _in_folder(folder: Path, given: Path | None) -> RobotFiles:
    for ending in _YAML:
        description = folder / f"robot{ending}"
        if description.is_file():
            return RobotFiles(description, given)
    files = sorted(path for path in folder.iterdir() if path.is_file())
    descriptions = [path for path in files if path.suffix.lower() in _YAML]
    if len(descriptions) == 1:
        return RobotFiles(descriptions[0], given)
    if not descriptions:
        urdfs = [path for path in files if path.suffix.lower() == ".urdf"]
        if (folder / "robot.urdf") in urdfs:
            return RobotFiles(None, folder / "robot.urdf")
        if len(urdfs) == 1:
            return RobotFiles(None, urdfs[0])
        what = f"{len(urdfs)} URDFs" if urdfs else "no robot.yaml and no URDF"
        raise RobotNotFound(str(folder), f"folder '{folder}' holds {what}; name the file")
    names = ", ".join(path.name for path in descriptions)
    raise RobotNotFound(str(folder), f"folder '{folder}' holds no robot.yaml but {names}; name the one you mean")
