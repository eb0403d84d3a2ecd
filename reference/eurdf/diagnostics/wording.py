"""The words of messages: names quoted, listed and corrected, and text made safe for a terminal, a log or JSON."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from functools import partial

#: Number of similar names that are compared with the name of the element.
_CLOSE = 20

#: Names whose difflib ratios differ by at most this are about equally similar.
_ABOUT = 0.1

#: A name that is made to another by at most so many edits may be mistyped.
_MISTYPED = 2

#: Maximum number of pairs of letters that the search for the intended name compares.
COMPARED = 40_000


def visible(text: str) -> str:
    r"""The text with invisible and control characters replaced by escapes (``\x1b``)."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text)


def no_command(line: str) -> str:
    r"""A line that is not a command of a workflow: GitHub runs what begins with ``::``, here ``\x3a:``."""
    text = line.lstrip()
    return line[: len(line) - len(text)] + r"\x3a" + text[1:] if text.startswith("::") else line


def encodable(text: str) -> str:
    """The text with lone surrogates (as in an undecodable file name) replaced by escapes."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def quoted(names: Sequence[str], most: int = 3) -> str:
    """Quoted names for a message: the first ones, and dots if there are more than ``most``."""
    return ", ".join(f"'{name}'" for name in names[:most]) + (", ..." if len(names) > most else "")


def plural(number: int, noun: str, nouns: str = "") -> str:
    """A number of things: "1 joint", "2 joints"; with the plural if it is not the noun and an s."""
    return f"{number} {noun}" if number == 1 else f"{number} {nouns or f'{noun}s'}"


def enumerated(names: Sequence[str], most: int = 6) -> str:
    """Quoted names for a sentence: the first ones, and how many more there are: "'a', 'b' and 2 more"."""
    items = [f"'{name}'" for name in names[:most]]
    if len(names) > most:
        items.append(f"{len(names) - most} more")
    return " and ".join(filter(None, (", ".join(items[:-1]), items[-1])))


def did_you_mean(wrong: str, known: Iterable[str], beside: str = "") -> str | None:
    """The hint for a misspelt name: the most similar known name, or None if none is similar; see `similar`."""
    if " - " in wrong:
        known = list(known)
        if wrong.partition(" - ")[0] in known:
            return "an item that is indented more than the one before continues it; indent each '-' of a list equally"
    return next((f"did you mean '{name}'?" for name in similar(wrong, known, beside)), None)


def similar(wrong: str, known: Iterable[str], beside: str = "") -> list[str]:
    """The known names that are about equally similar to a misspelt one, the most similar first; empty if none is.

    If there are several, the first is the one most similar to ``beside``, the element that contains the wrong name: if
    joint 'right_knee' mimics 'hip', it is 'right_hip', although 'left_hip' needs fewer added letters. If none is near,
    names of which one begins with the other are more similar: 'left_ankle' is 'left_ankle_motor', not 'left_knee'.

    The time is bounded. If there are too many names, only those that share the first or second half of the wrong name
    are compared; this includes every name that differs in one place.
    """
    size = len(wrong)
    # By difflib's ratio, a name shorter than 3/7 of another cannot be similar to it.
    candidates = [name for name in known if 3 * len(name) <= 7 * size and 3 * size <= 7 * len(name)]
    folded = wrong.casefold()
    alike = next((name for name in candidates if name.casefold() == folded), None)
    if alike is not None:
        return [alike]
    most = COMPARED // max(size * size, 1)
    if len(candidates) > most:
        half = size // 2
        first, second = wrong[:half], wrong[size - half :]
        candidates = [name for name in candidates if name.startswith(first) or name.endswith(second)][:most]
    close = difflib.get_close_matches(wrong, dict.fromkeys(candidates), n=_CLOSE)
    close = [name for name in close if _ratio(wrong, name) >= _ratio(wrong, close[0]) - _ABOUT]
    if all(edits(wrong, name) > _MISTYPED for name in close):
        close = sorted((name for name in candidates if continues(wrong, name)), key=len)[:_CLOSE] or close
    return sorted(close, key=partial(_ratio, beside), reverse=True) if beside else close


def continues(one: str, other: str) -> bool:
    """Whether one of two names begins with the other."""
    return one.startswith(other) or other.startswith(one)


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


def meant(wrong: object, known: Iterable[str]) -> str:
    """The hint of `did_you_mean` as the end of a message: after a semicolon, or empty."""
    hint = did_you_mean(wrong, known) if isinstance(wrong, str) else None
    return f"; {hint}" if hint else ""


def _ratio(one: str, other: str) -> float:
    return difflib.SequenceMatcher(None, one, other).ratio()
