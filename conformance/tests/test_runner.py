"""The runner reports parsers that hang, crash, lie, are late, or write too much, and continues."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
import tracemalloc
from pathlib import Path

import pytest

from eurdf_conformance.corpus.protocol_rule import START, STOP
from eurdf_conformance.corpus.read import all_cases
from eurdf_conformance.judging.judge import Judgement, judge_outcome
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.protocol.message import Errored, Evaluated, Rejected, Stopped
from eurdf_conformance.runner.outcome import (
    Answered,
    CannotStart,
    Chatter,
    Crashed,
    Malformed,
    Misplaced,
    Outcome,
    TimedOut,
)
from eurdf_conformance.runner.pipes import Pipes
from eurdf_conformance.runner.session import NotStarted, Session
from eurdf_conformance.suite.protocol_check import Setup, check
from parsers.sessions import PARSERS, accepts, fake, has_ended, load, runs

#: For each misbehaviour: its outcome, words in the report, and whether the process still answers.
WAYS = [
    ("hangs", TimedOut, "no answer in 0.5 s", False),
    ("exits", Crashed, "exit code 3", False),
    ("exits_with_success", Crashed, "exit code 0", False),
    ("segfaults", Crashed, "SIGSEGV", False),
    ("aborts_with_a_line", Crashed, "SIGABRT", False),
    ("another_id", Misplaced, "the answer to request 3 has the id", False),
    ("answer_before", Misplaced, "the answer to request 3 has the id", False),
    ("late", TimedOut, "no answer in 0.5 s", False),
    ("twice", Chatter, "an unexpected line on standard output", True),
    ("garbage", Malformed, "not JSON: Expecting value at character 1", False),
    ("nothing_but_a_line_end", Malformed, "not JSON", False),
    ("not_utf8", Malformed, "not UTF-8, from byte 44 on", False),
    ("half_a_character", Malformed, "hex escape", True),
    ("list_of_one", Malformed, "a JSON value that is not an object", False),
    ("cut_off", TimedOut, 'it wrote: \'{"id": 3, "outcome": "accepted\'', False),
    ("no_line_end", TimedOut, 'it wrote: \'{"id": 3,', False),
    ("unknown_member", Malformed, "/verdict: Extra inputs are not permitted", True),
    ("member_missing", Malformed, "/robot: Field required", True),
    ("another_outcome_before", Malformed, "(top level): duplicate key 'outcome'", True),
    ("two_ids", Malformed, "duplicate key 'id'", False),
    ("number_too_long", Malformed, "/issues/0/line: a number is beyond the range of a double", True),
    ("wrong_type", Malformed, "/issues/0/line: Input should be a valid integer", True),
    ("no_outcome", Malformed, "'outcome'", True),
    ("unknown_outcome", Malformed, "'valid'", True),
    ("no_id", Malformed, "the 'id' of the request, an integer, is missing", False),
    ("wrong_kind", Malformed, "'evaluated' is not an answer to 'load'", True),
    ("not_a_number", Malformed, "/robot/own/~1x-a: NaN is not JSON", True),
    ("number_too_large", Malformed, "/robot/own/~1x-a: a number is beyond the range of a double", True),
    ("null_for_a_number", Malformed, "/robot/joints/0/damping/0: Input should be a valid number, not null", True),
    ("nested_deep", Malformed, "JSON nested too deep", False),
    ("endless_line", Malformed, "a line of more than 1,048,576 bytes", False),
    ("endless_lines", Malformed, "not JSON", False),
    ("chatter_before", Chatter, "2 unexpected lines on standard output", True),
    ("chatter_after", Chatter, "an unexpected line on standard output", True),
    ("floods_stderr_for_ever", TimedOut, "no answer in 0.5 s", False),
    ("dies_before_its_child", Crashed, "exit code 5", False),
    ("closes_stdout", Crashed, "closed its standard output", False),
]


@pytest.mark.parametrize(("way", "kind", "words", "goes_on"), WAYS, ids=[way for way, *_ in WAYS])
def test_runner_distinguishes_and_survives_misbehaviour(
    way: str, kind: type[Outcome], words: str, goes_on: bool
) -> None:
    with Session(fake(way), timeout=0.5, line_limit=2**20) as session:
        assert accepts(load(session, "first"), "first")
        outcome = load(session, "trigger")
        assert isinstance(outcome, kind)
        assert words in str(outcome)
        assert outcome.word == {TimedOut: "timed out"}.get(kind, kind.__name__.lower())
        assert accepts(load(session, "next"), "next")
        assert session.restarts == (0 if goes_on else 1)
    assert isinstance(session.ended, Answered)


@pytest.mark.parametrize(
    "way", ["sound", "in_pieces", "floods_stderr", "carriage_returns", "whole_numbers_with_a_point"]
)
def test_unusual_but_correct_messages_are_answers(way: str) -> None:
    with Session(fake(way)) as session:
        for name in ("first", "trigger_Ω_関節", "next"):
            assert accepts(load(session, name), name)
        assert session.restarts == 0


def test_misbehaviour_is_never_a_rejection() -> None:
    assert not any(issubclass(kind, Answered) for _, kind, _, _ in WAYS)
    with Session(fake("errors")) as session:
        outcome = load(session, "trigger")
        assert isinstance(outcome, Answered)
        assert isinstance(outcome.answer, Errored)
        assert not isinstance(outcome.answer, Rejected)
        assert outcome.word == "errored"
        assert session.restarts == 0


def test_a_process_that_ends_before_start_has_answered_nothing() -> None:
    with Session("cmd:sh -c 'exit 127'") as session, pytest.raises(NotStarted) as refusal:
        _ = session.started
    assert str(refusal.value).splitlines()[0] == "crashed: ended with exit code 127 without answering"


def test_the_log_before_the_first_request_is_kept() -> None:
    pipes = Pipes([sys.executable, "-I", "-S", "-c", "import sys; sys.exit('no such file')"])
    try:
        while not pipes.log:
            pipes.line(time.monotonic() + 0.1)
        pipes.send(b"{}")
        assert pipes.log == "no such file\n"
    finally:
        pipes.close()


def test_crash_between_requests_is_reported_at_the_next() -> None:
    with Session(fake("exits_after_answering")) as session:
        assert accepts(load(session, "trigger"), "trigger")
        time.sleep(0.2)
        outcome = load(session, "next")
        assert outcome == Crashed(4, None, "", before=True)
        assert "after answering the previous request" in str(outcome)
        assert accepts(load(session, "next"), "next")


@pytest.mark.slow
def test_crash_after_an_answer_has_exit_code() -> None:
    with Session(fake("exits_after_answering")) as session:
        for _ in range(30):
            assert accepts(load(session, "trigger"), "trigger")
            outcome = load(session, "next")  # the process may be alive still, or be dying, or be dead
            assert isinstance(outcome, Crashed)
            assert outcome.code == 4


def test_line_after_an_answer_is_reported_at_the_next_request() -> None:
    with Session(fake("chatter_later")) as session:
        assert accepts(load(session, "trigger"), "trigger")
        time.sleep(0.3)
        outcome = load(session, "next")
        assert isinstance(outcome, Chatter)
        assert outcome.lines == ("cleaned up",)
        assert outcome.answer is not None
        assert accepts(load(session, "next"), "next")


def test_deaf_parser_is_restarted_after_its_last_answer() -> None:
    with Session(fake("closes_stdin"), timeout=0.5) as session:
        assert accepts(load(session, "trigger"), "trigger")
        assert isinstance(load(session, "next"), TimedOut)
        assert accepts(load(session, "next"), "next")


def test_request_larger_than_the_pipe_does_not_hang() -> None:
    configurations = [{f"joint_{index}": [0.123456789] for index in range(20_000)}]
    with Session(fake("hangs"), timeout=0.5) as session:
        assert isinstance(load(session, "trigger"), TimedOut)
        outcome = session.evaluate(configurations, [], ["mass"])
        assert isinstance(outcome, Answered)
        assert isinstance(outcome.answer, Evaluated)


def test_values_at_another_number_of_configurations_are_malformed() -> None:
    with Session(fake("sound")) as session:
        outcome = session.evaluate([{}, {}], [], ["mass"])
        assert isinstance(outcome, Malformed)
        assert "values at 1 configurations, expected 2" in str(outcome)


def test_the_log_of_a_failure_is_kept_and_bounded() -> None:
    with Session(fake("exits")) as session:
        outcome = load(session, "trigger")
        assert isinstance(outcome, Crashed)
        assert outcome.log == "cannot go on\n"
        assert "log: cannot go on" in str(outcome)
    with Session(fake("floods_stderr_for_ever"), timeout=0.5) as session:
        outcome = load(session, "trigger")
        assert isinstance(outcome, TimedOut)
        assert len(outcome.log) == 2**14


def test_a_shortened_log_keeps_the_error_line_of_node_js() -> None:
    trace = [f"    at somewhere (node:internal/modules/esm/{number})" for number in range(10)]
    log = ["Error [ERR_MODULE_NOT_FOUND]: Cannot find package 'yaml'", *trace, "  code: 'ERR'", "}", "", "Node.js v24"]
    assert log[0] in str(Crashed(1, None, "\n".join(log)))


def test_the_reason_is_one_line_and_the_log_has_details() -> None:
    with Session(fake("closes_stdout"), timeout=5.0) as session:
        judgement = judge_outcome(load(session, "trigger"))
        assert judgement.reason == "the process closed its standard output without answering"
    with Session(fake("null_for_a_number")) as session:
        judgement = judge_outcome(load(session, "trigger"))
        assert "null, which some libraries write for NaN or infinity; JSON has neither" in judgement.reason
        assert "a link" not in judgement.reason
        assert "a link" in judgement.log
        assert "Input should be" not in judgement.log


def test_an_endless_line_takes_bounded_memory() -> None:
    with Session(fake("endless_line"), line_limit=2**20) as session:
        assert accepts(load(session, "first"), "first")
        tracemalloc.start()
        try:
            outcome = load(session, "trigger")
            peak = tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
    assert isinstance(outcome, Malformed)
    assert len(outcome.line) < 2100
    assert peak < 5 * 2**20


# -- starting --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("way", "kind", "words"),
    [
        ("crashes_at_start", Crashed, "no licence found"),
        ("hangs_at_start", TimedOut, "no answer in 0.5 s"),
        ("refuses_to_start", Answered, "answered 'errored': no licence"),
        ("speaks_another_protocol", Malformed, "/protocol: Input should be '1.0'"),
        ("byte_order_mark", Malformed, "byte order mark"),
        ("banner", Chatter, "Welcome to Fake 1.0!"),
    ],
)
def test_parser_that_cannot_start_is_given_up_with_reason(way: str, kind: type[Outcome], words: str) -> None:
    with Session(fake(way), start_timeout=0.5 if way == "hangs_at_start" else 30.0) as session:
        assert isinstance(session.start(), kind)
        with pytest.raises(NotStarted) as caught:
            _ = session.started
        assert words in str(caught.value)
        outcome = load(session, "robot")
        assert isinstance(outcome, CannotStart)
        assert words in str(outcome)
        assert session.restarts == 0
    assert session.ended is None


def test_an_error_answer_to_start_makes_every_rule_errored() -> None:
    with Session(fake("refuses_to_start")) as session:
        asked = Setup(session, lambda: Session(fake("refuses_to_start")), *all_cases()[:2])
        for rule in (START, STOP):
            judgement = check(rule, asked)
            assert (judgement.verdict, judgement.reason) == (Verdict.ERRORED, "no licence")


@pytest.mark.parametrize(
    ("parser", "words"),
    [
        ("cmd:/no/such/program", "program '/no/such/program' does not exist"),
        ("cmd:no-such-program", "program 'no-such-program' is not in PATH"),
        ("cmd:", "the command after 'cmd:' is missing"),
        ("cmd:'unclosed", "closing quotation"),
        ("parser.py", "neither 'package.module:object' nor 'cmd:'"),
        ("my-package:parser", "neither"),
    ],
)
def test_a_parser_that_cannot_be_started_gives_the_reason(parser: str, words: str) -> None:
    with Session(parser) as session:
        outcome = session.start()
        assert isinstance(outcome, CannotStart)
        assert words in str(outcome)
        assert isinstance(load(session, "robot"), CannotStart)


@pytest.mark.parametrize(
    ("parser", "text", "mode", "words"),
    [
        ("cmd:mine.py", "", 0o644, "write './mine.py' for the file in this folder"),
        ("cmd:./mine.py", "", 0o644, "'./mine.py' is not executable"),
        ("cmd:./mine.py", "print(1)", 0o755, "'./mine.py' is not a program; a script needs a first line"),
        (
            "cmd:./mine.py",
            "#!/no/such/python",
            0o755,
            "the interpreter in the first line of './mine.py' does not exist",
        ),
        ("cmd:./folder", "", 0o644, "'./folder' is a folder"),
    ],
)
def test_a_file_that_cannot_be_run_gives_a_hint(
    parser: str, text: str, mode: int, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    (tmp_path / "mine.py").write_text(text)
    (tmp_path / "mine.py").chmod(mode)
    with Session(parser) as session:
        assert words in str(session.start())


@pytest.mark.slow
@pytest.mark.parametrize("names", [["trigger"], ["trigger_1", "sound_1", "trigger_2"]], ids=["all", "some"])
def test_crashes_give_the_same_results_in_any_number_of_sessions(names: list[str]) -> None:
    asked = [f"{name}_{number}" for number in range(8) for name in names]

    def judged(sessions: int) -> dict[str, Judgement]:
        found = {}
        for part in range(sessions):
            with Session(fake("exits")) as session:
                found |= {name: judge_outcome(load(session, name)) for name in asked[part::sessions]}
        return found

    found = judged(1)
    assert found == judged(3)
    crashed = {name for name, judgement in found.items() if judgement.verdict == Verdict.CRASHED}
    assert crashed == {name for name in asked if name.startswith("trigger")}


def test_parser_that_cannot_restart_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FAKE_STARTED", str(tmp_path / "started"))
    with Session(fake("starts_once"), timeout=0.5, failed_starts=3) as session:
        assert accepts(load(session, "first"), "first")
        process = session._process
        assert process is not None
        process.end()  # as any outcome that breaks it does
        assert [load(session, "next").word for _ in range(5)] == ["cannot start"] * 5
        assert session.restarts == 3
        (tmp_path / "started").unlink()
        outcome = load(session, "next")
        assert isinstance(outcome, CannotStart)
        assert "given up because it did not start 3 times in a row: crashed: ended with exit code 9" in str(outcome)


def test_failed_starts_count_only_in_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FAKE_STARTED", str(tmp_path / "started"))
    with Session(fake("starts_once"), failed_starts=2) as session:
        for _ in range(4):
            assert accepts(load(session, "first"), "first")
            assert session._process is not None
            session._process.end()
            assert load(session, "next").word == "cannot start"
            (tmp_path / "started").unlink()


def test_a_restarted_parser_loads_the_robot_before_evaluating() -> None:
    with Session(fake("exits")) as session:
        assert accepts(load(session, "first"), "first")
        assert session._process is not None
        session._process.end()
        outcome = session.evaluate([{}], [], ["mass"])
        assert isinstance(outcome, Answered)
        assert isinstance(outcome.answer, Evaluated)
        assert outcome.answer.id == 5  # start, load; start, load, evaluate


# -- ending ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("way", "kind"), [("ignores_stop", TimedOut), ("does_not_end", TimedOut), ("crashes_at_the_end", Crashed)]
)
def test_parser_that_does_not_stop_is_killed_and_reported(way: str, kind: type[Outcome]) -> None:
    with Session(fake(way), stop_timeout=0.3) as session:
        assert accepts(load(session, "trigger"), "trigger")
        process = session._process
    assert isinstance(session.ended, kind)
    assert process is not None
    assert not process.alive


def test_a_parser_reads_end_of_input_after_stop() -> None:
    with Session(fake("ends_with_its_input"), stop_timeout=30.0) as session:
        assert accepts(load(session, "robot"), "robot")
    assert isinstance(session.ended, Answered)
    assert isinstance(session.ended.answer, Stopped)


def test_child_processes_end_with_their_parser() -> None:
    with Session(fake("has_a_child")) as session:
        outcome = load(session, "trigger")
        assert isinstance(outcome, Answered)
        child = int(outcome.answer.issues[0].message)  # type: ignore[union-attr]
        assert runs(child)
    assert isinstance(session.ended, Answered)
    assert isinstance(session.ended.answer, Stopped)
    assert has_ended(child)
    assert session.left == []  # no daemons


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux has sub-reapers")
@pytest.mark.parametrize("way", ["has_a_daemon", "dies_before_its_daemon"])
def test_daemons_end_with_their_parser_and_are_reported(way: str) -> None:
    with Session(fake(way)) as session:
        outcome = load(session, "trigger")
        daemon = int(outcome.log if isinstance(outcome, Crashed) else outcome.answer.issues[0].message)  # type: ignore[union-attr]
        assert accepts(load(session, "next"), "next")
    assert has_ended(daemon)
    assert session.left == ["sleep"]


def test_a_parser_does_not_see_which_test_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTEST_CURRENT_TEST", "urdf/gantry")
    pipes = Pipes([sys.executable, "-c", "import os; print(sorted(n for n in os.environ if n.startswith('PYTEST')))"])
    try:
        assert pipes.line(time.monotonic() + 60.0) == b"[]"
    finally:
        pipes.close()


def test_a_child_of_a_dead_parser_blocks_nothing() -> None:
    with Session(fake("dies_before_its_child"), timeout=300.0) as session:
        outcome = load(session, "trigger")
        assert isinstance(outcome, Crashed)  # and not that it timed out
        assert has_ended(int(outcome.log))


def test_an_exception_in_the_runner_ends_the_parser() -> None:
    session = Session(fake("ignores_stop"), stop_timeout=60.0)

    def interrupted() -> None:
        with session:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert session._process is not None
    assert not session._process.alive
    assert session.ended is None


RUNNER = """
import sys
from parsers.sessions import fake, load
from eurdf_conformance.runner.session import Session
with Session(fake("spins"), timeout=60.0) as session:
    load(session, "trigger")
