"""Names of files that mean a file in their folder and nothing else."""

from __future__ import annotations

import re

_ODD = re.compile(r"[^A-Za-z0-9._-]")


class FileNames:
    """Names of files in one folder, each different from the others, also where case does not count."""

    def __init__(self) -> None:
        self._used: set[str] = set()

    def new(self, stem: str, suffix: str) -> str:
        """A name of letters, digits, ``.``, ``_`` and ``-`` alone; its ending is in lower case."""
        stem, suffix = _ODD.sub("_", stem).lstrip(".") or "mesh", _ODD.sub("_", suffix).lower()
        name, count = stem + suffix, 1
        while name.lower() in self._used:
            count += 1
            name = f"{stem}_{count}{suffix}"
        self._used.add(name.lower())
        return name
