"""What a parser writes fills no log: its messages and names are cut before they are printed or kept."""

from __future__ import annotations

import json
from typing import Any

import pytest

from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.failure_text import failure_text
from eurdf_conformance.judging.judge import judge
from eurdf_conformance.judging.result import Result
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.protocol.message import Load, Start, Started
from eurdf_conformance.runner.answer import read_answer
from eurdf_conformance.runner.outcome import Answered, CannotStart, Crashed, Malformed, Outcome
from eurdf_conformance.runner.session import NotStarted
from eurdf_conformance.suite.item import case_items
from eurdf_conformance.visible import LONGEST, LONGEST_NAME, cut
from suite_runs import PLANNED, result

LONG = "\x1b" * 300_000
CASES = {case.name: case for case in all_cases()}
LOAD, START = Load(id=1, description="/r.yaml", urdf="/r.urdf"), Start(id=1)

ROBOT: dict[str, Any] = {
    "name": LONG, "version": "2", "root": "fixed", "links": [LONG], "frames": [LONG], "joints": [], "closures": [],
    "actuators": [{"joint": LONG}], "configurations": {LONG: {LONG: [1.0]}}, "own": {f"/{LONG}": LONG},
}  # fmt: skip

ANSWERS: dict[str, dict[str, Any]] = {
    "message": {"outcome": "rejected", "issues": [{"message": LONG}]},
    "code and file": {"outcome": "rejected", "issues": [{"message": "?", "code": LONG, "file": LONG}]},
    "many issues": {
        "outcome": "rejected",
        "issues": [{"message": "?", "file": "robot.yaml", "line": 1 + i, "column": 1} for i in range(3000)],
    },
    "error": {"outcome": "errored", "message": "line\n" * 100_000},
    "reason": {"outcome": "skipped", "reason": LONG},
    "feature": {"outcome": "unsupported", "feature": LONG, "reason": LONG},
    "robot": {"outcome": "accepted", "robot": ROBOT, "issues": []},
    "unknown member": {"outcome": "rejected", "issues": [], "k" * 300_000: 1},
    "wrong type": {"outcome": "rejected", "issues": LONG},
}


class One:
    """A parser with one outcome."""

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome

    def load(self, *_: object) -> Outcome:
        return self.outcome

    def evaluate(self, *_: object) -> Outcome:
        return self.outcome


@pytest.mark.parametrize("what", ANSWERS)
def test_printed_failure_is_short_whatever_the_parser_writes(what: str) -> None:
    answer = read_answer(json.dumps({"id": 1, **ANSWERS[what]}).encode(), LOAD)
    outcome: Outcome = answer if isinstance(answer, Malformed) else Answered(answer, 0.0)  # type: ignore[arg-type]
    for name in ("closures/parallelogram-3d-closure", "frames/closure-at-unknown-frame"):
        for item in case_items([CASES[name]]):
            if item.item.level in (Level.KINEMATICS, Level.DYNAMICS):
                continue
            judgement = judge(item.case, item.item.level, Conversation(One(outcome)))
            if judgement.verdict == Verdict.PASSED:
                continue
            text = failure_text(item.item, judgement, "", item.case)
            assert len(text) < 100_000
            kept = Result(item.item, judgement.verdict, (judgement.reason, *map(str, judgement.differences)))
            assert all(len(each) < 5 * LONGEST for each in kept.differences)


def test_name_of_a_parser_is_cut() -> None:
    parser = {"name": LONG, "version": LONG, "language": LONG}
    said = {"id": 1, "outcome": "started", "protocol": "1.0", "parser": parser, "claims": {}}
    answer = read_answer(json.dumps(said).encode(), START)
    assert isinstance(answer, Started)
    assert all(len(text) < 2 * LONGEST_NAME for text in answer.parser.model_dump().values())


def test_refusal_to_start_is_cut_and_says_once_that_there_is_no_start() -> None:
    assert str(NotStarted(CannotStart("program 'x' is not in PATH"))) == "program 'x' is not in PATH"
    assert len(str(NotStarted(Crashed(1, None, LONG)))) < 2 * LONGEST


def test_text_of_ordinary_length_stays_whole() -> None:
    assert cut("a" * LONGEST) == "a" * LONGEST
    assert cut("a" * (LONGEST + 1)).endswith("a… (2,001 characters)")
    shown = str(Difference("/outcome", "accepted", "b" * 150, "not the same"))
    assert shown == f'/outcome: not the same: expected "accepted", got "{"b" * 150}"'
    assert result(PLANNED[0], Verdict.FAILED, "c" * LONGEST).differences == ("c" * LONGEST,)
