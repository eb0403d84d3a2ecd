"""The mutation campaign: its cases can be repeated, and whatever breaks a promise is reported, reduced and kept."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from benchmarks.fuzz import parsers
from benchmarks.fuzz.campaign import keep, main
from benchmarks.fuzz.case import Case, case_of, read_case
from benchmarks.fuzz.finding import Finding, minimized
from benchmarks.fuzz.watched import Outcome, Watched
from eurdf_conformance.protocol.reply import rejected
from support.processes import why_not_installed

MISSING = why_not_installed("yaml", "saxes")


def test_seed_and_number_decide_a_case() -> None:
    cases = [case_of(3, number) for number in range(40)]
    again = [case_of(3, number) for number in range(40)]
    # As text, since NaN is not equal to itself.
    assert list(map(repr, again)) == list(map(repr, cases))
    assert {case.kind for case in cases} >= {"robot", "mesh", "call"}
    assert list(map(repr, cases)) != [repr(case_of(4, number)) for number in range(40)]


#: A worker whose cases misbehave as their number says.
MISBEHAVING = """
import os, time
from benchmarks.fuzz import worker
def harm(case, folder, number=0):
    match number:
        case 1: raise KeyError("x")
        case 2: os.abort()
        case 3: time.sleep(1000)
        case 4: os.write(2, b"from C++")
        case 5:
            worker.restart_clock(0.2)
            while True: pass
        case 6: raise MemoryError
    return "robot"
worker.try_case = harm
worker.main()
"""


def test_misbehaviour_of_a_case_is_reported_and_the_next_is_tried() -> None:
    with Watched(wall=30.0, program=("-c", MISBEHAVING)) as worker:
        for number, (word, trouble) in enumerate(
            [
                ("robot", ""),
                ("raised", "KeyError"),
                ("crashed", "ended with -6"),
                ("robot", ""),
                ("noise", "from C++"),
                ("hangs", "too much processor time"),
                ("memory", "more than"),
            ]
        ):
            if number != 3:
                outcome = worker.try_number(0, number)
                assert outcome.word == word
                assert trouble in outcome.trouble
                assert worker.try_number(0, 0) == Outcome("robot", "", case_of(0, 0).kind)


def test_case_that_only_waits_is_reported() -> None:
    with Watched(wall=20.0, program=("-c", MISBEHAVING)) as worker:
        assert worker.try_number(0, 0).word == "robot"
        worker._wall = 0.5
        assert worker.try_number(0, 3) == Outcome("hangs", "no answer in 0.5 s")


@pytest.fixture
def javascript() -> Iterator[None]:
    """The parser in JavaScript, stopped at the end."""
    yield
    parsers.javascript().stop()
    parsers.javascript.cache_clear()


@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_parsers_agree_about_damaged_robots(tmp_path: Path, javascript: None, monkeypatch: pytest.MonkeyPatch) -> None:
    outcomes = set()
    for number in range(60):
        case = case_of(5, number, "parsers")
        case.write(tmp_path)
        outcomes.add(parsers.try_parsers(tmp_path / case.path, tmp_path / "robot.urdf"))
    assert outcomes >= {"refused", "robot"}
    monkeypatch.setattr(parsers.Reference, "load", lambda *_: rejected("no"))
    (tmp_path / "robot.urdf").write_text('<robot name="r"><link name="l"/></robot>', encoding="utf-8")
    (tmp_path / "robot.yaml").write_bytes(parsers.BARE)
    with pytest.raises(AssertionError, match="only JavaScript reads it: no"):
        parsers.try_parsers(tmp_path / "robot.yaml", tmp_path / "robot.urdf")


class Picky:
    """Finds trouble in files with a word, and in calls with a number."""

    def try_folder(self, folder: Path) -> Outcome:
        case = read_case(folder)
        is_bad = (
            b"BAD" in b"".join(case.files.values()) or (case.call or {}).get("arguments", {}).get("q", [0])[-1] == 7.0
        )
        return Outcome("raised", f"KeyError at {folder.name}.py: x", case.kind) if is_bad else Outcome("robot")


def test_finding_is_reduced_while_it_fails_in_the_same_way(tmp_path: Path) -> None:
    trouble = Outcome("raised", f"KeyError at {tmp_path.name}.py: x", "robot")
    text = "".join(f"line {i}\n" for i in range(40)) + "a BAD line\n" + "z\n" * 20
    finding = Finding(Case("robot", "t", {"robot.urdf": text.encode()}, "robot.urdf"), trouble)

    class Same(Picky):
        def try_folder(self, folder: Path) -> Outcome:
            found = super().try_folder(folder)
            return Outcome(found.word, trouble.trouble, found.kind) if found.trouble else found

    reduced = minimized(finding, Same(), 60.0)  # type: ignore[arg-type]
    assert reduced.case.files == {"robot.urdf": b"BAD"}
    call: dict[str, Any] = {"robot": "four_bar", "function": "f", "arguments": {"q": [1.5, 7.0], "v": [2.0]}}
    reduced = minimized(Finding(Case("call", "t", call=call), trouble), Same(), 60.0)  # type: ignore[arg-type]
    assert reduced.case.call == {**call, "arguments": {"q": [0.0, 7.0]}}


def test_kept_finding_is_reproduced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    call = {"robot": "four_bar", "function": "no_such_function", "arguments": {}}
    finding = Finding(Case("call", "t", call=call), Outcome("raised", "KeyError", "call"))
    folder = keep(finding, tmp_path, 5, 9)
    assert json.loads((folder / "outcome.json").read_text())["number"] == 9
    assert read_case(folder) == finding.case
    assert main(["--reproduce", str(folder)]) == 1
    assert capsys.readouterr().out.startswith(f"{folder}: raised: KeyError")


@pytest.mark.skipif("atheris" in sys.modules, reason="it is loaded")
def test_guided_campaign_without_atheris_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["--guided", "--findings", str(tmp_path)]) == 2
    assert "pip install '.[fuzz]'" in capsys.readouterr().err


@pytest.mark.slow
def test_campaign_states_its_seed_and_what_it_came_to(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--seed", "1", "--count", "12", "--minutes", "5", "--findings", str(tmp_path)]) == 0
    out = capsys.readouterr().out
    assert out.startswith("seed 1, from case 0\n")
    assert "seed 1, cases 0 to 11: 12 in" in out
    assert out.endswith("promises broken: 0 times, 0 causes\n")
    assert list(tmp_path.iterdir()) == []
