"""The cases: what they say, and how they are read. `.ci/run` sees how the reference answers them."""

import base64
import json
import posixpath
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from pydantic import ValidationError

from eurdf_conformance.comparison.text import same_text
from eurdf_conformance.corpus import archive, expect, show
from eurdf_conformance.corpus.case import CASE, SCHEMA_FILE, InvalidCase, ValidCase, case_schema, schema_text
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.coverage import missing
from eurdf_conformance.corpus.expect import stale
from eurdf_conformance.corpus.expected import Expected, expected_text
from eurdf_conformance.corpus.lint import lint
from eurdf_conformance.corpus.protocol_rule import OF_RUNNERS, RULES
from eurdf_conformance.corpus.read import CorpusCase, NotACase, all_cases, read_case
from eurdf_conformance.corpus.release import case_files
from eurdf_conformance.level import Level
from eurdf_conformance.strict_yaml import load_strictly

ROOT = Path(__file__).parents[2]
CASES = all_cases()
VALID = [case for case in CASES if isinstance(case.case, ValidCase)]


# The cases of the suite


@pytest.mark.slow
def test_the_lint_finds_nothing_wrong_with_the_cases() -> None:
    assert [str(error) for error in lint()] == []


def test_the_case_schema_is_current_and_accepts_every_case() -> None:
    assert SCHEMA_FILE.read_text(encoding="utf-8") == schema_text()
    validator = jsonschema.Draft202012Validator(case_schema())
    for case in CASES:
        assert list(validator.iter_errors(load_strictly(case.path.read_text(encoding="utf-8")))) == [], case.name


def test_a_written_expectation_reads_back_the_same() -> None:
    for case in VALID:
        again = Expected.model_validate_json(expected_text(case.expected))
        assert again == case.expected


def test_every_testable_clause_has_cases() -> None:
    elsewhere = {clause for rule in RULES for clause in rule.clauses} | set(OF_RUNNERS)
    assert list(missing([case.case for case in CASES], read_clauses(), elsewhere)) == []


# One case

VALID_CASE: dict[str, Any] = {
    "id": "ab12cd",
    "title": "A sentence.",
    "version": "2",
    "clauses": ["EU-FRM-001"],
    "valid": True,
    "files": {"robot.yaml": "extended_urdf: '2.0'\n", "robot.urdf": "<robot/>\n"},
}
INVALID_CASE = {key: value for key, value in VALID_CASE.items() if key != "files"} | {
    "valid": False,
    "code": "unknown-frame",
    "place": {"file": "robot.yaml", "line": 1, "column": 1},
    "twin": "frames/sound",
    "edit": {"file": "robot.yaml", "replace": "2.0", "with": "3.0"},
    "fix": "Mend it.",
}


def test_case_is_valid_or_states_its_error() -> None:
    assert isinstance(CASE.validate_python(VALID_CASE), ValidCase)
    assert isinstance(CASE.validate_python(INVALID_CASE), InvalidCase)


@pytest.mark.parametrize(
    "said",
    [
        VALID_CASE | {"id": "AB12CD"},
        VALID_CASE | {"id": "ab12c"},
        VALID_CASE | {"id": 123456},
        VALID_CASE | {"title": "No sentence"},
        VALID_CASE | {"version": 2},
        VALID_CASE | {"version": "2.0"},
        VALID_CASE | {"clauses": []},
        VALID_CASE | {"clauses": ["EU-FRM-1"]},
        VALID_CASE | {"code": "unknown-frame"},
        VALID_CASE | {"twin": "frames/sound"},
        VALID_CASE | {"base": "../sound"},
        VALID_CASE | {"edits": [{"file": "robot.yaml", "rename": "a.yaml"}]},
        VALID_CASE | {"robot": "four_bar"},
        VALID_CASE | {"files": {"../robot.yaml": ""}},
        VALID_CASE | {"files": {"robot.yaml": {"hex": "f"}}},
        VALID_CASE | {"files": {"robot.yaml": {"repeat": "a", "times": 1}}},
        VALID_CASE | {"colour": "red"},
        VALID_CASE | {"valid": "yes"},
        VALID_CASE | {"configurations": [{"j": 1.0}]},
        VALID_CASE | {"configurations": [{"j": [float("nan")]}]},
        VALID_CASE | {"provenance": {"expectation": "reference"}},
        VALID_CASE | {"description": "../robot.yaml"},
        INVALID_CASE | {"configurations": []},
        INVALID_CASE | {"code": "Unknown frame"},
        INVALID_CASE | {"place": {"file": "robot.yaml", "line": 0, "column": 1}},
        INVALID_CASE | {"place": {"file": "robot.yaml", "line": 1}},
        INVALID_CASE | {"place": {"file": "robot.yaml", "column": 1}},
        INVALID_CASE | {"files": {}},
        INVALID_CASE | {"edit": {"file": "robot.yaml", "replace": "", "with": "a"}},
        INVALID_CASE | {"edit": {"file": "robot.yaml", "replace": "a", "with": "a"}},
        INVALID_CASE | {"edit": {"file": "robot.yaml", "replace": "a", "rename": "b"}},
        {key: value for key, value in INVALID_CASE.items() if key != "fix"},
        {key: value for key, value in INVALID_CASE.items() if key != "twin"},
    ],
    ids=str,
)
def test_a_file_that_is_not_a_case_is_refused(said: object) -> None:
    with pytest.raises(ValidationError):
        CASE.validate_python(said)


