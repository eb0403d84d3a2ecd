"""The lint of the cases: each of its rules is broken by a fixture, and found."""

import shutil
from pathlib import Path

import pytest

from eurdf_conformance.corpus import lint
from eurdf_conformance.corpus.case import CASE, Case
from eurdf_conformance.corpus.clause import Clause, read_clauses
from eurdf_conformance.corpus.coverage import UNSAID, missing, said_in
from eurdf_conformance.corpus.lines import lines_of
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.level import Version

SOUND = Path(__file__).parent / "lint_cases"
VALID, INVALID, EXPECTED = (
    f"actuation/{name}"
    for name in ("motor-on-a-joint.yaml", "motor-on-no-joint.yaml", "motor-on-a-joint.expected.json")
)


def laid(root: Path, file: str = VALID, old: str = "", new: str = "") -> Path:
    """The sound cases, in one file of which one text is replaced."""
    shutil.copytree(SOUND, root, dirs_exist_ok=True)
    text = (root / file).read_text(encoding="utf-8")
    assert old in text
    (root / file).write_text(text.replace(old, new, 1), encoding="utf-8")
    return root


def test_valid_cases_have_no_lint_errors(tmp_path: Path) -> None:
    assert lint.lint(laid(tmp_path)) == []


#: The rules that are broken, what is replaced in which file, and what is said of it.
BROKEN = [
    ("case", INVALID, "title: A motor on no joint.\n", "", "title: Field required"),
    ("case", INVALID, "motor-on-a-joint", "none", "there is no case actuation/none"),
    ("case", INVALID, "motor-on-a-joint", "motor-on-no-joint", "actuation/motor-on-no-joint is not valid"),
    ("case", INVALID, "replace: motor", "replace: engine", "the edit changes nothing"),
    ("case", INVALID, "replace: motor", "replace: wheel", "occurs 0 times in 'robot.yaml', expected once: 'wheel'"),
    ("case", INVALID, "robot.yaml, replace", "robot.yaml, line: 2, replace", "0 times in line 2 of 'robot.yaml'"),
    ("case", INVALID, "robot.yaml, replace", "other.yaml, replace", "there is no file 'other.yaml' to edit"),
    ("id", INVALID, "id: bad001", "id: good01", "another case has the id 'good01'"),
    ("title", INVALID, "on no joint", "on a joint", "another case of version 2 has the same title"),
    ("clauses", VALID, "[EU-ACT-001]", "[EU-ACT-001, EU-ONE-003]", "EU-ONE-003 is no clause of version 2"),
    ("clauses", VALID, "[EU-ACT-001]", "[EU-ACT-001, EU-ACT-001]", "a clause is listed twice"),
    ("clauses", VALID, "[EU-ACT-001]", "[EU-ACT-001, EU-ACT-999]", "there is no clause EU-ACT-999"),
    ("code", INVALID, "fix:", "either: true\nfix:", "`either` is for the errors"),
    ("code", INVALID, "unknown-actuator", "unknown-frame", "'unknown-frame' is the code of no MUST"),
    (
        "code",
        VALID,
        "files:",
        "warnings: [{code: unknown-frame, place: {file: robot.yaml}}]\nfiles:",
        "'unknown-frame' is the code of no warning",
    ),
    ("twin", INVALID, 'version: "2"', 'version: "1"', "the twin is of version 2"),
    (
        "place twin",
        INVALID,
        "edit: {file: robot.yaml, replace: motor, with: engine}",
        r'edit: {file: robot.yaml, replace: "extended_urdf: \"2.0\"\nactuators:\n  - motor\n", with: "a: 1\n"}',
        "the edit replaces more than 2 lines",
    ),
    ("case", VALID, "files:", "edits: [{file: robot.yaml, rename: a.yaml}]\nfiles:", "of the files of a `base`"),
    ("files", VALID, "files:", "urdf: nowhere.urdf\nfiles:", "there is no file nowhere.urdf"),
    (
        "files expected",
        VALID,
        '<link name="base"/>',
        '<link name="base"><visual><geometry><mesh filename="base.stl"/></geometry></visual></link>',
        "there is no file base.stl",
    ),
    ("place", INVALID, "column: 5", "column: 13", "line 3 of 'robot.yaml' has no column 13"),
    ("place", INVALID, "line: 3", "line: 5", "'robot.yaml' has 4 lines, no line 5"),
    ("place", INVALID, "place: {file: robot.yaml", "place: {file: a.yaml", "'a.yaml' is not a file of the case"),
    (
        "expected loops",
        VALID,
        "actuators:",
        "closures: [{name: a, type: 3d, frames: [base, {link: arm, xyz: [1, 0, 0]}]}]\n    actuators:",
        "the least search does not close the loops",
    ),
    ("expected", EXPECTED, '"name": "arm"', '"name": "leg"', "/name: name of the robot"),
    ("expected", EXPECTED, "bodies", "corpses", "ValidationError"),
]


@pytest.mark.parametrize(("rules", "file", "old", "new", "says"), BROKEN, ids=[f"{row[0]}-{row[4]}" for row in BROKEN])
def test_a_violated_lint_rule_is_reported_alone(
    rules: str, file: str, old: str, new: str, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lint, "LINES", 2)
    errors = lint.lint(laid(tmp_path, file, old, new))
    assert {error.rule for error in errors} == set(rules.split())
    assert any(says in error.message for error in errors), [str(error) for error in errors]


