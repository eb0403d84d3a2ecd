"""How messages show the values of a file, and names that are near each other, so that one is probably misspelt."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from string import ascii_lowercase, ascii_uppercase
from typing import Any

from eurdf.diagnostics.wording import edits

#: Known names of fewer characters may be one edit away, others two.
SHORT = 5

_FOLD = str.maketrans(ascii_uppercase, ascii_lowercase)


def quoted(text: str) -> str:
    """A text as a message quotes it: shortened if it is long, with control characters escaped."""
    shown = text if text.isprintable() else repr(text)[1:-1]
    return f"'{shown}'" if len(shown) <= 60 else f"'{shown[:57]}…'"


def described(value: Any) -> str:
    """What a value is, as a message describes it."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, int | float):
        return repr(value) if abs(value) < 1e15 else f"{value:g}"
    if isinstance(value, list):
        return "a list of names" if value and all(isinstance(item, str) for item in value) else "a list"
    return "a mapping"


def near(name: str, known: Iterable[str]) -> str | None:
    """The first known name that an unknown one is near (chapter Scope and terms), or None.

    The known names are short, as those of the format are.
    """
    folded = name.translate(_FOLD)
    return next((one for one in known if _is_near(folded, one.translate(_FOLD))), None)


def _is_near(name: str, known: str) -> bool:
    most = 1 if len(known) < SHORT else 2
    if abs(len(name) - len(known)) > most or len({*name} ^ {*known}) > most:
        return False  # a quick check: an edit changes the length, and the set of characters, by one at most
    return edits(name, known) <= most


def likeliest_key(key: str, keys: Iterable[str]) -> str | None:
    """The most similar of the known keys, for a hint: looser than `near`, and dashes and blanks are ignored."""
    folded = key.casefold().replace("-", "_").replace(" ", "_")
    return next(iter(difflib.get_close_matches(folded, list(keys), n=1)), None)
