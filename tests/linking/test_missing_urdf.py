"""Hints for what goes wrong first: lines that are indented wrongly, and a URDF that has another name."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf import check
from eurdf.diagnostics import Diagnostic, Diagnostics, FileError
from eurdf.diagnostics.lines import Lines
from eurdf.format.read import read_description
from eurdf.reading.indentation import first_line_hint, indentation_hint
from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml
from support.places import DATA

WORKBENCH = DATA / "workbench.urdf"
HEAD = 'extended_urdf: "2.0"\nurdf: robot.urdf\n'


def found_in(text: str) -> list[Diagnostic]:
    diagnostics = Diagnostics()
    try:
        read_description(read_yaml(Source("robot.yaml", text, text.encode())), diagnostics)
    except FileError as error:
        diagnostics.add(error.diagnostic)
    return list(diagnostics)


#: After the head of a description: lines of which one is indented wrongly; line and column of the error; its hint.
SYNTAX = [
    (
        " root: fixed\n",
        (3, 6),
        "indent 'root' by 0 spaces, like 'urdf' on line 2; a key with a value on its line cannot",
    ),
    (
        "closures:\n  - name: a\n    type: 3d\n   frames: [x, y]\n",
        (6, 4),
        "indent 'frames' by 4 spaces, like 'type' on line 5",
    ),
    (
        "closures:\n  - name: a\n  type: 3d\n",
        (5, 3),
        "indent 'type' by 4 spaces, like 'name' on line 4, or by 0 spaces, like 'closures' on line 3",
    ),
    ("actuators:\n  - motor\n - grip\n", (5, 2), "indent the '-' by 2 spaces, like the '-' on line 4"),
    (
        "actuators:\n  - joint: motor\n     gear_ratio: 3\n",
        (5, 16),
        "indent 'gear_ratio' by 4 spaces, like 'joint' on line 4; a key with",
    ),
    (
        "configurations:\n  assembled:\n    motor: 0.1\n   grip: 0\n",
        (6, 4),
        "indent 'grip' by 4 spaces, like 'motor' on line 5, or by 2 spaces, like 'assembled' on line 4",
    ),
    (
        "joints:\n  elbow: spherical\n    axes: xy\n",
        (5, 9),
        "indent 'axes' by 2 spaces, like 'elbow' on line 4; a key with",
    ),
    (
        "x-text: |\n  joints:\n    a: b\n # no comment\njoints:\n  a: fixed\n c: fixed\n",
        (9, 2),
        "indent 'c' by 2 spaces, like 'a' on line 8, or by 0 spaces, like 'joints' on line 7",
    ),
    (
        "x-list: [\n      a, b]\n\n# why\n  root: fixed\n",
        (7, 3),
        "indent 'root' by 0 spaces, like 'x-list' on line 3; a key with",
    ),
]


@pytest.mark.parametrize("break_", ["\n", "\r\n"])
@pytest.mark.parametrize(("body", "position", "hint"), SYNTAX)
def test_hint_points_to_start_of_unfinished_line(body: str, position: tuple[int, int], hint: str, break_: str) -> None:
    (found,) = found_in((HEAD + body).replace("\n", break_))
    assert found.code == "yaml-syntax"
    assert (found.line, found.column) == position
    assert (found.hint or "").startswith(hint)


@pytest.mark.parametrize("text", [" a: 1\nb: 2\n", "# comment\n\n  'a': 1\nb: 2\n"])
def test_indented_first_line_is_named(text: str) -> None:
    (found,) = found_in(text)
    assert re.fullmatch(r"begin 'a' on line [13] in the first column", found.hint or "")


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("x-note: see: here\n", "quote a value that has ': ' in it"),
        ("x-a: [1, 2\nroot: fixed\n", None),
        ("x-a: 'b' c\n", "quote the value as a whole"),
    ],
)
def test_other_errors_keep_their_hint(text: str, hint: str | None) -> None:
    (found,) = found_in(HEAD + text)
    assert found.hint is None if hint is None else (found.hint or "").startswith(hint)


#: After the head of a description: lines of which some are one level off, but YAML; and one of the hints.
SCHEMA = [
    (
        "closures:\n  - name: a\n    type: 3d\nframes: [x, y]\n",
        "if 'frames' on line 6 belongs to it, indent it by 4 spaces",
    ),
    (
        "closures:\n- name: a\n  type: 3d\n  frames: [x, y]\n  actuators: [motor]\n",
        "'actuators' is a key of the whole file: do not indent it",
    ),
    (
        "joints:\nelbow: spherical\n",
        "if 'elbow' on line 4 belongs to it, indent it deeper than 'joints'; remove the key if it has no value",
    ),
    (
        "joints:\n  stage:\n    limits:\n    velocity: 3\n",
        "if 'velocity' on line 6 belongs to it, indent it deeper than 'limits'",
    ),
    ("joints:\n  a: spherical\n  actuators: [motor]\n", "'actuators' is a key of the whole file"),
    ("configurations:\n  ready: {a: 1}\n  frames:\n  - {name: x, link: hand}\n", "'frames' is a key of the whole file"),
    (
        "joints:\n  elbow:\n    type: spherical\n    pivot: fixed\n",
        "did you mean 'pitch'? if 'pivot' is another joint, indent it like 'elbow'",
    ),
    (
        "configurations:\n  assembled:\n    motor: 0.1\n    ready: {motor: 0}\n",
        "if 'ready' is another configuration, indent it like 'assembled'",
    ),
    ("closures:\n  name: a\n  type: 3d\n", "begin the item with '- '"),
]


@pytest.mark.parametrize(("body", "hint"), SCHEMA)
def test_hint_points_to_key_one_level_off(body: str, hint: str) -> None:
    assert [found for found in found_in(HEAD + body) if (found.hint or "").startswith(hint)]


@pytest.mark.parametrize(
    "body",
    [
        "joints:\nactuators: []\n",
        "configurations:\n  a:\n  b: {hip: 1}\n",
        "joints:\n  a:\n    type: fixed\n    dampin: 1\n",
        "closures:\n  - {name: a, type: 3d}\nframes: []\n",
        "x-note: '\u2028'\nclosures:\n  - {name: a, type: 3d}\nframes: []\n",  # no line of YAML ends there
        "x-more: {frames: []}\nclosures:\n  - name: a\n    type: 3d\n",
    ],
)
def test_likelier_reason_suppresses_indentation_hint(body: str) -> None:
    found = found_in(HEAD + body)
    assert found
    assert not [one for one in found if "indent" in (one.hint or "")]


def test_too_deep_item_is_recognized_in_its_name(tmp_path: Path) -> None:
    (tmp_path / "robot.urdf").write_bytes(WORKBENCH.read_bytes())
    (tmp_path / "robot.yaml").write_text(HEAD + "actuators:\n  - motor\n    - grip\n", encoding="utf-8")
    (found,) = check(tmp_path).diagnostics
    assert found.code == "unknown-actuator"
    assert (
        found.hint
        == "an item that is indented more than the one before continues it; indent each '-' of a list equally"
    )


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.text(st.sampled_from(" -:a'\"[{|#\n\r"), max_size=60), st.integers(1, 9))
def test_any_text_is_accepted_without_exception(text: str, line: int) -> None:
    for hint in (indentation_hint(Lines(text), line), first_line_hint(Lines(text))):
        assert hint is None or "\n" not in hint


# -- the URDF -----------------------------------------------------------------------------------------------------

VERSION2 = 'extended_urdf: "2.0"\n'


def hint_of(folder: Path, urdfs: list[str], text: str, place: str = ".") -> str:
    """The hint of the check where there are these URDFs, and a description at a place."""
    for name in urdfs:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(WORKBENCH.read_bytes())
    (folder / place).mkdir(exist_ok=True)
    (folder / place / "robot.yaml").write_text(text, encoding="utf-8")
    (found,) = check(folder / place).diagnostics
    assert found.code == "urdf-not-found"
    return found.hint or ""


@pytest.mark.parametrize(
    ("urdfs", "text", "place", "written"),
    [
        (["leg.urdf"], VERSION2, ".", "leg.urdf"),
        (["leg.URDF"], VERSION2, ".", "leg.URDF"),
        (["a: #b.urdf"], VERSION2, ".", '"a: #b.urdf"'),
        (["jambe_é.urdf"], VERSION2, ".", "jambe_é.urdf"),
        (["robot_left.urdf", "zzz.urdf"], VERSION2 + "urdf: robot_lefft.urdf\n", ".", "robot_left.urdf"),
        (["urdf/leg.urdf"], VERSION2, ".", "urdf/leg.urdf"),
        (["urdf/leg.urdf"], VERSION2, "config", "../urdf/leg.urdf"),
        (["leg.urdf"], VERSION2 + "urdf: nowhere/leg.urdf\n", ".", "leg.urdf"),
    ],
)
def test_existing_urdf_is_suggested(tmp_path: Path, urdfs: list[str], text: str, place: str, written: str) -> None:
    hint = hint_of(tmp_path, urdfs, text, place)
    assert hint.endswith(f": write urdf: {written}")
    fixed = VERSION2 + hint.partition("write ")[2] + "\n"
    (tmp_path / place / "robot.yaml").write_text(fixed, encoding="utf-8")
    assert "urdf-not-found" not in [found.code for found in check(tmp_path / place).diagnostics]


@pytest.mark.parametrize("text", [VERSION2, "name_mot: []\n"], ids=["version 2", "version 1"])
def test_nearby_xacro_is_suggested(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.chdir(tmp_path)
    fix = "write urdf: leg.urdf.xacro" if text == VERSION2 else "use the option --urdf leg.urdf.xacro"
    assert hint_of(Path(), ["leg.urdf.xacro"], text) == f"there is 'leg.urdf.xacro': {fix}"


def test_several_urdfs_suggest_none(tmp_path: Path) -> None:
    hint = hint_of(tmp_path, ["a.urdf", "b.urdf"], VERSION2)
    assert hint == "there are 'a.urdf', 'b.urdf': write urdf: a.urdf, or use another of these files"


def test_missing_urdf_names_key_and_option(tmp_path: Path) -> None:
    hint = hint_of(tmp_path, [], VERSION2)
    assert hint == (
        "there is no URDF nearby: write its path from this file under the key 'urdf', or use the option --urdf FILE"
    )


@pytest.mark.parametrize("urdfs", [[], ["leg one.urdf"], ["a.urdf", "b.urdf"]])
def test_version_1_is_not_told_to_add_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, urdfs: list[str]) -> None:
    monkeypatch.chdir(tmp_path)
    hint = hint_of(Path(), urdfs, "name_mot: []\n")
    assert "key 'urdf'" not in hint
    assert "write urdf" not in hint
    assert "save it as robot.urdf" in hint
    assert "--urdf " + {0: "FILE", 1: "'leg one.urdf'", 2: "a.urdf"}[len(urdfs)] in hint
    if len(urdfs) == 1:
        os.rename(urdfs[0], "robot.urdf")
        assert "urdf-not-found" not in [found.code for found in check(".").diagnostics]
