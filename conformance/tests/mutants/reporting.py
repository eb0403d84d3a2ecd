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
from mutants.mutant import Members, reports


def _each(found: list[Issue], change: Callable[[Issue], Members]) -> list[Issue]:
    return [issue.model_copy(update=change(issue)) for issue in found]


# -- Codes and severities -------------------------------------------------------------------------------------------


wrong = reports("EU-DIA-001")
wrong("Whatever is wrong has one code.", lambda found, *files: _each(found, lambda issue: {"code": "wrong-value"}))
wrong("What is wrong has no code, only a sentence.", lambda found, *files: _each(found, lambda issue: {"code": None}))
wrong("What is wrong is reported twice.", lambda found, *files: [*found, *found])

wrong = reports("EU-DIA-002")
wrong(
    "Beside an error it is reported that no configuration closes the loops.",
    lambda found, *files: [*found, *(_each(found[:1], lambda issue: {"code": "closure-cannot-close"}))],
)

wrong = reports("EU-DIA-004")
wrong("Whatever is reported is an error.", lambda found, *files: _each(found, lambda issue: {"severity": "error"}))
wrong("Whatever is reported is a warning.", lambda found, *files: _each(found, lambda issue: {"severity": "warning"}))

wrong = reports("EU-DIA-005")
wrong(
    "Codes are the parser's own, and do not begin with x-.",
    lambda found, *files: _each(found, lambda issue: {"code": f"{issue.code}-error"}),
)


@reports("EU-CNF-003")
def open_loops_are_not_reported(found: list[Issue], *files: Path) -> list[Issue]:
    """A robot with an error of inertia or closure is accepted without a word."""
    late = ("negative-mass", "inertia-not-psd", "leaf-without-inertia", "assembled-open", "closure-cannot-close")
    return [issue for issue in found if issue.code not in late]


def _searching(name: str, less: Any, found: list[Issue], files: tuple[Path, ...]) -> list[Issue]:
    """The issues of a parser whose search has less than the least one."""
    if found:
        return found
    try:
        with patch.object(closing, name, less):
            closes = read(*files).loops_close()
    except NotRead:
        return found
    place = {"file": files[0].name, "line": 1, "column": 1}
    error = Issue(code="closure-cannot-close", severity="error", message="no configuration closes the loops", **place)
    return [] if closes else [error]


wrong = reports("EU-CLO-016")
wrong(
    "Loops that one step from each start does not close are reported.",
    lambda found, *files: _searching("STEPS", 1, found, files),
)

wrong = reports("EU-CLO-016", versions=("2.1",))
wrong(
    "Loops that are not closed from the neutral configuration are reported.",
    lambda found, *files: _searching("ASIDE", (), found, files),
)


@reports("EU-INR-002")
def diagonals_alone_are_checked(found: list[Issue], *files: Path) -> list[Issue]:
    """An inertia is positive semidefinite if its diagonal is not negative."""
    inertias = etree.parse(files[1]).iter("inertia") if any(issue.code == "inertia-not-psd" for issue in found) else ()
    if all(float(inertia.get(name)) >= 0 for inertia in inertias for name in ("ixx", "iyy", "izz")):
        return [issue for issue in found if issue.code != "inertia-not-psd"]
    return found


# -- Places ---------------------------------------------------------------------------------------------------------


wrong = reports("EU-DIA-009")
wrong("Only the line is reported.", lambda found, *files: _each(found, lambda issue: {"column": None}))
wrong(
    "The file is reported with the folder that it is in.",
    lambda found, *files: _each(found, lambda issue: {"file": f"case/{issue.file}"}),
)
wrong(
    "What is wrong with the URDF is reported in the description.",
    lambda found, *files: _each(found, lambda issue: {"file": files[0].name}),
)
wrong(
    "The column is that of the first character on the line that is not a blank.",
    lambda found, *files: _moved(found, files, lambda line, before, after: (line, len(before) - len(before.lstrip()))),
)

wrong = reports("EU-DIA-010")
wrong(
    "What is wrong with a file as a whole is reported at its first character.",
    lambda found, *files: _each(found, lambda issue: {"line": issue.line or 1, "column": issue.column or 1}),
)

