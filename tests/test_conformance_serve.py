"""A Python object is served as a reader: over a pipe of its own, and whatever it prints or raises."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from conformance_fakes import FAKES, load
from eurdf_conformance.protocol.message import Accepted, AnyAnswer, Errored, Evaluated, Rejected, Skipped, Unsupported
from eurdf_conformance.protocol.serve import find_object, serve
from eurdf_conformance.runner.outcome import Answered, Crashed, Outcome
from eurdf_conformance.runner.session import Session


@pytest.fixture(autouse=True)
def _where_the_readers_are(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(FAKES)
    monkeypatch.syspath_prepend(str(FAKES))
    yield
    sys.modules.pop("python_readers", None)


def answer_of(outcome: Outcome) -> AnyAnswer:
    assert isinstance(outcome, Answered), str(outcome)
    return outcome.answer


def served(name: str, *requests: dict[str, Any] | bytes) -> list[dict[str, Any]]:
    """The answers of a reader to requests, served in this process."""
    lines = [each if isinstance(each, bytes) else json.dumps(each).encode() for each in requests]
    answers = io.BytesIO()
    serve(find_object(f"python_readers:{name}"), lines, answers)
    return [json.loads(line) for line in answers.getvalue().splitlines()]


def load_request(name: str, number: int = 1) -> dict[str, Any]:
    return {"id": number, "command": "load", "description": f"/{name}.yaml", "urdf": "/robot.urdf"}


@pytest.mark.parametrize("path", ["python_readers:Plain", "python_readers:PLAIN", "python_readers:holder.inner"])
def test_an_object_or_a_class_is_served_by_its_import_path(path: str) -> None:
    with Session(path) as session:
        assert session.started.reader.name == "plain"
        answer = answer_of(load(session, "robot"))
        assert isinstance(answer, Accepted)
        assert answer.robot is None
        assert [issue.message for issue in answer.issues] == ["/robot.yaml", "/robot.urdf"]
    assert isinstance(session.ended, Answered)


@pytest.mark.parametrize(
    ("path", "words"), [("no_such_module:READER", "No module named 'no_such_module'"), ("python_readers:Nil", "Nil")]
)
def test_an_object_that_cannot_be_imported_ends_the_process_with_the_reason_in_the_log(path: str, words: str) -> None:
    with Session(path) as session:
        outcome = session.start()
        assert isinstance(outcome, Crashed)
        assert outcome.code == 1
        assert words in outcome.log


def test_what_a_reader_prints_is_log_and_what_it_reads_is_nothing() -> None:
    with Session("python_readers:Talkative") as session:
        for _ in range(2):
            answer = answer_of(load(session, "robot"))
            assert isinstance(answer, Accepted)
            assert [issue.message for issue in answer.issues] == ["read ''"]
        assert session._process is not None
        log = session._process._pipes.log
    assert {"from Python", "from below", "from a child"} <= set(log.split("\n"))


def test_an_exception_is_the_readers_word_that_it_failed() -> None:
    with Session("python_readers:Failing") as session:
        for name, error in (("key", "KeyError"), ("recursion", "RecursionError"), ("memory", "MemoryError")):
            answer = answer_of(load(session, name))
            assert isinstance(answer, Errored)
            assert answer.message.startswith(f"{error}: ")
        answer = answer_of(session.evaluate([{}], [], ["mass"]))
        assert isinstance(answer, Errored)
        assert answer.message == "ValueError: no robot was accepted"
        assert session.restarts == 0
        assert load(session, "exit") == Crashed(6, None, "")


def test_every_kind_of_answer_gets_the_id_of_its_request() -> None:
    with Session("python_readers:Answers") as session:
        kinds = {"rejected": Rejected, "unsupported": Unsupported, "skipped": Skipped, "robot": Accepted}
        for name, kind in kinds.items():
            assert isinstance(answer_of(load(session, name)), kind)
        answer = answer_of(session.evaluate([{"a": [1.0]}, {}], ["tool"], ["mass"]))
        assert isinstance(answer, Evaluated)
        assert [values.mass for values in answer.values] == [1.0, 0.0]
        assert isinstance(answer_of(session.evaluate([{}], [], ["mass"])), Unsupported)


def test_issues_are_sentences_or_say_more() -> None:
    (answer,) = served("Answers", load_request("rejected", 4))
    assert answer["id"] == 4
    assert [issue["message"] for issue in answer["issues"]] == ["no such frame", "another"]
    assert [issue["line"] for issue in answer["issues"]] == [3, None]


@pytest.mark.parametrize("name", ["no_canonical_description", "half_a_character", "nothing"])
def test_what_cannot_be_an_answer_is_errored_and_no_rejection(name: str) -> None:
    answers = served("Answers", load_request(name, 1), load_request("robot", 2))
    assert [answer["outcome"] for answer in answers] == ["errored", "accepted"]


def test_a_reader_that_does_not_evaluate_says_so() -> None:
    request = {"id": 1, "command": "evaluate", "quantities": ["mass"], "frames": [], "configurations": [{}]}
    assert served("Plain", request) == [{"id": 1, "outcome": "unsupported", "feature": "evaluate", "reason": ""}]


def test_a_claim_that_is_none_is_errored_at_the_start() -> None:
    (answer,) = served("WrongClaims", {"id": 1, "command": "start", "protocol": "1.0"})
    assert answer["outcome"] == "errored"
    assert "everything" in answer["message"]


@pytest.mark.parametrize(
    ("line", "number"),
    [
        (b'{"id": 5, "command": "reload"}', 5),
        (b'{"id": 5, "command": "load", "description": "/robot.yaml"}', 5),
        (b'{"id": "5", "command": "stop"}', 0),
        (b"[]", 0),
        (b"start", 0),
        (b"[" * 100_000, 0),
    ],
)
def test_a_line_that_is_no_request_is_answered_too(line: bytes, number: int) -> None:
    first, second = served("Plain", line, {"id": 6, "command": "stop"})
    assert (first["id"], first["outcome"]) == (number, "errored")
    assert second == {"id": 6, "outcome": "stopped"}


def test_nothing_is_answered_after_stop() -> None:
    assert [answer["id"] for answer in served("Plain", {"id": 1, "command": "stop"}, load_request("robot", 2))] == [1]


def test_the_end_of_the_requests_is_the_end() -> None:
    assert served("Plain") == []


def test_paths_reach_the_reader_as_they_are() -> None:
    with Session("python_readers:Plain") as session:
        answer = answer_of(session.load(Path("Ω/robot 関節.yaml"), Path("../robot.urdf")))
        assert isinstance(answer, Accepted)
        assert [issue.message for issue in answer.issues] == [
            str(FAKES / "Ω/robot 関節.yaml"),
            str(FAKES / "../robot.urdf"),
        ]
