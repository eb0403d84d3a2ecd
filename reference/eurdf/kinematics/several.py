"""Arguments that take one name, or several."""

from __future__ import annotations

from collections.abc import Iterable


def several(given: str | Iterable[str]) -> tuple[str, ...]:
    """The names given: a text alone is one name, not the letters in it."""
    return (given,) if isinstance(given, str) else tuple(given)
