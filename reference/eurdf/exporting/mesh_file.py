"""The mesh files of a robot, and the names they get beside an exported file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

_ODD = re.compile(r"[^A-Za-z0-9._-]")


def mesh_names(paths: Mapping[str, Path]) -> tuple[dict[str, bytes], dict[str, str]]:
    """The content of each mesh file, and a name for it, both by URI.

    A name has letters, digits, ``.``, ``_`` and ``-`` alone, so that it means a file in the folder and nothing else;
    its ending is in lower case. Files with equal names get a number.
    """
    contents: dict[str, bytes] = {}
    names: dict[str, str] = {}
    used: set[str] = set()
    for uri, path in paths.items():
        stem, suffix = _ODD.sub("_", path.stem).lstrip(".") or "mesh", _ODD.sub("_", path.suffix).lower()
        name, count = stem + suffix, 1
        while name.lower() in used:
            count += 1
            name = f"{stem}_{count}{suffix}"
        used.add(name.lower())
        contents[uri], names[uri] = path.read_bytes(), name
    return contents, names
