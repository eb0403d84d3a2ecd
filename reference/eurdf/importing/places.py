"""Where the files that a robot was read from state its elements."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from eurdf.diagnostics import Place
from eurdf.importing.exceptions import CannotImport
from eurdf.importing.xml_files import read_root


def places_of_names(sources: Sequence[Path]) -> dict[str, Place]:
    """The place of the first element of each name, in files that may be missing or have errors."""
    found: dict[str, Place] = {}
    for path in sources:
        try:
            root = read_root(path)
        except CannotImport:
            continue
        for element in root.iter("*"):
            name, line = element.get("name"), element.sourceline
            if name and isinstance(line, int):
                found.setdefault(name, Place(os.fspath(path), line))
    return found