WriteCase = Callable[[str], Path]


@pytest.fixture
def written(tmp_path: Path) -> WriteCase:
    """Writes a case, beside `frames/sound`, and gives its file."""

    def write(text: str) -> Path:
        folder = tmp_path / "frames"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "sound.yaml").write_text(json.dumps(VALID_CASE), encoding="utf-8")
        (folder / "one.yaml").write_text(text, encoding="utf-8")
        return folder / "one.yaml"

    return write


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "object"),
        ("id: [", "while parsing"),
        (json.dumps(VALID_CASE)[:-1] + ', "title": "Twice."}', "duplicate key"),
        (json.dumps(INVALID_CASE | {"place": {"file": "robot.yaml", "line": "x"}}), "place/line"),
    ],
)
def test_a_file_without_a_case_gives_the_reason(written: WriteCase, text: str, why: str) -> None:
    with pytest.raises(NotACase, match=why) as caught:
        read_case(written(text))
    assert caught.value.path.name == "one.yaml"


def test_a_case_names_its_files(written: WriteCase) -> None:
    case = read_case(written(json.dumps(VALID_CASE | {"description": "other.yml", "urdf": "sub/other.urdf"})))
    assert (case.topic, case.name) == ("frames", "frames/one")
    assert (case.description, case.urdf) == (case.folder / "other.yml", case.folder / "sub" / "other.urdf")


def test_a_number_with_an_exponent_is_read_as_one(written: WriteCase) -> None:
    text = "id: ab12cd\ntitle: One.\nversion: '2'\nclauses: [EU-FRM-001]\nvalid: true\n"
    text += "configurations: [{j: [1e-3, -2E5, +3, .5, 4.]}]\n"
    case = read_case(written(text)).case
    assert isinstance(case, ValidCase)
    assert case.configurations == [{"j": [1e-3, -2e5, 3, 0.5, 4.0]}]


def test_a_case_runs_at_its_possible_levels(written: WriteCase) -> None:
    levels = {
        "valid": read_case(written(json.dumps(VALID_CASE))).levels,
        "evaluated": read_case(written(json.dumps(VALID_CASE | {"configurations": [{}]}))).levels,
        "invalid": read_case(written(json.dumps(INVALID_CASE))).levels,
    }
    assert levels == {
        "valid": ("accept", "structure", "diagnose"),
        "evaluated": ("accept", "structure", "kinematics", "dynamics", "diagnose"),
        "invalid": ("accept", "diagnose"),
    }


