"""The command ``eurdf certify``."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from eurdf.commands.main import main
from eurdf_conformance.certificate.certificate import certificate_schema, read_certificate
from eurdf_conformance.certificate.issue import issue
from eurdf_conformance.command.output import show
from eurdf_conformance.command.replay import replay_schema
from eurdf_conformance.corpus.case import InvalidCase
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.suite.item import planned_items
from eurdf_conformance.suite.smoke import smoke_lines
from parsers.sessions import fake
from suite_runs import INVALID, PLANNED, VALID, item, result, run
from support.processes import on_a_terminal
from support.session import SharedRun
from support.warm import run_module

Run = Callable[..., SharedRun]

REFERENCE = "eurdf_conformance.adapters.reference:PARSER"

#: Failures that are shown, so many at most.
MOST_SHOWN = 20

#: What is tested where it does not matter what.
SOME = ("--level", "accept", "--format-version", "2.1", "--seed", "0", "--jobs", "0")
SOME_CASES = [case for case in all_cases() if case.case.version == "2.1"]
NAMES = {case.name for case in SOME_CASES}

ACCEPTS, REJECTS = fake("always_accepted"), fake("always_rejected")


def certify(*argv: str | Path, **environment: str) -> subprocess.CompletedProcess[str]:
    # The suite runs pytest, which no test of pytest can do within its own process.
    return run_module("eurdf", ["certify", *map(str, argv)], environment=os.environ | environment)


def certificate_of(*argv: str | Path) -> dict[str, Any]:
    done = certify(*argv, "--json")
    assert done.returncode in (0, 1), done.stderr
    value: dict[str, Any] = json.loads(done.stdout)
    return value


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


# --- what it says ----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_reference_is_certified_at_every_level_of_a_version(shared_run: Run) -> None:
    """`.ci/run` does so with every version."""
    done = shared_run("--parser", REFERENCE, "--format-version", "2.1", "--seed", "0", "--date", "2026-01-31")
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert done.stdout.endswith(": Certified for version 2.1: all levels\n")
    certificate = read_certificate(Path(done.certificate))
    assert (certificate.certified, certificate.failures, certificate.date) == (True, (), "2026-01-31")
    asked = {(level.version, level.level): level.items for level in certificate.levels if level.version == "2.1"}
    planned = Counter((item.version, item.level) for item in planned_items(all_cases()) if item.version == "2.1")
    assert asked == planned


@pytest.mark.slow
@pytest.mark.parametrize("accepts", [True, False])
def test_parser_of_one_answer_fails_exactly_the_cases_of_the_other(accepts: bool, shared_run: Run) -> None:
    certificate = read_certificate(Path(shared_run("--parser", ACCEPTS if accepts else REJECTS, *SOME).certificate))
    failed = {failure.id for failure in certificate.failures}
    invalid = {case.name: case.case for case in SOME_CASES if isinstance(case.case, InvalidCase)}
    wrong = {name for name, case in invalid.items() if not case.either} if accepts else NAMES - invalid.keys()
    assert wrong <= failed
    assert not (NAMES - wrong) & failed
    assert not certificate.certified
    assert not any(level.certified for level in certificate.levels)


@pytest.mark.slow
def test_a_failure_is_shown_with_reason_and_command(shared_run: Run) -> None:
    done = shared_run("--parser", ACCEPTS, *SOME)
    assert done.returncode == 1
    assert sorted(path.name for path in Path(done.certificate).iterdir()) == [
        "badge.svg",
        "certificate.json",
        "report.html",
    ]
    shown = re.findall(r"^failed (\w+)/([\w-]+)/accept: \S", done.stdout, re.MULTILINE)
    assert len(shown) == MOST_SHOWN
    for topic, name in shown:
        assert f"-k {topic}/{name}/accept" in done.stdout
    assert re.search(r"^\d+ more failures", done.stdout, re.MULTILINE)
    assert done.stdout.endswith("always_accepted 1: Not certified at any level\n")


@pytest.mark.slow
def test_the_certificate_is_the_same_with_any_number_of_processes(folder: Path, shared_run: Run) -> None:
    alone = Path(shared_run("--parser", REJECTS, *SOME).certificate, "certificate.json")
    spread = certificate_of("--parser", REJECTS, *SOME[:-1], "2", "--certificate", "mine")
    jsonschema.Draft202012Validator(certificate_schema()).validate(spread)
    assert spread == json.loads(Path("mine/certificate.json").read_text(encoding="utf-8"))
    assert spread == json.loads(alone.read_text(encoding="utf-8"))


# --- a first try -----------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_first_try_distinguishes_wrong_adapter_from_wrong_parser(folder: Path) -> None:
    parser = certify("--parser", REJECTS, "--smoke")
    assert parser.returncode == 1
    assert parser.stdout.startswith("your adapter works so far")
    assert "your parser fails:" in parser.stdout
    told = '/accept: failed: /outcome: the parser rejects a valid description: expected "accepted", got "rejected"\n'
    assert told in parser.stdout
    adapter = certify("--parser", fake("always_rejected_with_chatter"), "--smoke")
    assert adapter.returncode == 1
    assert adapter.stdout.startswith("your adapter fails")


def test_a_smoke_run_names_the_verdict_before_the_reason() -> None:
    lacking = result(item(VALID, Level.ACCEPT), Verdict.UNSUPPORTED, "version 2")
    silent = result(item(INVALID, Level.ACCEPT), Verdict.SKIPPED)
    lines = list(smoke_lines([lacking, silent], asked=True))
    assert f"  {VALID}/accept: unsupported: version 2" in lines
    assert f"  {INVALID}/accept: skipped" in lines


def test_smoke_run_states_equal_failures_once_with_the_log() -> None:
    why = "the process ended with exit code 3 without answering"
    log = "crashed: ended with exit code 3 without answering\n  log: no file 'model.bin'"
    every = [item(VALID, Level.ACCEPT), item(INVALID, Level.ACCEPT), item("protocol/quiet-2", Level.ACCEPT)]
    wrong = [replace(result(each, Verdict.CRASHED, why), log=log) for each in every]
    assert list(smoke_lines(wrong, asked=True)) == [
        "your adapter fails:",
        f"  {VALID}/accept: crashed: {why}",
        "    log: no file 'model.bin'",
        f"    and so do 2 more: {INVALID}/accept, protocol/quiet-2/accept",
        f"    pytest conformance/ -k {VALID}/accept",
        "your parser was not tested any further: fix the adapter first",
    ]


@pytest.mark.slow
def test_a_smoke_run_works_in_a_terminal(folder: Path) -> None:
    code, seen = on_a_terminal(["-m", "eurdf", "certify", "--parser", REFERENCE, "--smoke"])
    assert (code, "certifying" in seen) == (0, True)


def test_exploration_reports_the_folder_of_its_cases(capsys: pytest.CaptureFixture[str]) -> None:
    law = item("properties/agreement-2", Level.ACCEPT)
    failed = result(law, Verdict.FAILED, "it is not so")
    show(issue(run(planned=(*PLANNED, law), results=(failed,), explore=20, seed=7)))
    assert "exploring from seed 7 writes each failing mechanism as a case into explored/" in capsys.readouterr().out
    show(issue(run(planned=(*PLANNED, law), results=(failed,))))
    assert "explor" not in capsys.readouterr().out


# --- known failures --------------------------------------------------------------------------------------------------


def known_failures(folder: Path, *ids: str) -> Path:
    file = folder / "known.yaml"
    entries = [f"- {{id: {id_}, level: accept, verdict: failed, reason: An open issue.}}\n" for id_ in ids]
    file.write_text("".join(entries), encoding="utf-8")
    return file


@pytest.mark.slow
def test_known_failures_are_counted_and_do_not_certify(folder: Path, shared_run: Run) -> None:
    certificate = read_certificate(Path(shared_run("--parser", REJECTS, *SOME).certificate))
    failed = [failure.id for failure in certificate.failures]
    file = known_failures(folder, *failed)
    done = certify("--parser", REJECTS, *SOME, "--known-failures", file)
    assert done.returncode == 1
    assert len(failed) > MOST_SHOWN
    assert done.stdout.count("failed (known) ") == MOST_SHOWN
    assert f"known failures: {len(failed)}" in done.stdout


@pytest.mark.slow
def test_bad_file_of_known_failures_is_refused_first(folder: Path) -> None:
    (folder / "known.yaml").write_text("- id: schema/compliance-empty\n", encoding="utf-8")
    done = certify("--parser", "cmd:nowhere", "--known-failures", "known.yaml")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("eurdf: known.yaml: [0].level: ")


# --- what does not run -----------------------------------------------------------------------------------------------


def test_a_parser_that_does_not_start_gives_exit_code_2(folder: Path) -> None:
    done = certify("--parser", f"cmd:{shlex.quote(sys.executable)} nowhere.py", "--seed", "0")
    assert (done.returncode, done.stdout) == (2, "")
    assert "nowhere.py" in done.stderr.splitlines()[0]
    assert "could not be started: crashed: ended with exit code 2" in done.stderr.splitlines()[1]


def test_missing_packages_of_the_suite_are_named(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("eurdf_conformance.command.certify.missing", lambda: ["hypothesis"])
    assert main(["certify", "--parser", ACCEPTS]) == 2
    said = capsys.readouterr().err
    assert said.endswith("needs packages that are not installed; install them with: pip install hypothesis\n")
    assert said.count("\n") == 1


def test_a_missing_suite_is_reported_with_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("importlib.metadata.entry_points", lambda **_: ())
    assert main(["certify", "--parser", ACCEPTS]) == 2
    said = capsys.readouterr().err
    assert said.startswith("eurdf: the conformance suite is not installed; install it with: ")
    assert "pip install" in said  # by a path, where the `pip` that a shell finds is another environment's


@pytest.mark.slow
def test_pytest_settings_of_the_user_have_no_effect(folder: Path) -> None:
    (folder / "pytest.ini").write_text("[pytest]\naddopts = --no-such-option\n", encoding="utf-8")
    (folder / "conftest.py").write_text("raise RuntimeError('not mine')\n", encoding="utf-8")
    settings = {"PYTEST_ADDOPTS": "--no-such-option", "PYTEST_PLUGINS": "no_such_plugin"}
    done = certify("--parser", REFERENCE, "--smoke", "--json", **settings)
    assert (done.returncode, done.stderr) == (0, "")
    given = json.loads(done.stdout)
    assert given["failures"] == []
    assert not any(level["certified"] for level in given["levels"])  # by a few cases


@pytest.mark.parametrize(
    "argv",
    [
        [],
        ["--verify", "mine", "--level", "accept"],
        ["--verify", "mine", "--known-failures", "known.yaml"],
        ["--compare", "cmd:mine", "--parser", "cmd:mine"],
        ["--compare", "cmd:mine", "--json", "-o", "page.html"],
        ["--compare", "cmd:mine"],
        ["--parser", "cmd:mine", "-o", "page.html"],
        ["--parser", "cmd:mine", "--force"],
        ["--parser", "cmd:mine", "--smoke", "--known-failures", "known.yaml"],
        ["--parser", "cmd:mine", "--smoke", "--explore", "3"],
        ["--verify", "mine", "--force"],
        ["--verify", "nowhere"],
        ["--compare", "cmd:no-such-parser", "--explore", "3", "-o", "page.html"],
    ],
)
def test_impossible_options_give_one_line_and_exit_code_2(
    argv: list[str], folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["certify", *argv]) == 2
    written = capsys.readouterr()
    assert written.out == "" or "error" in json.loads(written.out)
    assert written.err.count("\n") == 1
    assert written.err.startswith("eurdf: ")
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize("name", ["report.html", "badge.svg"])
def test_other_files_are_not_overwritten_by_a_certificate(
    name: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("mine").mkdir()
    Path("mine", name).write_text("of somebody else", encoding="utf-8")
    assert main(["certify", "--parser", "cmd:no-such-parser", "--certificate", "mine"]) == 2
    assert capsys.readouterr().err == (
        f"eurdf: 'mine/{name}' exists, but no certificate is beside it; --force replaces it\n"
    )
    assert Path("mine", name).read_text(encoding="utf-8") == "of somebody else"
    # By force it goes on to the parser, and there is none.
    assert main(["certify", "--parser", "cmd:no-such-parser", "--certificate", "mine", "--force"]) == 2
    assert "could not be started" in capsys.readouterr().err


@pytest.mark.slow
def test_an_earlier_certificate_is_replaced(folder: Path) -> None:
    for parser in (REJECTS, ACCEPTS):
        assert certify("--parser", parser, "--smoke", "--certificate", "mine").returncode == 1
    parser = read_certificate(folder / "mine").parser
    assert parser is not None
    assert parser.name == "always_accepted"


def test_file_instead_of_folder_is_reported_before_the_run(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("mine").write_text("", encoding="utf-8")
    for place in ("mine", "mine/deeper"):
        assert main(["certify", "--parser", "cmd:no-such-parser", "--certificate", place]) == 2
        told = capsys.readouterr().err
        assert f"'{place}'" in told
        assert "Errno" not in told
        assert "started" not in told


@pytest.mark.parametrize(
    ("option", "said"),
    [
        (("--date", "2026-13-01"), "'2026-13-01' is not a date"),
        (("--jobs", "-1"), "'-1' is not a count"),
        (("--parser-timeout", "0"), "'0' is not a time"),
        (("--parser-start-timeout", "nan"), "'nan' is not a time"),
        (("--level", "everything"), "invalid choice"),
        (("--certificate", ""), "the folder name is empty"),
    ],
)
def test_a_wrong_value_of_an_option_is_refused(
    option: tuple[str, str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as refused:
        main(["certify", "--parser", ACCEPTS, *option])
    assert refused.value.code == 2
    assert said in capsys.readouterr().err


# --- again, and side by side -----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_replay_by_another_parser_lists_differences(folder: Path, shared_run: Run) -> None:
    shutil.copytree(shared_run("--parser", REJECTS, *SOME).certificate, "mine")
    again = certify("--verify", "mine/certificate.json", "--parser", ACCEPTS, "--jobs", "0")
    assert again.returncode == 1
    assert again.stdout.startswith("parser, name: 'always_rejected' then, 'always_accepted' now\n")
    assert "schema/compliance-empty/accept: no failure then, failed now\n" in again.stdout
    assert again.stdout.endswith("mine/certificate.json: differs\n")
    as_json = certify("--verify", "mine", "--parser", ACCEPTS, "--jobs", "0", "--json")
    value = json.loads(as_json.stdout)
    jsonschema.Draft202012Validator(replay_schema()).validate(value)
    assert value == {"same": False, "differences": again.stdout.splitlines()[:-1]}


@pytest.mark.slow
def test_replay_reports_changes_of_the_file(folder: Path) -> None:
    assert certify("--parser", REJECTS, "--smoke", "--certificate", "mine").returncode == 1
    again = certify("--verify", "mine")
    assert (again.returncode, again.stdout) == (0, "mine: the same\n")
    assert again.stderr == f"running {REJECTS}\n"
    file = Path("mine/certificate.json")
    text = file.read_text(encoding="utf-8")
    failure = re.findall(r"-k (\S+/accept)", text)[0]
    file.write_text(text.replace(f"-k {failure}", "; reboot").replace('"known": false', '"known": true', 1))
    again = certify("--verify", file)
    assert again.returncode == 1
    assert f"{failure}: the reproduce command is not one of the suite: pytest" in again.stdout
    assert again.stdout.endswith(": known_failures is 0, but 1 failures are known\nmine/certificate.json: differs\n")
    file.write_text(text.replace('"parser"', '"parser": "cmd:theirs",\n  "parser"'), encoding="utf-8")
    Path("mine/badge.svg").unlink()
    again = certify("--verify", "mine")
    assert again.stdout.splitlines() == [
        "certificate.json: (top level): duplicate key 'parser'",
        "badge.svg: it is missing",
        "mine: differs",
    ]


@pytest.mark.slow
def test_a_comparison_runs_every_parser_and_writes_one_page(folder: Path) -> None:
    Path("page.html").write_text("of somebody else", encoding="utf-8")
    compare = ("--compare", REJECTS, ACCEPTS, *SOME, "-o", "page.html")
    refused = certify(*compare)
    assert (refused.returncode, refused.stderr) == (2, "eurdf: 'page.html' already exists; --force replaces it\n")
    assert Path("page.html").read_text(encoding="utf-8") == "of somebody else"
    done = certify(*compare, "--force")
    assert done.returncode == 0, done.stderr
    assert [line.partition(":")[0] for line in done.stderr.splitlines()] == ["1 of 2", "2 of 2"]
    page = Path("page.html").read_text(encoding="utf-8")
    assert page.index("always_rejected 1") < page.index("always_accepted 1")
    for title in ("Failures by topic", "What each parser gets wrong", "Clauses with different results"):
        assert title in page
