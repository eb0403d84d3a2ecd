"""Diagnostics as the editor shows them: their places, related places, and the page that explains them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lsprotocol import types as lsp

from eurdf.diagnostics import Diagnostic, Place, Severity
from eurdf.diagnostics.lines import Lines
from eurdf.diagnostics.sarif import help_uri
from eurdf.editor.names import Occurrence
from eurdf.editor.open_robots import OpenRobots

#: How diagnostics say that they are of this server.
SOURCE = "eurdf"

_SEVERITIES = {Severity.ERROR: lsp.DiagnosticSeverity.Error, Severity.WARNING: lsp.DiagnosticSeverity.Warning}


def shown(robots: OpenRobots, path: str, found: Diagnostic) -> lsp.Diagnostic:
    """A diagnostic of a file as the protocol has it."""
    page = help_uri(found.code)
    return lsp.Diagnostic(
        range=place_of(robots, path, found),
        message=found.message + (f"\n{found.hint}" if found.hint else ""),
        severity=_SEVERITIES[found.severity],
        code=found.code,
        code_description=lsp.CodeDescription(page) if page.startswith("http") else None,
        source=SOURCE,
        related_information=[*_related(robots, path, found)] or None,
    )


def place_of(robots: OpenRobots, path: str, found: Diagnostic) -> lsp.Range:
    """The characters of a diagnostic in a file; its first line for the whole file, or if its place is unknown."""
    if found.place.file.endswith(" (expanded)"):  # of a xacro, which does not say where its parts come from
        text = robots.documents.text(path)
        return robots.documents.range(Lines(text), *_in_xacro(text, found))
    return _range(robots, path, found.place)


def _range(robots: OpenRobots, path: str, place: Place) -> lsp.Range:
    lines, line = Lines(robots.documents.text(path)), place.line or 1
    first, last = lines.span(line) or (len(lines.text), len(lines.text))
    start = min(first + (place.column or 1) - 1, last)
    end = last if place.end_column is None else min(first + place.end_column - 1, last)
    return robots.documents.range(lines, start, end)


def _in_xacro(text: str, found: Diagnostic) -> tuple[int, int]:
    """Where a xacro has what a diagnostic of the expanded text is about, if that is in it once, as it is."""
    place = found.place
    line = place.lines.line(place.line) if place.lines is not None and place.line is not None else None
    for part in () if line is None else (line.strip(), line[: place.end_column and place.end_column - 1].strip()):
        if part and text.count(part) == 1:
            start = text.index(part)
            return start, start + len(part)
    return 0, len(text.split("\n", 1)[0])


def _related(robots: OpenRobots, path: str, found: Diagnostic) -> Iterator[lsp.DiagnosticRelatedInformation]:
    """The other place of a diagnostic; where what it is at, and what its message names, is defined."""
    if found.related is not None:
        where = lsp.Location(robots.documents.uri(path), _range(robots, path, found.related))
        yield lsp.DiagnosticRelatedInformation(where, "the first one")
    if not robots.documents.is_current(path):
        return
    names, lines, place = robots.names(path), Lines(robots.documents.text(path)), place_of(robots, path, found)
    start, end = (robots.documents.index(lines, each) for each in (place.start, place.end))
    here = names.at(path, start) if found.place.column else None
    same = () if here is None else names.same(here)
    quoted = re.findall("'([^']+)'", found.message)
    for each in names.all:
        is_here = each.file == path and start <= each.start < max(end, start + 1)
        if each.defines and not is_here and (each in same or each.name in quoted):
            yield lsp.DiagnosticRelatedInformation(location(robots, each), f"{each.kind} '{each.name}'")


def location(robots: OpenRobots, place: Occurrence) -> lsp.Location:
    """Where something is named."""
    where = robots.documents.range(place.lines, place.start, place.end)
    return lsp.Location(robots.documents.uri(place.file), where)
