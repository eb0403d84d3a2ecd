"""Arguments that take one name, or several."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TypeVar

_Path = TypeVar("_Path", bound=str | os.PathLike[str])


def several(given: _Path | Iterable[_Path]) -> tuple[_Path, ...]:
    """The names, or paths, given: a text alone is one name, not the letters in it."""
    return (given,) if isinstance(given, str | os.PathLike) else tuple(given)
