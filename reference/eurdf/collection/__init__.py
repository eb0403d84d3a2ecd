"""The robots that come with the package, and where the files of a robot are."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Container, Mapping
from pathlib import Path
from typing import NamedTuple

from eurdf.collection.near_paths import URDF_ENDINGS, YAML_ENDINGS, near_path
from eurdf.errors import RobotNotFound
from eurdf.mesh_files.folders import MANIFEST
from eurdf.reading.robot_source import STDIN, RobotSource, display_name, is_stream, is_xml, source_of
from eurdf.reading.source import Source, unreadable

_FOLDER = Path(__file__).parent
# What a folder may have instead: a message names it, so that the next one says what to do with it.
_OTHERS = (".xacro", ".xml", ".sdf", ".usd", ".usda", ".usdc", ".usdz")

#: Names of the description in a folder of its own.
DESCRIPTIONS = tuple(f"robot{ending}" for ending in YAML_ENDINGS)

# The ending of descriptions in a folder with other YAML files; schema catalogs know it.
_OWN_SUFFIXES = tuple(f".eurdf{ending}" for ending in YAML_ENDINGS)

# Top-level keys that only descriptions of robots have, in version 2 or version 1.
_FORMAT_KEY = re.compile(rb"""^(["']?)(?:extended_urdf|closed_loop)\1[ \t]*:""", re.MULTILINE)

#: Names in the published collection (Gepetto/example-parallel-robots), of robots and folders, whose robot here has no
#: name that is near theirs.
_PUBLISHED = {
    "5bar": "five_bar",
    "5bar_linkage": "five_bar",
    "5bar3d": "five_bar_3d",
    "5bar_linkage_iso3d": "five_bar_3d",
    "5bar6d": "five_bar_6d",
    "5bar_linkage_iso6d": "five_bar_6d",
    "disney_robot": "disney_2legs",
    "talos_2legs_urdf": "talos_2legs",
    "talos_only_leg": "talos_2legs",
    "talos_full_closed": "talos_2legs",
}


class RobotFiles(NamedTuple):
    """The files of one robot: a description that names its URDF, or a URDF alone.

    Each is a path, or what was read where the caller gave a text or a stream.
    """

    description: Path | Source | None
    urdf: Path | Source | None


def collection_folder() -> Path | None:
    """The folder of the collection: in an installed package beside this file, in a checkout at its root."""
    for folder in (_FOLDER / "robots", _FOLDER.parents[2] / "robots"):
        if folder.is_dir():
            return folder
    return None


def collection_names() -> list[str]:
    """Names of the robots that come with the package."""
    folder = collection_folder()
    return [] if folder is None else sorted(path.parent.name for path in folder.glob("*/robot.yaml"))


def find_robot(path: RobotSource, urdf: RobotSource | None = None, texts: Container[str] = ()) -> RobotFiles:
    """Find the files of a robot.

    Args:
        path: A folder, a YAML file, a bare URDF or xacro, the name of a robot of the collection, ``-`` for standard
            input, a pipe, a text, or a mapping. A file that ends in ``.urdf``, ``.xml`` or ``.xacro`` is a URDF, any
            other a description. A text, or what comes from a stream, is a URDF if it begins with ``<``; a mapping is
            what a description contains.
        urdf: A URDF in place of the one that the description names: a file, ``-``, a pipe or a text.
        texts: Paths of files that are open in an editor, which need not exist.

    Raises:
        RobotNotFound: Where there is no such thing.
        FileError: A stream, a text or a folder cannot be read.
    """
    if urdf is not None and is_stream(path) and path == urdf:
        raise RobotNotFound(display_name(path), f"{display_name(path)} cannot be both the description and its URDF")
    # With os.path, which takes any string for a path that may not exist, where Path can raise.
    if not isinstance(path, bytes | Mapping) and path != STDIN and os.path.isdir(path):
        return _in_folder(path if isinstance(path, Path) else Path(path), _given_urdf(urdf))
    source = source_of(path)
    if source is not None:
        if is_xml(source):
            _refuse_second_urdf(path, urdf)
            return RobotFiles(None, source)
        return RobotFiles(source, _given_urdf(urdf))
    assert not isinstance(path, bytes | Mapping)
    if os.fspath(path) == "":  # Path takes it for the working directory
        raise RobotNotFound("", "the path of the robot is empty; '.' is the working directory")
    where = Path(path)
    if os.fspath(path) in texts or os.path.lexists(where):
        if where.suffix.lower() in URDF_ENDINGS:
            _refuse_second_urdf(path, urdf)
            return RobotFiles(None, where)
        return RobotFiles(where, _given_urdf(urdf))
    folder = collection_folder()
    name = os.fspath(path)
    if folder is not None and "/" not in name and os.sep not in name and os.path.isfile(folder / name / "robot.yaml"):
        return RobotFiles(folder / name / "robot.yaml", _given_urdf(urdf))
    names = collection_names()
    near = _PUBLISHED[name] if _PUBLISHED.get(name) in names else near_path(name, names)
    hint = f"did you mean '{near}'?" if near else "`eurdf robots` lists the collection"
    raise RobotNotFound(name, f"there is no '{name}': it is not a file, a folder, or a robot of the collection; {hint}")


def is_description(name: str, begin: Callable[[], bytes]) -> bool:
    """Whether a file is a description: by its name, or, of a YAML file, by a top-level key, which needs its text."""
    if name in DESCRIPTIONS or name.endswith(_OWN_SUFFIXES):
        return True
    return name.endswith(YAML_ENDINGS) and _FORMAT_KEY.search(begin()) is not None


def has_urdf(folder: Path) -> bool:
    """Whether a file in a folder is a URDF by its name.

    Raises:
        FileError: The folder cannot be read.
    """
    return any(path.suffix.lower() == ".urdf" for path in _files(folder))


def _files(folder: Path) -> list[Path]:
    """What is in a folder, except folders: a link to nothing, or a pipe, is an error where it is read."""
    try:
        names = os.listdir(folder)
    except OSError as error:
        raise unreadable(os.fspath(folder), f"the folder '{folder}'", error) from None
    return sorted(folder / name for name in names if not os.path.isdir(folder / name))


def _given_urdf(urdf: RobotSource | None) -> Path | Source | None:
    if urdf is None:
        return None
    if isinstance(urdf, Mapping):
        raise ValueError("urdf is a mapping, which is a description; expected the path or the text of a URDF")
    source = source_of(urdf)
    if source is not None:
        return source
    assert not isinstance(urdf, bytes)
    if os.fspath(urdf) == "":  # Path takes it for the working directory
        raise RobotNotFound("", "the path of the URDF is empty")
    return Path(urdf)


def _refuse_second_urdf(path: RobotSource, urdf: RobotSource | None) -> None:
    if urdf is not None:
        message = f"'{display_name(path)}' is a URDF itself; give the YAML file to use it with '{display_name(urdf)}'"
        raise RobotNotFound(display_name(path), message)


def _in_folder(folder: Path, given: Path | Source | None) -> RobotFiles:
    for ending in YAML_ENDINGS:
        description = folder / f"robot{ending}"
        # Asked in two ways, since the first takes one call of the system and is nearly always true.
        if os.path.isfile(description) or (os.path.lexists(description) and not os.path.isdir(description)):
            return RobotFiles(description, given)
    files = _files(folder)
    descriptions = [path for path in files if path.suffix.lower() in YAML_ENDINGS]
    # By the ending that catalogues of schemas know, other YAML files beside it aside.
    descriptions = [path for path in descriptions if path.stem.lower().endswith(".eurdf")] or descriptions
    if len(descriptions) == 1:
        return RobotFiles(descriptions[0], given)
    if not descriptions:
        urdfs = [path for path in files if path.suffix.lower() == ".urdf"]
        if given is not None:
            raise RobotNotFound(str(folder), f"folder '{folder}' contains no YAML file to use with the given URDF")
        if (folder / "robot.urdf") in urdfs:
            return RobotFiles(None, folder / "robot.urdf")
        if len(urdfs) == 1:
            return RobotFiles(None, urdfs[0])
        what = f"{len(urdfs)} URDFs" if urdfs else "no robot.yaml and no URDF"
        others = (path.name for ending in _OTHERS for path in files if path.suffix.lower() == ending)
        other = next((name for name in others if name != MANIFEST), None)
        if other is not None and not urdfs:
            what += f", but '{other}'"
        raise RobotNotFound(str(folder), f"folder '{folder}' contains {what}; name the file")
    names = ", ".join(path.name for path in descriptions)
    raise RobotNotFound(str(folder), f"folder '{folder}' contains no robot.yaml but {names}; name one of them")
