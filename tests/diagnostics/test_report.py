"""Findings as text and as JSON."""

import json
import unicodedata
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

import eurdf
from eurdf.commands.output import output_schemas
from eurdf.diagnostics import REGISTRY, Diagnostic, Phase, Place, Severity
from eurdf.diagnostics.lines import Lines
from eurdf.diagnostics.report import Report, report_schema, reports_to_json
from eurdf.diagnostics.text import cells, report_lines, summary_line, total_line
from eurdf.diagnostics.wording import visible
from eurdf.format.schema import schema_text
from support.places import ROOT

SCHEMAS = ROOT / "schema"

CLOSURE = """\
extended_urdf: "2.0"
closures:
  - {name: knee, type: 6d, frames: [rod_tip, rod_tpi]}
"""
UNKNOWN = Diagnostic(
    "unknown-frame",
    "closure 'knee' names the frame 'rod_tpi', which does not exist",
    Place("robot.yaml", 3, 46, 53, "/closures/0/frames/1", Lines(CLOSURE)),
    "did you mean 'rod_tip'?",
)
NEAR_MISS = Diagnostic("near-miss-key", "'types' is no key of the format", Place("robot.yaml", 1, 1, 14, "/types"))


def text_of(report: Report, width: int = 96) -> list[str]:
    return ["".join(piece for piece, _ in line) for line in report_lines(report, width)]


def at(text: str, column: int | None, end_column: int | None = None, width: int = 96, line: int = 1) -> list[str]:
    """What is shown of a place in a file of that text."""
    place = Place("robot.yaml", line, column, end_column, lines=Lines(text))
    return text_of(Report("robot.yaml", (Diagnostic("wrong-type", "it is wrong", place),)), width)[1:]


def test_diagnostic_shows_line_with_underlined_place() -> None:
    assert text_of(Report(".", (UNKNOWN,))) == [
        "robot.yaml:3:46: error: closure 'knee' names the frame 'rod_tpi', which does not exist"
        " [unknown-frame EU-FRM-001]",
        "    3 |   - {name: knee, type: 6d, frames: [rod_tip, rod_tpi]}",
        "      |                                              ^^^^^^^",
        "      = hint: did you mean 'rod_tip'?",
    ]


def test_diagnostics_are_sorted_by_file_and_position() -> None:
    urdf = Diagnostic("urdf-no-link", "the robot has no link", Place("robot.urdf", 1, 1))
    heads = [
        line for line in text_of(Report(".", (UNKNOWN, urdf, NEAR_MISS))) if ": error: " in line or "warning" in line
    ]
    assert [head.split(": ")[0] for head in heads] == ["robot.yaml:1:1", "robot.yaml:3:46", "robot.urdf:1:1"]


@pytest.mark.parametrize(
    ("place", "shown"),
    [
        (("a: 1\nb: 2\n", None, None, 96, 2), ["    2 | b: 2"]),
        (("a: 1\n", 1, None, 96, 7), []),
        (("\tkey: value", 7, 12), ["    1 |     key: value", "      |          ^^^^^"]),
        (("名前: [rod]", 6, 9), ["    1 | 名前: [rod]", "      |        ^^^"]),
        (("名前: 1", 1, 3), ["    1 | 名前: 1", "      | ^^^^"]),
        (("key: [a, b", 11), ["    1 | key: [a, b", "      |           ^"]),
    ],
)
def test_place_is_marked_below_its_line(place: tuple[Any, ...], shown: list[str]) -> None:
    assert at(*place) == shown


def test_advice_without_text_is_one_line_without_clause() -> None:
    found = Diagnostic("x-no-actuator", "it is idle", Place("r.yaml", 3))
    assert text_of(Report("r", (found,))) == ["r.yaml:3: warning: it is idle [x-no-actuator]"]


def test_byte_order_mark_does_not_move_caret(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_bytes("\ufeffkey: 1\n".encode())
    lines = text_of(eurdf.check(tmp_path / "robot.yaml"))
    assert lines[1:3] == ["    1 | key: 1", "      | ^"]


def test_long_line_is_clipped_around_place() -> None:
    line, caret = at("x" * 3000 + "HERE" + "y" * 3000, 3001, 3005, width=60)
    assert len(line) <= 60 + 8
    assert line[caret.index("^") : caret.rindex("^") + 1] == "HERE"
    assert line[8:11] == line[-3:] == "..."


@given(
    text=st.text(st.characters(exclude_characters="\n\r", exclude_categories=["Cs"]), max_size=300),
    start=st.integers(1, 320),
    length=st.integers(0, 40),
    width=st.integers(20, 120),
)
def test_marks_start_under_first_character(text: str, start: int, length: int, width: int) -> None:
    place = Place("robot.yaml", 1, start, start + length, lines=Lines(text))
    lines = text_of(Report("r", (Diagnostic("wrong-type", "wrong", place),)), width)[1:]
    source, caret = lines[0][8:], lines[1][8:]
    assert cells(source) <= width
    assert visible(source) == source
    column = caret.index("^")
    assert set(caret[column:]) == {"^"}
    if start <= len(text) and text[start - 1].isprintable() and text[start - 1] != " ":
        wanted = text[start - 1]
        reached = [i for i in range(len(source) + 1) if cells(source[:i]) == column]
        assert wanted in [c for i in reached for c in source[i : i + 1]] or unicodedata.category(wanted) in ("Mn", "Me")


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("plain 'name'", "plain 'name'"),
        ("[bold]x[/bold]", "[bold]x[/bold]"),
        ("a\x1b[31mred\nline\tx\0", r"a\x1b[31mred\nline\tx\x00"),
        ("\u202eevil", r"\u202eevil"),
        ("half \udc80", r"half \udc80"),
        ("pied à terre 名", "pied à terre 名"),
    ],
)
def test_message_cannot_control_terminal(text: str, shown: str) -> None:
    found = Diagnostic("wrong-type", text, Place("robot.urdf"), text)
    head, hint = text_of(Report(".", (found,)))
    assert head == f"robot.urdf: error: {shown} [wrong-type EU-SCH-002]"
    assert hint == f"      = hint: {shown}"