@pytest.mark.parametrize(
    "path", ["actuation/notes.txt", "cranes/crane.yaml", "actuation/motors/deep.yaml", "actuation/Motor_2.yaml"]
)
def test_a_file_that_is_not_a_case_is_reported(path: str, tmp_path: Path) -> None:
    stray = laid(tmp_path) / path
    stray.parent.mkdir(exist_ok=True)
    stray.touch()
    assert [(error.path, error.rule) for error in lint.lint(tmp_path)] == [(stray, "name")]


def test_every_lint_rule_has_a_row_that_violates_it() -> None:
    assert {rule for rules, *_ in BROKEN for rule in rules.split()} == {"case", *lint.RULES_OF_CASES}


def test_the_lint_command_lists_errors_and_missing_cases(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = str(laid(tmp_path))
    assert lint.main([root]) == 0
    out = capsys.readouterr().out
    for version in ("1", "2"):
        assert f"missing: EU-FRM-001 (version {version}): a valid case, an invalid case (unknown-frame)" in out
    assert "EU-ACT-001 (version 1)" in out
    assert "EU-ACT-001 (version 2)" not in out
    assert lint.main([root, "--complete"]) == 1
    assert lint.main([str(laid(tmp_path, INVALID, "on no joint", "on a joint"))]) == 1
    assert "title: another case of version 2 has the same title" in capsys.readouterr().out


# The lines of a file


def test_lines_end_at_any_line_break_without_byte_order_mark(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_bytes("\ufeffa\rb\r\nc\u2028d\ne".encode())
    assert lines_of(path) == ["a", "b", "c\u2028d", "e"]
    assert lines_of(tmp_path / "nowhere") == []


# Coverage


def case(clause: str, code: str | None = None, warning: str | None = None, version: Version = "2") -> Case:
    said: dict[str, object] = {
        "id": "ab12cd",
        "title": "One.",
        "version": version,
        "clauses": [clause],
        "valid": code is None,
    }
    place = {"file": "robot.yaml"}
    if code is not None:
        edit = {"file": "robot.yaml", "rename": "other.yaml"}
        said |= {"code": code, "place": place, "twin": "urdf/sound", "edit": edit, "fix": "Mend it."}
    if warning is not None:
        said["warnings"] = [{"code": warning, "place": place}]
    return CASE.validate_python(said)


def clause(
    keyword: str = "MUST", codes: tuple[str, ...] = (), testable: bool = True, versions: tuple[Version, ...] = ("2",)
) -> dict[str, Clause]:
    return {"EU-FRM-001": Clause("EU-FRM-001", keyword, "", "accept", versions, frozenset(codes), testable)}


@pytest.mark.parametrize(
    ("clauses", "cases", "lacks"),
    [
        (clause(), [], ["a case"]),
        (clause(), [case("EU-FRM-001")], []),
        (clause(), [case("EU-FRM-001", code="any")], []),
        (clause(testable=False), [], []),
        (clause("SHOULD"), [], []),
        (clause(codes=("one",)), [], ["a valid case", "an invalid case (one)"]),
        (clause(codes=("one",)), [case("EU-FRM-001"), case("EU-FRM-001", code="other")], ["an invalid case (one)"]),
        (clause(codes=("one",)), [case("EU-FRM-002"), case("EU-FRM-001", code="one")], ["a valid case"]),
        (clause(codes=("one",)), [case("EU-FRM-001"), case("EU-FRM-001", code="one")], []),
        (clause("SHOULD NOT", codes=("one",)), [case("EU-FRM-001")], ["a valid case with the warning one"]),
        (clause("SHOULD NOT", codes=("one",)), [case("EU-FRM-001", warning="one")], []),
    ],
)
def test_cases_missing_for_a_clause_are_listed(clauses: dict[str, Clause], cases: list[Case], lacks: list[str]) -> None:
    found = list(missing(cases, clauses))
    assert found == ([f"EU-FRM-001 (version 2): {', '.join(lacks)}"] if lacks else [])
    assert list(missing(cases, clauses, elsewhere=["EU-FRM-001"])) == []


@pytest.mark.parametrize(
    ("cases", "lacks"),
    [
        ([case("EU-FRM-001"), case("EU-FRM-001", version="1")], ["an invalid case (one)", "an invalid case (one)"]),
        ([case("EU-FRM-001"), case("EU-FRM-001", code="one", version="1")], ["a valid case", "an invalid case (one)"]),
    ],
)
def test_a_case_tests_a_clause_in_its_version_only(cases: list[Case], lacks: list[str]) -> None:
    found = list(missing(cases, clause(codes=("one",), versions=("1", "2"))))
    assert found == [f"EU-FRM-001 (version {version}): {lack}" for version, lack in zip(("1", "2"), lacks, strict=True)]


def test_a_clause_that_a_version_cannot_express_has_no_case() -> None:
    clauses = read_clauses()
    for name, why in UNSAID.items():
        stated = set(clauses[name].versions) - {"2.1"}
        assert set(said_in(clauses[name])) == stated - set(why) != stated
        assert not any(f"version {version}" in line for line in missing([], {name: clauses[name]}) for version in why)
        citing = {case.case.version for case in all_cases() if name in case.case.clauses}
        assert citing.isdisjoint(why), f"{name} can be said in a version of which it is said that it cannot"


def test_the_registry_of_clauses_is_read() -> None:
    clauses = read_clauses()
    one = clauses["EU-CLO-003"]
    assert (one.must, one.codes, one.level, one.testable) == (True, {"closure-same-body"}, "accept", True)
    assert not clauses["EU-CNF-006"].testable
    assert clauses["EU-ONE-003"].versions == ("1",)
