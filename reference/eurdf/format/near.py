"""Names that are near each other, so that one is probably the other misspelt (chapter Scope and terms)."""

from __future__ import annotations

from collections.abc import Iterable
from string import ascii_lowercase, ascii_uppercase

#: Known names of fewer characters may be one edit away, others two.
SHORT = 5

_FOLD = str.maketrans(ascii_uppercase, ascii_lowercase)


def near(name: str, known: Iterable[str]) -> str | None:
    """The first known name that an unknown one is near, or None.

    Args:
        name: The unknown name.
        known: Names of the format; they are short.
    """
    folded = name.translate(_FOLD)
    return next((one for one in known if _is_near(folded, one.translate(_FOLD))), None)


def _is_near(name: str, known: str) -> bool:
    most = 1 if len(known) < SHORT else 2
    if abs(len(name) - len(known)) > most or len({*name} ^ {*known}) > most:
        return False  # a quick check: an edit changes the length, and the set of characters, by one at most
    return edits(name, known) <= most


def edits(one: str, other: str) -> int:
    """Number of insertions, deletions and swaps of adjacent characters that turn one name into another."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, a in enumerate(one, 1):
        above, row = row, [i]
        for j, b in enumerate(other, 1):
            least = min(above[j], row[j - 1]) + 1
            if a == b:
                least = min(least, above[j - 1])
            if before and j > 1 and a == other[j - 2] and one[i - 2] == b:
                least = min(least, before[j - 2] + 1)
            row.append(least)
        before = above
    return row[-1]