def test_show_prints_the_edit_and_writes_the_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert show.main(["urdf/damping-fortran-exponent", "--out", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert '-    <dynamics damping="0.15" friction="0.16"/>\n+    <dynamics damping="1.5d-1" friction="0.16"/>\n' in out
    assert "invalid: urdf-bad-number at robot.urdf:79:24" in out
    assert "1.5d-1" in (tmp_path / "robot.urdf").read_text(encoding="utf-8")
    with pytest.raises(SystemExit):
        show.main(["urdf/nothing"])


# Expectations


def evaluated_case(tmp_path: Path) -> CorpusCase:
    """A copy of a case that is evaluated."""
    alone = (case for case in VALID if case.case.files and case.origin is None and not case.case.provenance.note)
    case = next(case for case in alone if Level.KINEMATICS in case.levels)
    path = tmp_path / f"{case.name}.yaml"
    path.parent.mkdir(parents=True)
    path.write_bytes(case.path.read_bytes())
    path.with_suffix(".expected.json").write_bytes(case.expectation.read_bytes())
    return read_case(path)


def said_by_hand(case: CorpusCase) -> CorpusCase:
    """The same case, of which values are expected by hand."""
    text = case.path.read_text(encoding="utf-8")
    case.path.write_text(text + "provenance: {expectation: hand}\n", encoding="utf-8")
    return read_case(case.path)


def test_a_changed_number_makes_an_expectation_stale(tmp_path: Path) -> None:
    case = evaluated_case(tmp_path)
    path = case.expectation
    assert list(stale(case)) == []
    said = json.loads(path.read_text(encoding="utf-8"))
    for pointer, change in {
        "/values/0/mass": lambda: said["values"][0].update(mass=said["values"][0]["mass"] + 1e-6),
        "/sizes/0": lambda: said["sizes"].__setitem__(0, said["sizes"][0] * 1.01),
        "/name": lambda: said["robot"].update(name="another"),
        "bodies": lambda: said["bodies"].append(["another"]),
        "sizes: 1": lambda: said["sizes"].pop(),
    }.items():
        change()
        path.write_text(json.dumps(said), encoding="utf-8")
        assert any(pointer in error for error in stale(read_case(case.path))), pointer


def test_partial_values_by_hand_are_checked_against_the_oracle(tmp_path: Path) -> None:
    case = evaluated_case(tmp_path)
    case = said_by_hand(case)
    some = case.expected.model_dump(mode="json")
    some["values"] = [{"mass": values["mass"]} for values in some["values"]]
    case.expectation.write_text(json.dumps(some), encoding="utf-8")
    assert list(stale(read_case(case.path))) == []
    some["values"][0]["mass"] *= 2
    case.expectation.write_text(json.dumps(some), encoding="utf-8")
    assert any("/values/0/mass" in error for error in stale(read_case(case.path)))


def test_expect_rewrites_stale_expectations_but_none_by_hand(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    case = evaluated_case(tmp_path)
    path, right = case.expectation, case.expectation.read_text(encoding="utf-8")
    wrong = right.replace('"mass": ', '"mass": 1')
    monkeypatch.setattr(expect, "read_cases", lambda: [read_case(case.path)])

    def main(*arguments: str) -> tuple[int, str]:
        return expect.main(arguments), path.read_text(encoding="utf-8") if path.exists() else ""

    path.unlink()
    assert main("--check") == (1, "")
    code, written = main(case.name)
    assert code == 0
    # What the oracle computes may have other last digits on this processor; they are rounded to 12.
    assert same_text(written, right, relative=1e-9, absolute=1e-11)
    path.write_text(right + "\n", encoding="utf-8")
    assert main() == (0, right + "\n")
    path.write_text(wrong, encoding="utf-8")
    assert main("--check") == (1, wrong)
    assert "/values/0/mass" in capsys.readouterr().out
    assert main() == (0, written)
    said_by_hand(case)
    path.write_text(wrong, encoding="utf-8")
    assert main() == (1, wrong)
    with pytest.raises(SystemExit):
        main("nobody")


# The archive


@pytest.mark.slow
def test_the_archive_is_complete_and_reproducible(tmp_path: Path) -> None:
    some = CASES[::30]
    for folder, cases in ("a", some), ("b", reversed(some)), ("whole", CASES):
        archive.write_archive(tmp_path / folder, cases)
    zips = [(tmp_path / folder / f"{archive.NAME}.zip").read_bytes() for folder in "ab"]
    assert zips[0] == zips[1]
    assert_manifest_contains_every_case(tmp_path / "whole" / f"{archive.NAME}.json")
    with zipfile.ZipFile(tmp_path / "whole" / f"{archive.NAME}.zip") as whole:
        names = set(whole.namelist())
        assert {info.date_time for info in whole.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        for case in CASES:
            for name, content in case_files(case):
                assert whole.read(name) == content
                names.remove(name)
        schemas = {f"schema/{path.name}" for path in (ROOT / "schema").glob("extended-urdf-*.schema.json")}
        schemas |= {f"{name}.schema.json" for name in ("case", "index", "expected")}
        assert names == {"README.md", "LICENSE", "clauses.json", "index.json"} | schemas
        registry = json.loads(whole.read("clauses.json"))
        assert {entry["id"]: entry["text"] for entry in registry["clauses"]} == {
            id_: each.text for id_, each in read_clauses().items()
        }
        tested = {(entry["id"], case) for entry in registry["clauses"] for case in entry["cases"]}
        assert tested == {(clause, case.name) for case in CASES for clause in case.case.clauses}
        assert {entry["code"] for entry in registry["diagnostics"]} >= {
            case.case.code for case in CASES if isinstance(case.case, InvalidCase)
        }
        assert whole.read("LICENSE") == (ROOT / "LICENSE").read_bytes()


def test_links_in_the_zip_lead_to_its_own_files(tmp_path: Path) -> None:
    archive.write_archive(tmp_path, VALID[:3])
    with zipfile.ZipFile(tmp_path / f"{archive.NAME}.zip") as whole:
        for case in VALID[:3]:
            name = f"cases/{case.name}.yaml"
            link = whole.read(name).decode().splitlines()[0].partition("$schema=")[2]
            schema = posixpath.normpath(posixpath.join(posixpath.dirname(name), link))
            assert whole.read(schema) == SCHEMA_FILE.read_bytes()
        readme = whole.read("README.md").decode()
        clauses = {entry["id"] for entry in json.loads(whole.read("clauses.json"))["clauses"]}
        assert set(re.findall(r"EU-[A-Z]{3}-[0-9]{3}", readme)) <= clauses
        named = set(re.findall(r"(?<!>)(?<!>\.)\b[\w.]+\.(?:json|yaml)\b", readme))
        assert named <= {Path(name).name for name in whole.namelist()}
    assert all(re.search(rf"^- `{level}`: ", readme, re.MULTILINE) for level in Level)


def archived(*arguments: str | Path) -> int:
    return archive.main(list(map(str, arguments)))


def test_the_archive_lists_its_files_and_overwrites_nothing_unasked(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archive, "read_cases", lambda: CASES[:3])
    out = tmp_path / "new" / "out"
    assert archived(out) == 0
    assert capsys.readouterr().out.splitlines() == [
        f"{out / archive.NAME}.zip: 3 cases",
        f"{out / archive.NAME}.json: the same as one JSON value",
    ]
    (out / f"{archive.NAME}.zip").unlink()
    (out / f"{archive.NAME}.json").write_text("mine", encoding="utf-8")
    assert archived(out) == 2
    assert "already exists; --force replaces it" in capsys.readouterr().err
    assert [path.read_text() for path in out.iterdir()] == ["mine"]
    assert archived(out, "--force") == 0
    assert len(list(out.iterdir())) == 2


def test_unwritable_archive_gives_one_line_and_no_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(archive, "read_cases", lambda: CASES[:3])
    Path("file").write_text("mine", encoding="utf-8")
    Path("out", f"{archive.NAME}.json").mkdir(parents=True)
    for wrong in (["file"], ["file/out"], ["out"], ["out", "--force"]):
        assert archived(*wrong) == 2
        written = capsys.readouterr()
        assert (written.out, written.err.count("\n")) == ("", 1)
        assert not list(Path("out").glob("*.zip"))
    with pytest.raises(SystemExit) as shown:
        archived("--help")
    assert shown.value.code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "out"]


def assert_manifest_contains_every_case(path: Path) -> None:
    manifest = json.loads(path.read_text(encoding="utf-8"))
    assert [entry["name"] for entry in manifest["cases"]] == [case.name for case in CASES]
    for entry, case in zip(manifest["cases"], CASES, strict=True):
        said = case.case.model_dump(mode="json", exclude_none=True)
        assert said | entry["case"] == said
        assert (entry["expected"] is None) == isinstance(case.case, InvalidCase)
        for name, content in case.files.items():
            text = entry["files"][name]
            assert (base64.b64decode(text["base64"]) if isinstance(text, dict) else text.encode()) == content
    assert set(manifest["clauses"]) == {clause for case in CASES for clause in case.case.clauses}


def test_the_manifest_contains_binary_and_missing_files(written: WriteCase) -> None:
    edit = {"file": "robot.urdf", "rename": "other.urdf"}
    path = written(json.dumps(INVALID_CASE | {"edit": edit}))
    (entry,) = archive.manifest([read_case(path)])["cases"]
    assert entry["files"] == {
        "robot.yaml": VALID_CASE["files"]["robot.yaml"],
        "robot.urdf": None,
        "other.urdf": "<robot/>\n",
    }
    path = written(json.dumps(VALID_CASE | {"files": {"robot.yaml": ["a: ", {"hex": "ff"}]}}))
    assert read_case(path).files == {"robot.yaml": b"a: \xff"}
