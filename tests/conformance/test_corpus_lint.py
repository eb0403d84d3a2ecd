"""The lint of the cases: each of its rules is broken by a fixture, and found."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from eurdf_conformance.corpus import lint
from eurdf_conformance.corpus.case import CASE, Case
from eurdf_conformance.corpus.clause import Clause, read_clauses
from eurdf_conformance.corpus.coverage import UNSAID, missing, said_in
from eurdf_conformance.corpus.lines import lines_of
from eurdf_conformance.corpus.one_edit import edit_errors, lines_edited
from eurdf_conformance.corpus.read import read_cases
from eurdf_conformance.level import VERSIONS, Version

FIXTURES = Path(__file__).parents[1] / "data" / "conformance_lint"
BROKEN = sorted(path.parent.name for path in FIXTURES.glob("*/fault.txt"))


@pytest.fixture
def cases(tmp_path: Path) -> Callable[[str], Path]:
    """The sound cases, with the files of a fixture laid over them."""

    def lay(name: str) -> Path:
        shutil.copytree(FIXTURES / "sound", tmp_path, dirs_exist_ok=True)
        shutil.copytree(FIXTURES / name, tmp_path, dirs_exist_ok=True, ignore=shutil.ignore_patterns("fault.txt"))
        return tmp_path

    return lay


def test_sound_cases_have_no_fault(cases: Callable[[str], Path]) -> None:
    assert lint.lint(cases("sound")) == []


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_rule_is_found_and_no_other(name: str, cases: Callable[[str], Path]) -> None:
    """The name of a fixture begins with that of the rule; `fault.txt` is what is said of it."""
    faults = lint.lint(cases(name))
    assert {fault.rule for fault in faults} == {name.partition("-")[0]}
    says = (FIXTURES / name / "fault.txt").read_text(encoding="utf-8").strip()
    assert any(says in fault.message for fault in faults), [str(fault) for fault in faults]


def test_every_rule_has_a_fixture_that_breaks_it() -> None:
    assert {name.partition("-")[0] for name in BROKEN} == {"folder", "schema", *lint.RULES_OF_CASES}


def test_the_command_says_what_is_wrong_and_what_is_not_tested(
    cases: Callable[[str], Path], capsys: pytest.CaptureFixture[str]
) -> None:
    root = str(cases("sound"))
    assert lint.main([root]) == 0
    out = capsys.readouterr().out
    for version in VERSIONS:
        assert f"missing: EU-FRM-001 (version {version}): a valid case, an invalid case (unknown-frame)" in out
    assert "EU-ACT-001 (version 1)" in out
    assert "EU-ACT-001 (version 2)" not in out
    assert lint.main([root, "--complete"]) == 1
    assert lint.main([str(cases("title-twice"))]) == 1
    assert "title: another case has the same title" in capsys.readouterr().out


# One edit


@pytest.mark.parametrize(
    ("one", "other", "edited"),
    [
        ("a\nb\nc\n", "a\nb\nc\n", (0, 0)),
        ("a\nb\nc\n", "a\nx\nc\n", (1, 1)),
        ("a\nb\nc\n", "a\nc\n", (1, 0)),
        ("a\na\na\n", "a\na\n", (1, 0)),
        ("a\nc\n", "a\nb\nb\nc\n", (0, 2)),
        ("a\nb\nc\nd\n", "x\nb\nc\ny\n", (4, 4)),
        ("a\nb\n", "a\r\nb\n", (1, 1)),
        ("", "a\n", (0, 1)),
        ("a", "a\n", (1, 1)),
    ],
)
def test_lines_between_what_begins_and_what_ends_alike(
    tmp_path: Path, one: str, other: str, edited: tuple[int, int]
) -> None:
    paths = tmp_path / "one", tmp_path / "other"
    for path, text in zip(paths, (one, other), strict=True):
        path.write_bytes(text.encode())
    assert lines_edited(*paths) == edited
    assert lines_edited(*reversed(paths)) == edited[::-1]


def test_a_file_that_is_not_there_is_no_edit(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text("urdf: nowhere.urdf\n", encoding="utf-8")
    (tmp_path / "twin.yaml").write_text("urdf: robot.urdf\n", encoding="utf-8")
    (tmp_path / "robot.urdf").write_text("<robot/>\n", encoding="utf-8")
    files, twin = (
        (tmp_path / "robot.yaml", tmp_path / "nowhere.urdf"),
        (tmp_path / "twin.yaml", tmp_path / "robot.urdf"),
    )
    assert edit_errors(files, twin) == []


def test_lines_end_at_any_line_end_and_a_byte_order_mark_is_none_of_them(tmp_path: Path) -> None:
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
        "provenance": {"expectation": "hand"},
    }
    place = {"file": "robot.yaml"}
    if code is not None:
        said |= {"code": code, "place": place, "twin": "ef34gh", "repair": "Mend it."}
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
def test_what_is_missing_for_a_clause(clauses: dict[str, Clause], cases: list[Case], lacks: list[str]) -> None:
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
def test_a_case_of_one_version_tests_a_clause_in_that_one_alone(cases: list[Case], lacks: list[str]) -> None:
    found = list(missing(cases, clause(codes=("one",), versions=VERSIONS)))
    assert found == [f"EU-FRM-001 (version {version}): {lack}" for version, lack in zip(VERSIONS, lacks, strict=True)]


def test_a_version_that_cannot_say_a_clause_needs_no_case_and_has_none() -> None:
    clauses = read_clauses()
    for name, why in UNSAID.items():
        assert set(said_in(clauses[name])) == set(clauses[name].versions) - set(why) != set(clauses[name].versions)
        assert not any(f"version {version}" in line for line in missing([], {name: clauses[name]}) for version in why)
        citing = {case.case.version for case in read_cases() if name in case.case.clauses}
        assert citing.isdisjoint(why), f"{name} can be said in a version of which it is said that it cannot"


def test_the_registry_of_clauses_is_read() -> None:
    clauses = read_clauses()
    one = clauses["EU-CLO-003"]
    assert (one.must, one.codes, one.level, one.testable) == (True, {"closure-same-body"}, "accept", True)
    assert not clauses["EU-CNF-006"].testable
    assert clauses["EU-ONE-003"].versions == ("1",)