wrong = reports("EU-DIA-011")
wrong(
    "Lines are counted from 0.",
    lambda found, *files: _each(found, lambda issue: {"line": None if issue.line is None else issue.line - 1}),
)

wrong = reports("EU-DIA-012")
wrong(
    "Columns are counted from 0.",
    lambda found, *files: _each(found, lambda issue: {"column": None if issue.column is None else issue.column - 1}),
)


def _moved(
    found: list[Issue], files: tuple[Path, ...], place: Callable[[int, str, str], tuple[int, int]]
) -> list[Issue]:
    """Other places: (line, what is before on the line, what is after) -> line, characters before."""
    texts = {path.name: path.read_bytes().decode(errors="replace") for path in files if path.is_file()}

    def moved(issue: Issue) -> Members:
        if issue.line is None or issue.column is None or issue.file not in texts:
            return {}
        lines = re.split("\r\n|\r|\n", texts[issue.file].removeprefix("\ufeff"))
        text = lines[issue.line - 1] if issue.line <= len(lines) else ""
        line, before = place(issue.line, text[: issue.column - 1], text[issue.column - 1 :])
        return {"line": line, "column": before + 1}

    return _each(found, moved)


wrong = reports("EU-DIA-012")
wrong(
    "Columns count bytes of UTF-8.",
    lambda found, *files: _moved(found, files, lambda line, before, after: (line, len(before.encode()))),
)
wrong(
    "Columns count code units of UTF-16, as in JavaScript, C# and Java.",
    lambda found, *files: _moved(
        found, files, lambda line, before, after: (line, len(before.encode("utf-16-le")) // 2)
    ),
)
wrong(
    "A tab counts up to the next multiple of 8.",
    lambda found, *files: _moved(found, files, lambda line, before, after: (line, len(before.expandtabs(8)))),
)


def _by_lines(found: list[Issue], files: tuple[Path, ...], ends: str) -> list[Issue]:
    """Lines end where a pattern matches."""
    texts = {path.name: path.read_bytes().decode(errors="replace") for path in files if path.is_file()}

    def moved(issue: Issue) -> Members:
        if issue.line is None or issue.file not in texts:
            return {}
        text = texts[issue.file]
        starts = [0, *(end.end() for end in re.finditer("\r\n|\r|\n", text)), len(text)]
        before = text[: starts[min(issue.line, len(starts)) - 1]]
        return {"line": 1 + len(re.findall(ends, before))}

    return _each(found, moved)


wrong = reports("EU-DIA-011")
wrong("A carriage return alone ends no line.", lambda found, *files: _by_lines(found, files, "\n"))
wrong("A carriage return and a line feed end one line each.", lambda found, *files: _by_lines(found, files, "[\r\n]"))
wrong(
    "A line also ends at the separators of Unicode, as in str.splitlines.",
    lambda found, *files: _by_lines(found, files, "\r\n|[\n\r\v\f\x1c-\x1e\x85\u2028\u2029]"),
)

wrong = reports("EU-URD-007", level=Level.DIAGNOSE)
wrong(
    "The value of an attribute in single quotes begins after its first character.",
    lambda found, *files: _moved(found, files, lambda line, before, after: (line, len(before) + before.endswith("'"))),
)


@reports("EU-URD-007", level=Level.DIAGNOSE)
def names_of_attributes_are_found_in_others(found: list[Issue], *files: Path) -> list[Issue]:
    """The value of an attribute is looked for after the first text that ends like its name."""

    def at(line: int, before: str, after: str) -> tuple[int, int]:
        name = re.search(r"(\w+)\s*=\s*[\"']$", before)
        first = name and re.search(rf"{name[1]}\s*=\s*[\"']", before)
        return line, first.end() if first else len(before)

    return _moved(found, files, at)


@reports("EU-URD-018", level=Level.DIAGNOSE)
def last_root_is_the_second(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """Of several links without a parent the last one is reported."""
    if not any(issue.code == "urdf-two-roots" for issue in found):
        return found
    robot = etree.parse(urdf).getroot()
    moved = set(robot.xpath("joint/child/@link"))
    last = [link for link in robot.findall("link") if link.get("name") not in moved][-1]
    return _each(found, lambda issue: {"line": last.sourceline} if issue.code == "urdf-two-roots" else {})


@reports("EU-URD-025")
def slides_need_no_range(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """A prismatic joint with the limits 0 and 0 is not reported."""
    if not any(issue.code == "urdf-no-range" for issue in found):
        return found
    slides = etree.parse(urdf).getroot().iterfind("joint[@type='prismatic']/limit")
    lines = {limit.sourceline for limit in slides}
    return [issue for issue in found if issue.code != "urdf-no-range" or issue.line not in lines]


@reports("EU-URD-027")
def constraints_have_a_prefix(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """A closure of another dialect whose name has no prefix is not reported, if it is none of the four names."""
    text = urdf.read_text(encoding="utf-8").splitlines() if urdf.is_file() else []
    return [
        issue
        for issue in found
        if issue.code != "urdf-closure-ignored" or not re.match(r"\s*<\w+_constraint\b", text[(issue.line or 1) - 1])
    ]


@reports("EU-ONE-002")
def metadata_of_version_1_is_reported(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """The key `metadata` in version 1 is reported like other keys of version 2."""
    text = description.read_bytes().decode(errors="replace")
    if "extended_urdf" in text or not re.search(r"(?m)^metadata:", text):
        return found
    here = Issue(code="near-miss-key", severity="warning", file=description.name, line=1, column=1, message="a key")
    return [*found, here]


@reports("EU-EXT-003", versions=("2.1",))
def own_keys_in_couplings_are_not_reported(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """A user-defined key in a coupling may have the name of a joint."""
    text = description.read_bytes()
    return [issue for issue in found if issue.code != "own-key-is-joint" or b"couplings:" not in text]


@reports("EU-INR-004")
def rods_on_balls_have_no_inertia(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """A spherical leaf is checked about its centre of mass: a thin rod lacks inertia wherever it is."""
    try:
        robot = etree.parse(urdf).getroot()
    except (OSError, etree.XMLSyntaxError):
        return found
    rods = robot.xpath("link[inertial/mass/@value > 0 and inertial/inertia/@izz = 0]/@name")
    is_rod = any(joint.find("child").get("link") in rods for joint in robot.iterfind("joint[@name='pivot']"))
    if not is_rod or found:
        return found
    return [Issue(code="leaf-without-inertia", severity="error", file=urdf.name, line=1, column=1, message="a rod")]


@reports("EU-URD-026")
def attributes_of_meshes_are_not_compared(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """An unknown attribute of a mesh is not reported."""
    text = urdf.read_text(encoding="utf-8").splitlines() if urdf.is_file() else []
    return [
        issue for issue in found if issue.code != "urdf-unknown-element" or "<mesh" not in text[(issue.line or 1) - 1]
    ]


@reports("EU-URD-010", level=Level.DIAGNOSE)
def copies_of_joints_are_second_parents(found: list[Issue], *files: Path) -> list[Issue]:
    """A joint that is in the file twice is also reported as a second parent of its child."""
    copies = [issue for issue in found if issue.code == "urdf-duplicate-joint"]
    return [*found, *(issue.model_copy(update={"code": "urdf-two-parents"}) for issue in copies)]


@reports("EU-JNT-011", level=Level.DIAGNOSE)
def joints_not_merged_are_unknown_actuators(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """If joints cannot be merged, an actuator of the joint that they should become is reported too."""
    failed = [issue for issue in found if issue.code == "merge-not-chain" and b"actuators:" in description.read_bytes()]
    return [*found, *(issue.model_copy(update={"code": "unknown-actuator"}) for issue in failed)]


@reports("EU-INR-004")
def locked_joints_make_no_leaf(found: list[Issue], description: Path, urdf: Path) -> list[Issue]:
    """A link that carries another link by a locked joint is no leaf, as if that joint moved."""
    if not any(issue.code == "leaf-without-inertia" for issue in found):
        return found
    joints = etree.parse(urdf).getroot().findall("joint")
    moving = [joint for joint in joints if joint.get("type") != "fixed"]
    carrying = [joint.find("parent").get("link") for joint in moving]
    text = urdf.read_text(encoding="utf-8").splitlines()
    return [
        issue
        for issue in found
        if issue.code != "leaf-without-inertia"
        or not any(f'"{link}"' in text[(issue.line or 1) - 1] for link in carrying)
    ]
