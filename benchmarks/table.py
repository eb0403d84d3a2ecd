"""Tables of measurements, as text and in Markdown, and the goals of ratios in them."""

from __future__ import annotations

import statistics
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

MET, MISSED = "✓", "✗"

# A page shows a longer table folded, below what it amounts to.
_LONGEST = 12

# Robots that miss a goal and are named.
_MOST_NAMED = 8


@dataclass(frozen=True)
class Table:
    """What was measured.

    Attributes:
        columns: Heads of the columns.
        rows: Of each row its cells; the first names what was measured.
        title: What the rows have in common, or nothing.
    """

    columns: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    title: str = ""

    def text(self) -> str:
        """For a terminal."""
        lines = [self.columns, *self.rows]
        widths = [max(len(line[index]) for line in lines) for index in range(len(self.columns))]
        aligned = []
        for line in lines:
            numbers = [cell.rjust(width) for cell, width in zip(line[1:], widths[1:], strict=True)]
            aligned.append("  ".join([line[0].ljust(widths[0]), *numbers]))
        return "\n".join([*([self.title] if self.title else []), *aligned, *self._summaries()])

    def markdown(self) -> str:
        """For a page."""
        ruler = ("---", *(["---:"] * (len(self.columns) - 1)))
        lines = ["| " + " | ".join(line) + " |" for line in (self.columns, ruler, *self.rows)]
        if len(self.rows) > _LONGEST:
            lines = ["<details>", f"<summary>{len(self.rows)} rows</summary>", "", *lines, "", "</details>"]
        said = [line for summary in self._summaries() for line in (f"- {summary}",)]
        return "\n".join([*([f"{self.title}:", ""] if self.title else []), *said, *([""] if said else []), *lines])

    def _summaries(self) -> Iterator[str]:
        """Of each column of ratios its median, and of each goal which rows miss it."""
        for index, column in enumerate(self.columns):
            cells = [(row[0], row[index].split()) for row in self.rows]
            judged = [(name, float(cell[0]), cell[1]) for name, cell in cells if cell[-1:] in ([MET], [MISSED])]
            if not judged:
                continue
            missed = sorted(((ratio, name) for name, ratio, mark in judged if mark == MISSED), reverse=True)
            named = [f"{name} ({ratio:.3g})" for ratio, name in missed[:_MOST_NAMED]]
            more = [f"{len(missed) - _MOST_NAMED} more"] if len(missed) > _MOST_NAMED else []
            but = f"; not by {', '.join(named + more)}" if missed else ""
            median = statistics.median(ratio for _, ratio, _ in judged)
            yield f"{column}: met by {len(judged) - len(missed)} of {len(judged)}, median {median:.2f}{but}"


@dataclass(frozen=True)
class Goal:
    """Times that ours may be at most: the peer's, times a factor, and some seconds."""

    factor: float
    seconds: float = 0.0

    def of(self, what: str) -> str:
        """The head of a column."""
        return f"{what}, ≤ {self.factor:g} ×" + (f" + {self.seconds * 1e6:.0f} µs" if self.seconds else "")

    def cell(self, ours: float, peer: float | None) -> str:
        """The ratio, and whether the goal is met; a dash without a peer."""
        if peer is None:
            return "-"
        return f"{ratio(ours, peer)} {MET if ours <= self.factor * peer + self.seconds else MISSED}"


def duration(seconds: float | None) -> str:
    """A time, in s, ms or µs; a dash for none."""
    if seconds is None:
        return "-"
    if seconds >= 1.0:
        return f"{seconds:.2f} s"
    return f"{seconds * 1e3:.2f} ms" if seconds >= 1e-3 else f"{seconds * 1e6:.1f} µs"


def ratio(ours: float, peer: float) -> str:
    """How many times as long as the peer takes."""
    return f"{ours / peer:.2f}"


def largest(values: Sequence[float]) -> str:
    """The largest of some errors; a dash for none."""
    return f"{max(values):.0e}" if len(values) else "-"
