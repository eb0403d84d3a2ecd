"""Names of the elements of a file, unique and representable in its format; and of files beside it."""

from __future__ import annotations

import re
from collections.abc import Callable

from eurdf.convert.losses import Losses
from eurdf.writing.xml_text import representable


class UniqueNames:
    """Unique names of the elements of one kind; each name that had to change is a loss."""

    def __init__(self, losses: Losses, *reserved: str, representable: Callable[[str], str] = representable) -> None:
        self._losses, self._used, self._representable = losses, set(reserved), representable
        self._code = "import-name" if losses.has_kind("import-name") else "export-name"

    def new(self, name: str) -> str:
        """The name, or one made of it that is not used yet."""
        found = self._representable(name)
        while found in self._used:
            found += "_"
        self._used.add(found)
        if found != name:
            self._losses.add(self._code, name, f"becomes '{found}'")
        return found


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
