"""Parsers that report errors with another code, severity or place, or report too much."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest.mock import patch

from lxml import etree

from eurdf_conformance.level import Level
from eurdf_conformance.oracle import NotRead, closing, read
from eurdf_conformance.protocol.message import Issue
from mutants.mutant import Members, silent, text_of

Report = Callable[..., list[Issue]]


def _each(change: Callable[[Issue], Members]) -> Report:
    return lambda found, *files: [issue.model_copy(update=change(issue)) for issue in found]


def _and(more: Callable[[list[Issue]], list[Issue]]) -> Report:
    """Some issues are reported besides."""
    return lambda found, *files: [*found, *more(found)]


def _and_as(of: str, code: str) -> Report:
    """What has one code is reported with another one too."""
    return _and(lambda found: [each.model_copy(update={"code": code}) for each in found if each.code == of])


def _new(code: str, severity: str, file: Path) -> Issue:
    return Issue(code=code, severity=severity, message="?", file=file.name, line=1, column=1)


def _searching(name: str, less: Any) -> Report:
    """The search for a closed configuration has less than the least one."""

    def report(found: list[Issue], *files: Path) -> list[Issue]:
        if found:
            return found
        try:
            with patch.object(closing, name, less):
                closes = read(*files).loops_close()
        except NotRead:
            return found
        return [] if closes else [_new("closure-cannot-close", "error", files[0])]

    return report


def _has_a_diagonal(issue: Issue, description: Path, urdf: Path) -> bool:
    inertias = etree.parse(urdf).iter("inertia")
    return all(float(inertia.get(name)) >= 0 for inertia in inertias for name in ("ixx", "iyy", "izz"))


def _moved(place: Callable[[str, str], int]) -> Report:
    """Columns are others: place(what is before on the line, what is after) -> characters before."""

    def report(found: list[Issue], *files: Path) -> list[Issue]:
        texts = {path.name: text_of(path) for path in files if path.is_file()}

        def moved(issue: Issue) -> Members:
            if issue.line is None or issue.column is None or issue.file not in texts:
                return {}
            lines = re.split("\r\n|\r|\n", texts[issue.file])
            text = lines[issue.line - 1] if issue.line <= len(lines) else ""
            return {"column": 1 + place(text[: issue.column - 1], text[issue.column - 1 :])}

        return _each(moved)(found)

    return report


def _by_lines(ends: str) -> Report:
    """Lines end where a pattern matches."""

    def report(found: list[Issue], *files: Path) -> list[Issue]:
        texts = {path.name: text_of(path) for path in files if path.is_file()}

        def moved(issue: Issue) -> Members:
            if issue.line is None or issue.file not in texts:
                return {}
            text = texts[issue.file]
            starts = [0, *(end.end() for end in re.finditer("\r\n|\r|\n", text)), len(text)]
            return {"line": 1 + len(re.findall(ends, text[: starts[min(issue.line, len(starts)) - 1]]))}

        return _each(moved)(found)

    return report


def _after_an_equal_name(before: str, after: str) -> int:
    name = re.search(r"(\w+)\s*=\s*[\"']$", before)
    first = name and re.search(rf"{name[1]}\s*=\s*[\"']", before)
    return first.end() if first else len(before)


def _last_root(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    if not any(issue.code == "urdf-two-roots" for issue in found):
        return found
    robot = etree.parse(urdf).getroot()
    moved = set(robot.xpath("joint/child/@link"))
    last = [link for link in robot.findall("link") if link.get("name") not in moved][-1]
    return _each(lambda issue: {"line": last.sourceline} if issue.code == "urdf-two-roots" else {})(found)


def _of_a_slide(issue: Issue, description: Path, urdf: Path) -> bool:
    slides = etree.parse(urdf).getroot().iterfind("joint[@type='prismatic']/limit")
    return issue.line in {limit.sourceline for limit in slides}


def _at_line(pattern: str) -> Callable[..., Any]:
    """Whether a pattern is in the line of the URDF that an issue names."""
    return lambda issue, description, urdf: re.search(pattern, text_of(urdf).splitlines()[(issue.line or 1) - 1])


def _metadata(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    text = text_of(description)
    if "extended_urdf" in text or not re.search(r"(?m)^metadata:", text):
        return found
    return [*found, _new("near-miss-key", "warning", description)]


def _thin_rods(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    try:
        robot = etree.parse(urdf).getroot()
    except (OSError, etree.XMLSyntaxError):
        return found
    rods = robot.xpath("link[inertial/mass/@value > 0 and inertial/inertia/@izz = 0]/@name")
    is_rod = any(link in rods for link in robot.xpath("joint[@name='pivot']/child/@link"))
    return [_new("leaf-without-inertia", "error", urdf)] if is_rod and not found else found


def _unknown_actuators(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    if "actuators:" not in text_of(description):
        return found
    return _and_as("merge-not-chain", "unknown-actuator")(found)


def _carries(issue: Issue, description: Path, urdf: Path) -> Any:
    carrying = etree.parse(urdf).xpath("joint[@type!='fixed']/parent/@link")
    return any(_at_line(f'"{link}"')(issue, description, urdf) for link in carrying)


REPORTS = {
    # Codes and severities
    "EU-DIA-001": {
        "Whatever is wrong has one code.": _each(lambda issue: {"code": "wrong-value"}),
        "What is wrong has no code, only a sentence.": _each(lambda issue: {"code": None}),
        "What is wrong is reported twice.": _and(lambda found: found),
    },
    "EU-DIA-002": {
        "Beside an error it is reported that no configuration closes the loops.": _and(
            lambda found: [issue.model_copy(update={"code": "closure-cannot-close"}) for issue in found[:1]]
        ),
    },
    "EU-DIA-004": {
        "Whatever is reported is an error.": _each(lambda issue: {"severity": "error"}),
        "Whatever is reported is a warning.": _each(lambda issue: {"severity": "warning"}),
    },
    "EU-DIA-005": {
        "Codes are the parser's own, and do not begin with x-.": _each(lambda issue: {"code": f"{issue.code}-error"}),
    },
    "EU-CNF-003": {
        "A robot with an error of inertia or closure is accepted without a word.": lambda found, *files: [
            issue
            for issue in found
            if not re.match(
                "negative-mass|inertia-not-psd|leaf-without|assembled-open|closure-cannot-close", issue.code or ""
            )
        ],
    },
    "EU-CLO-016": {"Loops that one step from each start does not close are reported.": _searching("STEPS", 1)},
    ("EU-CLO-016", "2.1"): {
        "Loops that are not closed from the neutral configuration are reported.": _searching("ASIDE", ()),
    },
    "EU-INR-002": {
        "An inertia is positive semidefinite if its diagonal is not negative.": silent(
            "inertia-not-psd", _has_a_diagonal
        ),
    },
    # Places
    "EU-DIA-009": {
        "Only the line is reported.": _each(lambda issue: {"column": None}),
        "The file is reported with the folder that it is in.": _each(lambda issue: {"file": f"case/{issue.file}"}),
        "What is wrong with the URDF is reported in the description.": lambda found, description, urdf: _each(
            lambda issue: {"file": description.name}
        )(found),
        "The column is that of the first character on the line that is not a blank.": _moved(
            lambda before, after: len(before) - len(before.lstrip())
        ),
    },
    "EU-DIA-010": {
        "What is wrong with a file as a whole is reported at its first character.": _each(
            lambda issue: {"line": issue.line or 1, "column": issue.column or 1}
        ),
    },
    "EU-DIA-011": {
        "Lines are counted from 0.": _each(lambda issue: {"line": issue.line and issue.line - 1}),
        "A carriage return alone ends no line.": _by_lines("\n"),
        "A carriage return and a line feed end one line each.": _by_lines("[\r\n]"),
        "A line also ends at the separators of Unicode, as in str.splitlines.": _by_lines(
            "\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]"
        ),
    },
    "EU-DIA-012": {
        "Columns are counted from 0.": _each(lambda issue: {"column": issue.column and issue.column - 1}),
        "Columns count bytes of UTF-8.": _moved(lambda before, after: len(before.encode())),
        "Columns count code units of UTF-16, as in JavaScript, C# and Java.": _moved(
            lambda before, after: len(before.encode("utf-16-le")) // 2
        ),
        "A tab counts up to the next multiple of 8.": _moved(lambda before, after: len(before.expandtabs(8))),
    },
    ("EU-URD-007", Level.DIAGNOSE): {
        "The value of an attribute in single quotes begins after its first character.": _moved(
            lambda before, after: len(before) + before.endswith("'")
        ),
        "The value of an attribute is looked for after the first text that ends like its name.": _moved(
            _after_an_equal_name
        ),
    },
    ("EU-URD-018", Level.DIAGNOSE): {"Of several links without a parent the last one is reported.": _last_root},
    # Some issues more or less
    "EU-URD-025": {"A prismatic joint with the limits 0 and 0 is not reported.": silent("urdf-no-range", _of_a_slide)},
    "EU-URD-026": {
        "An unknown attribute of a mesh is not reported.": silent("urdf-unknown-element", _at_line("<mesh")),
    },
    "EU-URD-027": {
        "A closure of another dialect whose name has no prefix is not reported, if it is none of the four names.": (
            silent("urdf-closure-ignored", _at_line(r"^\s*<\w+_constraint\b"))
        ),
    },
    "EU-ONE-002": {"The key `metadata` in version 1 is reported like other keys of version 2.": _metadata},
    ("EU-EXT-003", "2.1"): {
        "A user-defined key in a coupling may have the name of a joint.": silent(
            "own-key-is-joint", lambda issue, description, urdf: "couplings:" in text_of(description)
        ),
    },
    "EU-INR-004": {
        "A spherical leaf is checked about its centre of mass: a thin rod lacks inertia wherever it is.": _thin_rods,
        "A link that carries another link by a locked joint is no leaf, as if that joint moved.": silent(
            "leaf-without-inertia", _carries
        ),
    },
    ("EU-URD-010", Level.DIAGNOSE): {
        "A joint that is in the file twice is also reported as a second parent of its child.": _and_as(
            "urdf-duplicate-joint", "urdf-two-parents"
        ),
    },
    ("EU-JNT-011", Level.DIAGNOSE): {
        "If joints cannot be merged, an actuator of the joint that they should become is reported too.": (
            _unknown_actuators
        ),
    },
}
