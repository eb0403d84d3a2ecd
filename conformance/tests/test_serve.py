"""A Python object is served as a parser: over a pipe of its own, and whatever it prints or raises."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from eurdf_conformance.judging.judge import judge_outcome
from eurdf_conformance.judging.verdict import OF_THE_ADAPTER
from eurdf_conformance.protocol.message import Accepted, AnyAnswer, Errored, Evaluated, Rejected, Skipped, Unsupported
from eurdf_conformance.protocol.serve import find_object, serve
from eurdf_conformance.runner.outcome import Answered, Crashed, Malformed, Outcome
from eurdf_conformance.runner.session import Session
from parsers.sessions import PARSERS, load


@pytest.fixture(autouse=True)
def _where_the_parsers_are(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(PARSERS)
    monkeypatch.syspath_prepend(str(PARSERS))
    yield
    sys.modules.pop("python_parsers", None)


def answer_of(outcome: Outcome) -> AnyAnswer:
    assert isinstance(outcome, Answered), str(outcome)
    return outcome.answer


def served(name: str, *requests: dict[str, Any] | bytes) -> list[dict[str, Any]]:
    """The answers of a parser to requests, served in this process."""
    lines = [each if isinstance(each, bytes) else json.dumps(each).encode() for each in requests]
    answers = io.BytesIO()
    serve(find_object(f"python_parsers:{name}"), lines, answers)
    return [json.loads(line) for line in answers.getvalue().splitlines()]


def load_request(name: str, number: int = 1) -> dict[str, Any]:
    return {"id": number, "command": "load", "description": f"/{name}.yaml", "urdf": "/robot.urdf"}


@pytest.mark.parametrize("path", ["python_parsers:Plain", "python_parsers:PLAIN", "python_parsers:holder.inner"])
def test_an_import_path_may_name_an_object_or_class(path: str) -> None:
    with Session(path) as session:
        assert session.started.parser.name == "plain"
        answer = answer_of(load(session, "robot"))
        assert isinstance(answer, Accepted)
        assert answer.robot is None
        assert [issue.message for issue in answer.issues] == ["/robot.yaml", "/robot.urdf"]
    assert isinstance(session.ended, Answered)


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("no_such_module:PARSER", f"no module 'no_such_module': it is neither in the working folder, {PARSERS}, nor "),
        ("python_parsers.inner:PARSER", "no module 'python_parsers.inner': "),
        ("python_parsers:Nil", "python_parsers has no 'Nil'"),
        ("python_parsers:holder.outer", "python_parsers has no 'holder.outer'"),
        ("python_parsers:TakesArguments", "the class python_parsers:TakesArguments needs arguments"),
        ("python_parsers:NoName", "is not a parser: an object of the class NoName has no name"),
        ("python_parsers:NoLoad", "is not a parser: an object of the class NoLoad has no load"),
        ("python_parsers:number", "is not a parser: 3 has no name and no version and no language and no claims"),
        ("python_parsers:function", "is not a parser: the function function has no name"),
        ("python_parsers:NumberForVersion", "its version is 1, expected a string"),
        ("python_parsers:OnePath", "its method load(description) cannot be called as load(description, urdf)"),
        ("python_parsers:OneArgument", "cannot be called as evaluate(configurations, frames, quantities)"),
        ("python_parsers:number_for_version", "it claims version 2; versions are strings"),
        ("python_parsers:no_mapping", "expected a mapping from version to levels, as in {'2': ['accept']}"),
        ("python_parsers:no_level", "it claims level 'acept'; levels are accept, structure"),
        ("python_parsers:no_list", "its claims for version 2 must be a list of levels"),
    ],
)
def test_serving_a_wrong_object_gives_a_one_line_error(path: str, words: str) -> None:
    with Session(path) as session:
        outcome = session.start()
        assert isinstance(outcome, Crashed)
        assert outcome.code == 1
        assert words in outcome.log
        assert len(outcome.log.splitlines()) == 1


@pytest.mark.parametrize(
    ("path", "first", "last"),
    [
        ("python_parsers:Raises", "python_parsers.py", "RuntimeError: no licence"),
        ("imports_what_is_missing:X", "imports_what_is_missing.py", "No module named 'no_such_package'"),
    ],
)
def test_exception_of_a_parser_module_shows_its_lines(
    path: str, first: str, last: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "imports_what_is_missing.py").write_text("import no_such_package\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with Session(path) as session:
        outcome = session.start()
    assert isinstance(outcome, Crashed)
    lines = outcome.log.splitlines()
    assert lines[0].startswith("Traceback")
    assert first in lines[1]
    assert last in lines[-1]
    assert "serve.py" not in outcome.log
    assert "importlib" not in outcome.log


def test_a_parser_prints_to_the_log_and_reads_nothing() -> None:
    with Session("python_parsers:Talkative") as session:
        for _ in range(2):
            answer = answer_of(load(session, "robot"))
            assert isinstance(answer, Accepted)
            assert [issue.message for issue in answer.issues] == ["read ''"]
        assert session._process is not None
        log = session._process._pipes.log
    assert {"from Python", "from below", "from a child"} <= set(log.split("\n"))


def test_an_exception_in_the_parser_is_errored() -> None:
    with Session("python_parsers:Failing") as session:
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
    with Session("python_parsers:Answers") as session:
        kinds = {"rejected": Rejected, "unsupported": Unsupported, "skipped": Skipped, "robot": Accepted}
        for name, kind in kinds.items():
            assert isinstance(answer_of(load(session, name)), kind)
        answer = answer_of(session.evaluate([{"a": [1.0]}, {}], ["tool"], ["mass"]))
        assert isinstance(answer, Evaluated)
        assert [values.mass for values in answer.values] == [1.0, 0.0]
        assert isinstance(answer_of(session.evaluate([{}], [], ["mass"])), Unsupported)


def test_issues_may_be_sentences_or_objects() -> None:
    (answer,) = served("Answers", load_request("rejected", 4))
    assert answer["id"] == 4
    assert [issue["message"] for issue in answer["issues"]] == ["no such frame", "another"]
    assert [issue["line"] for issue in answer["issues"]] == [3, None]


def test_an_unwritable_answer_is_errored_not_rejected() -> None:
    answers = served("Answers", load_request("half_a_character", 1), load_request("robot", 2))
    assert [answer["outcome"] for answer in answers] == ["errored", "accepted"]


RETURNS = "use accepted, rejected, unsupported or skipped of eurdf_conformance.protocol.reply"


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("nothing", f"load returned None; {RETURNS}"),
        ("no_canonical_description", "in accepted(): /robot/version: Field required; /robot/root: Field required"),
        ("no_plain_data", "in accepted(): /robot is not plain data: Object of type set is not JSON serializable"),
        ("not_a_number", "in accepted(): /robot/own/~1x/0/y: JSON has no NaN or infinity"),
        ("no_issue", "in rejected(): /issues/0: Input should be a valid dictionary or instance of Issue, not "),
        ("values", "Values: /mass: Input should be a finite number, not inf: JSON has no NaN or infinity"),
        ("pose", "Pose: /rotation: List should have at least 3 items after validation, not 1, not [[1.0, 0.0, 0.0]]"),
    ],
)
def test_non_answer_is_an_adapter_error(name: str, why: str) -> None:
    with Session("python_parsers:Answers") as session:
        outcome = load(session, name)
        assert isinstance(outcome, Malformed)
        assert outcome.why.startswith(why)
        judgement = judge_outcome(outcome)
        assert judgement.verdict in OF_THE_ADAPTER
        assert "it wrote" not in judgement.log
        assert not any(inside in judgement.reason for inside in ("pydantic", "model_", "\n", "\\n"))
        assert isinstance(answer_of(load(session, "robot")), Accepted)
        assert session.restarts == 0


def test_invalid_values_are_an_adapter_error() -> None:
    with Session("python_parsers:Answers") as session:
        outcome = session.evaluate([{}], ["nothing"], ["mass"])
        assert isinstance(outcome, Malformed)
        assert outcome.why.startswith("evaluate returned None; give a list of Values, one a configuration, or use ")


def test_a_parser_that_does_not_evaluate_says_so() -> None:
    request = {"id": 1, "command": "evaluate", "quantities": ["mass"], "frames": [], "configurations": [{}]}
    assert served("Plain", request) == [{"id": 1, "outcome": "unsupported", "feature": "evaluate", "reason": ""}]


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
def test_an_invalid_request_is_answered(line: bytes, number: int) -> None:
    first, second = served("Plain", line, {"id": 6, "command": "stop"})
    assert (first["id"], first["outcome"]) == (number, "errored")
    assert second == {"id": 6, "outcome": "stopped"}


def test_nothing_is_answered_after_stop() -> None:
    assert [answer["id"] for answer in served("Plain", {"id": 1, "command": "stop"}, load_request("robot", 2))] == [1]


def test_the_server_stops_at_end_of_input() -> None:
    assert served("Plain") == []


def test_paths_reach_the_parser_unchanged() -> None:
    with Session("python_parsers:Plain") as session:
        answer = answer_of(session.load(Path("Ω/robot 関節.yaml"), Path("../robot.urdf")))
        assert isinstance(answer, Accepted)
        assert [issue.message for issue in answer.issues] == [
            str(PARSERS / "Ω/robot 関節.yaml"),
            str(PARSERS / "../robot.urdf"),
        ]
