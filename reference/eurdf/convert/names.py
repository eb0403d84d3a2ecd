"""Names of the elements of a file, unique and representable in its format."""

from __future__ import annotations

from collections.abc import Callable

from eurdf.convert.losses import Losses
from eurdf.writing.xml_text import representable


class UniqueNames:
    """Unique names of the elements of one kind; each name that had to change is a loss."""

    def __init__(
        self,
        losses: Losses,
        *reserved: str,
        code: str = "export-name",
        representable: Callable[[str], str] = representable,
    ) -> None:
        self._losses, self._used, self._code = losses, set(reserved), code
        self._representable = representable

    def new(self, name: str) -> str:
        """The name, or one made of it that is not used yet."""
        found = self._representable(name)
        while found in self._used:
            found += "_"
        self._used.add(found)
        if found != name:
            self._losses.add(self._code, name, f"becomes '{found}'")
        return found
