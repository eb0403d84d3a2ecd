"""The lines of a text, found by number and by position without a list of them."""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator
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

    def line(self, number: int) -> str | None:
        """A line by its number, from 1, without its end; None where the text has fewer."""
        return next(self.from_line(number), None)

    def from_line(self, number: int) -> Iterator[str]:
        """The lines from one on."""
        counts = self._counts()
        step = max(bisect_left(counts, number - 1) - 1, 0)
        start = step * _STEP
        if number > 1:
            found = next(islice(BREAK.finditer(self.text, start), number - 2 - counts[step], None), None)
            if found is None:
                return
            start = found.end()
        for found in BREAK.finditer(self.text, start):
            yield self.text[start : found.start()]
            start = found.end()
        yield self.text[start:]

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
