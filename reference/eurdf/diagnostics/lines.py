"""The lines of a text, found by number and by position without a list of them."""

from __future__ import annotations

import re
from bisect import bisect_left
from itertools import accumulate, islice

#: Where a line ends, as in YAML 1.2, XML and most editors; other Unicode breaks are text.
BREAK = re.compile("\r\n?|\n")

#: Characters between two places whose line is known: a list of all lines of a file can be larger than the file.
_STEP = 1 << 12


class Lines:
    r"""The lines of a text, which end at ``\n``, ``\r\n`` or ``\r`` (EU-DIA-011).

    Attributes:
        text: The text.
    """

    __slots__ = ("_before", "text")

    def __init__(self, text: str) -> None:
        self.text = text
        self._before: list[int] = []  # how many lines end before each multiple of _STEP

    def position(self, index: int) -> tuple[int, int]:
        """Line and column, both from 1, of the character at an index (EU-DIA-012)."""
        step = min(index, len(self.text)) // _STEP
        line = self._counts()[step] + self._ends(step * _STEP, index) + 1
        return line, index - self._start(index) + 1

    def span(self, number: int) -> tuple[int, int] | None:
        """Where a line begins, by its number, from 1, and where it ends; None where the text has fewer."""
        counts = self._counts()
        step = max(bisect_left(counts, number - 1) - 1, 0)
        start = 0
        if number > 1:
            ends = BREAK.finditer(self.text, step * _STEP)
            found = next(islice(ends, number - 2 - counts[step], None), None)
            if found is None:
                return None
            start = found.end()
        end = self.text.find("\n", start)
        end = len(self.text) if end < 0 else end
        other = self.text.find("\r", start, end)
        return start, end if other < 0 else other

    def line(self, number: int) -> str | None:
        """A line by its number, from 1, without its end; None where the text has fewer."""
        span = self.span(number)
        return None if span is None else self.text[slice(*span)]

    def first(self, count: int) -> list[str]:
        """The first lines, without their ends, so many at most."""
        span = self.span(count)
        return BREAK.split(self.text if span is None else self.text[: span[1]])

    def _counts(self) -> list[int]:
        if not self._before:
            starts = range(0, len(self.text), _STEP)
            self._before = list(accumulate((self._ends(start, start + _STEP) for start in starts), initial=0))
        return self._before

    def _ends(self, start: int, end: int) -> int:
        r"""How many line ends are in a part of the text: a ``\r\n`` is where its ``\n`` is."""
        text = self.text
        return text.count("\n", start, end) + text.count("\r", start, end) - text.count("\r\n", start, end + 1)

    def _start(self, index: int) -> int:
        """Index of the first character of the line that a character is in."""
        text = self.text
        before = text.rfind("\n", 0, index) + 1
        other = text.rfind("\r", before, index)
        if other >= 0 and text.startswith("\r\n", other) and other + 1 == index:
            other = text.rfind("\r", before, other)
        return max(before, other + 1)
