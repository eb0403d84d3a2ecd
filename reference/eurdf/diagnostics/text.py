"""Diagnostics as text: place, message, the source line with the place marked, and the hint.

The result is lines of styled pieces; the caller decides whether to keep the styles.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import replace

from eurdf.diagnostics.diagnostic import Diagnostic
from eurdf.diagnostics.registry import Severity
from eurdf.diagnostics.report import Report
from eurdf.diagnostics.wording import plural, visible

#: The pieces of one line, each with a rich style (empty for none).
Line = list[tuple[str, str]]

#: Columns for the text of a source line if there is no terminal.
SOURCE_WIDTH = 96

_LONGEST_MESSAGE = 1000
_ELLIPSIS = "..."
_TAB = "    "

_COLOR = {Severity.ERROR: "red", Severity.WARNING: "yellow"}


def report_lines(report: Report, width: int = SOURCE_WIDTH, bar: str = "|") -> Iterator[Line]:
    """The diagnostics of one robot, by file and position."""
    for found in _by_position(report.diagnostics):
        yield _headline(found, report.path)
        yield from _excerpt_lines(found, width, bar)


def summary_line(report: Report, strict: bool = False) -> Line:
    """The verdict on one robot."""
    found = counts(report)
    style = "bold red" if not report.passes(strict) else "yellow" if found else "green"
    fixes = len(report.fixes)
    more = f"; --fix applies {plural(fixes, 'fix', 'fixes')}" if fixes else ""
    return [(f"{visible(report.path)}: ", "bold"), (found or "valid", style), (more, "")]


def total_line(reports: Sequence[Report], strict: bool = False) -> Line:
    """The verdict on several robots together."""
    passed = sum(report.passes(strict) for report in reports)
    failed = len(reports) - passed
    found = counts(*reports)
    return [
        (f"{plural(len(reports), 'robot')}: ", "bold"),
        (f"{passed} passed", "green" if passed else ""),
        (", ", ""),
        (f"{failed} failed", "bold red" if failed else ""),
        (f" ({found})" if found else "", ""),
    ]


def cells(text: str) -> int:
    """Number of terminal columns of a text without control characters."""
    if text.isascii():
        return len(text)
    return sum(_cells_of(c) for c in text)


def _cells_of(character: str) -> int:
    if unicodedata.category(character) in ("Mn", "Me"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in ("W", "F") else 1


def _by_position(diagnostics: Sequence[Diagnostic]) -> list[Diagnostic]:
    files = {file: rank for rank, file in enumerate(dict.fromkeys(found.file for found in diagnostics))}
    return sorted(diagnostics, key=lambda found: (files[found.file], found.line or 0, found.column or 0))


def _headline(found: Diagnostic, path: str) -> Line:
    where = str(found.place if found.file else replace(found.place, file=path))
    message = visible(found.message)
    if len(message) > _LONGEST_MESSAGE:
        message = message[:_LONGEST_MESSAGE] + _ELLIPSIS
    return [
        (f"{visible(where)}: ", "bold"),
        (found.severity.value, f"bold {_COLOR[found.severity]}"),
        (f": {message} ", ""),
        (f"[{found.code} {found.clause}]" if found.clause else f"[{found.code}]", "dim"),
    ]


def _excerpt_lines(found: Diagnostic, width: int, bar: str) -> Iterator[Line]:
    place = found.place
    number = ""
    if place.line is not None and place.lines is not None:
        span = place.lines.span(place.line)
        if span is not None:
            number = str(place.line)
            start = None if place.column is None else place.column - 1
            end = None if place.end_column is None else place.end_column - 1
            shown, offset, length = _clip(place.lines.text, span, start, end, width)
            yield [(f"{number:>5} {bar} ", "blue"), (shown, "")]
            if start is not None:
                yield [
                    (f"{'':>5} {bar} ", "blue"),
                    (" " * offset, ""),
                    ("^" * length, f"bold {_COLOR[found.severity]}"),
                ]
    if found.hint:
        hint = visible(found.hint)[:_LONGEST_MESSAGE]
        yield [(f"{'':>5} = ", "blue"), ("fix" if found.fix else "hint", "bold cyan"), (f": {hint}", "")]


def _clip(text: str, span: tuple[int, int], start: int | None, end: int | None, width: int) -> tuple[str, int, int]:
    """The part of a line to show.

    Args:
        text: The text that contains the line.
        span: Where the line begins and ends in it.
        start: Index of the first character of the place; None for the whole line.
        end: Index after its last character; None if only the first is known.
        width: Available columns.

    Returns:
        The text to show, the column in it at which the place starts (from 0), and the width of the place in columns.
    """
    begin, length = span[0], span[1] - span[0]
    start = min(max(start or 0, 0), length)
    end = min(max(end or 0, start + 1), length)
    # Each visible character except combining marks takes at least one column, so the rest of a huge line is ignored.
    low, high = max(0, start - width), min(length, start + width)
    pieces = [_TAB if c == "\t" else visible(c) for c in text[begin + low : begin + high]]
    sizes = [cells(piece) for piece in pieces]
    place = start - low
    first, last = 0, len(pieces)
    if low or high < length or sum(sizes) > width:
        width -= 2 * len(_ELLIPSIS)
        if low or sum(sizes[:place]) > width * 2 // 3:
            first, room = place, width // 3
            while first > 0 and sizes[first - 1] <= room:
                first -= 1
                room -= sizes[first]
        last, room = first, width
        while last < len(pieces) and sizes[last] <= room:
            room -= sizes[last]
            last += 1
    before = _ELLIPSIS if low + first else ""
    after = _ELLIPSIS if low + last < length else ""
    shown = before + "".join(pieces[first:last]) + after
    offset = len(before) + sum(sizes[first:place])
    return shown.rstrip(), offset, max(1, sum(sizes[place : min(end - low, last)]))


def counts(*reports: Report) -> str:
    """How many errors and warnings there are; empty if none."""
    errors = sum(len(report.errors) for report in reports)
    warnings = sum(len(report.warnings) for report in reports)
    return ", ".join(plural(number, word) for number, word in ((errors, "error"), (warnings, "warning")) if number)
