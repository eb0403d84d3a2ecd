"""Tables of measurements, as text and in Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


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
        return "\n".join(([self.title] if self.title else []) + aligned)

    def markdown(self) -> str:
        """For a page."""
        ruler = ("---", *(["---:"] * (len(self.columns) - 1)))
        lines = ["| " + " | ".join(line) + " |" for line in (self.columns, ruler, *self.rows)]
        return "\n".join(([f"{self.title}:", ""] if self.title else []) + lines)


def duration(seconds: float) -> str:
    """A time, in s, ms or µs."""
    if seconds >= 1.0:
        return f"{seconds:.2f} s"
    return f"{seconds * 1e3:.2f} ms" if seconds >= 1e-3 else f"{seconds * 1e6:.1f} µs"


def ratio(ours: float, peer: float) -> str:
    """How many times as long as the peer takes."""
    return f"{ours / peer:.2f}"
