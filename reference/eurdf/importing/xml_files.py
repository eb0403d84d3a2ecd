"""The XML files of a robot: each is read by our own reader, which refuses entities, before another program reads it."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from lxml import etree

from eurdf.diagnostics import FileError
from eurdf.importing.exceptions import CannotImport
from eurdf.reading.source import read_source
from eurdf.reading.xml_reader import read_xml

#: Files that may include each other in turn.
DEPTH_LIMIT = 50


def read_root(path: Path) -> etree._Element:
    """The root element of an XML file.

    Raises:
        CannotImport: It cannot be read, is not XML, is too large, or has entities.
    """
    try:
        return read_xml(read_source(path)).root
    except FileError as error:
        found = error.diagnostic
        where = f"{found.file}:{found.line}: " if found.line else ""
        raise CannotImport(path, where + found.message) from None


def included_files(path: Path, within: Path) -> tuple[Path, ...]:
    """An MJCF file and all that it includes, each read once, the main one first: paths as given, not absolute.

    Args:
        path: The file.
        within: The folder that all of them must be in, with symbolic links followed.

    Raises:
        CannotImport: A file is outside the folder, includes itself, or cannot be read.
    """
    found: dict[Path, Path] = {}

    def visit(given: Path, chain: tuple[Path, ...]) -> None:
        file = _resolved(path, given)
        inside(path, file, within)
        if file in chain:
            shown = " -> ".join(f"'{each.name}'" for each in (*chain[chain.index(file) :], file))
            raise CannotImport(path, f"a file includes itself: {shown}; remove one of these includes")
        if len(chain) > DEPTH_LIMIT:
            raise CannotImport(path, f"files include each other more than {DEPTH_LIMIT} deep")
        root = read_root(file)
        found.setdefault(file, given)
        for name in _included(root):
            visit(path.parent / name, (*chain, file))

    visit(path, ())
    return tuple(found.values())


def inside(path: Path, file: Path, within: Path) -> None:
    """Refuse a file that is outside a folder, with symbolic links followed.

    Raises:
        CannotImport: It is outside.
    """
    if not file.is_relative_to(Path(os.path.realpath(within))):
        raise CannotImport(
            path,
            f"it uses '{file}', which is outside the folder '{within}'; copy it there, or name a folder that has both "
            "with --within (within= in Python)",
        )


def _resolved(main: Path, file: Path) -> Path:
    """The real path of a file, with symbolic links followed."""
    try:
        return Path(os.path.realpath(file))
    except (OSError, ValueError):  # a name that cannot be one, such as one with a zero
        raise CannotImport(main, f"it includes {file.name!r}, which cannot be the name of a file") from None


def _included(root: etree._Element) -> Iterator[str]:
    """Names of the files that are included: as text, or as a model to attach."""
    for element in root.iter("include", "model"):
        name = element.get("file")
        if name:
            yield name