"""


@pytest.mark.parametrize("end", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_a_killed_runner_ends_its_parser(end: signal.Signals, tmp_path: Path) -> None:
    pids = tmp_path / "pids"
    environment = os.environ | {"FAKE_PIDS": str(pids), "PYTHONPATH": str(PARSERS.parent)}
    with subprocess.Popen(
        [sys.executable, "-c", RUNNER],
        env=environment,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
        # Where the tests run as a background job of a script, SIGINT is ignored, also by what they start.
        preexec_fn=lambda: signal.signal(end, signal.SIG_DFL) if end != signal.SIGKILL else None,
    ) as runner:
        for _ in range(300):
            if pids.exists():
                break
            time.sleep(0.05)
        parser, child, daemon = map(int, pids.read_text().split())
        assert runs(parser)
        assert runs(child)
        assert runs(daemon)
        os.killpg(runner.pid, end)  # as Ctrl-C does, all of the group
    assert has_ended(parser)
    assert has_ended(child)
    assert has_ended(daemon) or not sys.platform.startswith("linux")


def test_reference_parser_has_a_short_name() -> None:
    with Session("reference") as session:
        assert session.started.parser.name == "eurdf"
    with (
        Session("refference") as session,
        pytest.raises(NotStarted, match="and a command line, nor 'reference'"),
    ):
        _ = session.started
