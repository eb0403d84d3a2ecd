"""The XML files of a robot: each is read by our own reader, which refuses entities, before another program reads it."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Sequence
from pathlib import Path

from lxml import etree

from eurdf.diagnostics import Diagnostic, FileError
from eurdf.importing.exceptions import CannotImport
from eurdf.mesh_files.folders import Folders
from eurdf.reading.source import FILE_LIMIT, begin_of_file, read_source
from eurdf.reading.xml_reader import read_xml

#: Files that may include each other in turn.
DEPTH_LIMIT = 50

#: Files in the folder of another one that are read to find the one that includes it.
OTHERS_LIMIT = 50

_INCLUDE = re.compile(rb"""<include\s+file\s*=\s*["']([^"']+)["']""")

#: Flexible bodies that may be in files of their own, and elements that state options of MuJoCo's compiler.
FLEXIBLE_LIMIT = 50


def read_root(path: Path) -> etree._Element:
    """The root element of an XML file.

    Raises:
        CannotImport: It cannot be read, is not XML, is too large, or has entities.
    """
    try:
        return read_xml(read_source(path)).root
    except FileError as error:
        found = error.diagnostic
        raise unreadable(path, found) from None


def unreadable(path: Path, found: Diagnostic) -> CannotImport:
    """The exception for an error that leaves nothing to import."""
    where = f"{found.file}:{found.line}: " if found.line else ""
    return CannotImport(path, "; ".join((where + found.message, *([found.hint] if found.hint else []))))


def included_files(path: Path, folders: Folders) -> tuple[Path, ...]:
    """An MJCF file and all that it includes, each read once, the main one first: paths as given, not absolute.

    MuJoCo looks for an included file in the folder of the main one, then in that of the one that includes it; for what
    a model to attach includes, in the folder of that model. A file that exists in any of these counts.

    Args:
        path: The file.
        folders: Where all of them must be, with symbolic links followed.

    Raises:
        CannotImport: A file is outside the folders, includes itself, or cannot be read; or another file that MuJoCo
            opens while it reads these is outside the folders.
    """
    found: dict[Path, Path] = {}
    roots: list[etree._Element] = []
    visited: set[tuple[Path, Path]] = set()

    def visit(given: Path, main: Path, chain: tuple[Path, ...]) -> None:
        file = _resolved(path, given)
        inside(path, file, folders)
        if file in chain:
            shown = " -> ".join(f"'{each.name}'" for each in (*chain[chain.index(file) :], file))
            raise CannotImport(path, f"a file includes itself: {shown}; remove one of these includes")
        if len(chain) > DEPTH_LIMIT:
            raise CannotImport(path, f"files include each other more than {DEPTH_LIMIT} deep")
        if (file, main) in visited:
            return
        visited.add((file, main))
        root = read_root(file)
        if file not in found:
            roots.append(root)
        found.setdefault(file, given)
        for element in root.iter("include", "model"):
            if name := element.get("file"):
                places = [folder / name for folder in dict.fromkeys((main, given.parent, path.parent))]
                for each in [each for each in places if os.path.exists(each)] or places[:1]:
                    visit(each, each.parent if element.tag == "model" else main, (*chain, file))

    visit(path, path.parent, ())
    files = tuple(found.values())
    _check_flexible_bodies(path, files, roots, folders)
    return files


def included_by(path: Path) -> Path | None:
    """The file beside an MJCF file that includes it, such as its scene; None if there is none.

    Args:
        path: The file.
    """
    others = (other for other in sorted(path.parent.glob("*.xml")) if other.name != path.name)
    for other in itertools.islice(others, OTHERS_LIMIT):
        if other.is_symlink():  # which may lead out of the folder
            continue
        try:
            names = _INCLUDE.findall(begin_of_file(other, FILE_LIMIT))
        except OSError:
            continue
        if any(os.path.normpath(name) == os.fsencode(path.name) for name in names):
            return other
    return None


def inside(path: Path, file: Path, folders: Folders) -> None:
    """Refuse a file that is outside the folders of the robot, with symbolic links followed.

    Raises:
        CannotImport: It is outside.
    """
    if not folders.admit(file):
        raise CannotImport(
            path,
            f"it uses '{file}', which is outside the folder of the robot, {folders}; copy it there, or name a folder "
            "that has both with --within (within= in Python); --allow-outside (allow_outside=True) reads files from "
            "anywhere",
        )


def _check_flexible_bodies(
    path: Path, files: tuple[Path, ...], roots: Sequence[etree._Element], folders: Folders
) -> None:
    """Refuse files of flexible bodies outside the folders: MuJoCo opens them while it reads the XML.

    The folder that such a name starts from depends on options that any of the files may state, so that all are tried.
    """
    names = [name for root in roots for element in root.iter("flexcomp") if (name := element.get("file"))]
    options = [element for root in roots for element in root.iter("compiler")]
    if len(names) > FLEXIBLE_LIMIT or len(options) > FLEXIBLE_LIMIT:
        raise CannotImport(path, f"it has more than {FLEXIBLE_LIMIT} flexible bodies in files, or compiler elements")
    starts = {"", *(element.get(key, "") for element in options for key in ("meshdir", "assetdir"))}
    for name in dict.fromkeys((*names, *map(os.path.basename, names))):
        for folder in dict.fromkeys(file.parent for file in files):
            for start in sorted(starts):
                file = _resolved(path, folder / start / name)
                inside(path, file, folders)
                if os.path.exists(file) and not os.path.isfile(file):
                    raise CannotImport(path, f"it uses '{file}', which is not a file")


def _resolved(main: Path, file: Path) -> Path:
    """The real path of a file, with symbolic links followed."""
    try:
        return Path(os.path.realpath(file))
    except (OSError, ValueError):  # a name that cannot be one, such as one with a zero
        raise CannotImport(main, f"it includes {file.name!r}, which cannot be the name of a file") from None