def summary(report: Report, strict: bool = False) -> str:
    return "".join(piece for piece, _ in summary_line(report, strict))


def test_summary_counts_errors_and_warnings() -> None:
    assert summary(Report("a")) == "a: valid"
    assert summary(Report("a", (UNKNOWN,))) == "a: 1 error"
    assert summary(Report("a", (UNKNOWN, NEAR_MISS, UNKNOWN))) == "a: 2 errors, 1 warning"


def test_total_counts_passing_and_failing_robots() -> None:
    reports = [Report("a"), Report("b", (NEAR_MISS,)), Report("c", (UNKNOWN, NEAR_MISS))]
    assert "".join(p for p, _ in total_line(reports)) == "3 robots: 2 passed, 1 failed (1 error, 2 warnings)"
    assert "".join(p for p, _ in total_line(reports, strict=True)).startswith("3 robots: 1 passed, 2 failed")


def test_warnings_fail_only_strict_check() -> None:
    report = Report("a", (NEAR_MISS,))
    assert report.ok
    assert report.passes()
    assert not report.passes(strict=True)
    assert report.errors == ()
    assert report.warnings == (NEAR_MISS,)


def test_json_contains_all_fields() -> None:
    document = reports_to_json([Report("robots/knee", (UNKNOWN,)), Report("robots/hip")])
    assert document == {
        "version": 1,
        "ok": False,
        "robots": [
            {
                "path": "robots/knee",
                "ok": False,
                "diagnostics": [
                    {
                        "code": "unknown-frame",
                        "severity": "error",
                        "phase": "link",
                        "clause": "EU-FRM-001",
                        "message": "closure 'knee' names the frame 'rod_tpi', which does not exist",
                        "hint": "did you mean 'rod_tip'?",
                        "fix": None,
                        "file": "robot.yaml",
                        "line": 3,
                        "column": 46,
                        "end_column": 53,
                        "pointer": "/closures/0/frames/1",
                    }
                ],
                "notes": [],
            },
            {"path": "robots/hip", "ok": True, "diagnostics": [], "notes": []},
        ],
        "skipped": [],
    }


def test_every_rule_matches_report_schema() -> None:
    found = tuple(Diagnostic(code, "it is wrong", Place("r.yaml")) for code in REGISTRY)
    document = reports_to_json([Report("r", found)], strict=True)
    jsonschema.Draft202012Validator(report_schema()).validate(document)


@given(st.text(), st.text(), st.one_of(st.none(), st.text()), st.text())
def test_any_text_gives_valid_json(path: str, message: str, hint: str | None, pointer: str) -> None:
    found = Diagnostic("wrong-type", message, Place(path, 1, 1, 2, pointer), hint)
    document = json.loads(json.dumps(reports_to_json([Report(path, (found,))])).encode("utf-8"))
    jsonschema.Draft202012Validator(report_schema()).validate(document)


@pytest.mark.parametrize(
    "damage",
    [{"severity": "note"}, {"phase": "elsewhere"}, {"clause": "FRM-1"}, {"line": 0}, {"message": None}, {"more": 1}],
)
def test_report_schema_rejects_other_objects(damage: dict[str, object]) -> None:
    document = reports_to_json([Report("r", (UNKNOWN,))])
    document["robots"][0]["diagnostics"][0].update(damage)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.Draft202012Validator(report_schema()).validate(document)


def test_only_advice_has_no_clause_and_is_warning() -> None:
    own = {code for code in REGISTRY if code.startswith("x-")}
    assert own == {code for code, rule in REGISTRY.items() if rule.clause is None}
    assert own == {code for code, rule in REGISTRY.items() if rule.phase is Phase.ADVICE}
    assert {REGISTRY[code].severity for code in own} <= {Severity.WARNING}


@pytest.mark.parametrize("name", sorted(output_schemas()))
def test_published_output_schemas_are_current(name: str) -> None:
    schema = output_schemas()[name]
    jsonschema.Draft202012Validator.check_schema(schema)
    written = (SCHEMAS / name).read_text(encoding="utf-8")
    assert written == schema_text(schema), "run python -m eurdf.commands.output schema"


def test_line_of_a_million_characters_is_fast() -> None:
    line, _ = at("[" + "a, " * 400_000 + "]", 600_001)
    assert len(line) < 120
