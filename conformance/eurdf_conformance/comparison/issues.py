"""Compares the issues that a parser reports with the expected error or warnings of a case: the level diagnose."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from typing import Literal, Protocol

from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.json_pointer import step
from eurdf_conformance.protocol.message import Issue

#: EU-DIA-013: parsers differ in where they find a syntax error of YAML or XML.
_ANYWHERE = frozenset({"yaml-syntax", "xml-syntax"})

Severity = Literal["error", "warning"]


class Spot(Protocol):
    """The expected place of a diagnostic; without line and column it is the whole file."""

    @property
    def file(self) -> str:
        """Name of the file, without its folder."""

    @property
    def line(self) -> int | None:
        """From 1."""

    @property
    def column(self) -> int | None:
        """From 1, in characters."""


class Finding(Protocol):
    """An expected diagnostic."""

    @property
    def code(self) -> str:
        """Its code."""

    @property
    def place(self) -> Spot:
        """Where it is."""


def error_differences(error: Finding, issues: Sequence[Issue], beside: Iterable[Finding] = ()) -> list[Difference]:
    """EU-DIA-001, EU-DIA-002: differences from the one error of a case, at its place, without any other.

    EU-DIA-003: ``beside`` are warnings that the files have without the error, too. They may be reported, or not.
    """
    return _differences([error], issues, "error", {warning.code for warning in beside})


def warning_differences(warnings: Iterable[Finding], issues: Sequence[Issue]) -> list[Difference]:
    """EU-DIA-001: differences from the warnings of a valid case, each at its place, without any other."""
    return _differences(list(warnings), issues, "warning")


def _differences(
    expected: Sequence[Finding], issues: Sequence[Issue], severity: Severity, allowed: Collection[str] = ()
) -> list[Difference]:
    found = []
    rest = [(index, issue) for index, issue in enumerate(issues) if not _is_allowed(issue, allowed)]
    codes = [issue.code for _, issue in rest]
    for finding in expected:
        matching = [numbered for numbered in rest if numbered[1].code == finding.code]
        if not matching:
            found.append(Difference("/issues", finding.code, codes, f"reported codes, {severity}"))
            continue
        # Several may have one code, at different places.
        best = min(matching, key=lambda numbered: len(_misplaced(finding, severity, *numbered)))
        found += _misplaced(finding, severity, *best)
        rest.remove(best)
    if not any(difference.pointer == "/issues" for difference in found):  # else it is reported, with another code
        found += [Difference("/issues" + step(index), ABSENT, issue, "unexpected diagnostic") for index, issue in rest]
    return found


def _is_allowed(issue: Issue, codes: Collection[str]) -> bool:
    """Whether the issue is a warning with one of the codes, or advice with a code of the parser's own (EU-DIA-006)."""
    return (
        issue.severity == "warning" and issue.code is not None and (issue.code in codes or issue.code.startswith("x-"))
    )


def _misplaced(finding: Finding, severity: Severity, index: int, issue: Issue) -> list[Difference]:
    """EU-DIA-004, EU-DIA-009 to -013."""
    pointer, place = "/issues" + step(index), finding.place
    members: list[tuple[str, object, object]] = [("severity", severity, issue.severity)]
    if finding.code not in _ANYWHERE:
        members += [
            ("file", place.file, issue.file),
            ("line", place.line, issue.line),
            ("column", place.column, issue.column),
        ]
    elif issue.file is not None:
        members.append(("file", place.file, issue.file))
    return [
        Difference(pointer + step(member), one, other, f"{finding.code}, {member}")
        for member, one, other in members
        if one != other
    ]
