"""The suite as pytest runs it: what it asks, what it makes of the answers, and what it prints."""

import json
import os
import re
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest

from eurdf_conformance.corpus.case import ValidCase
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.protocol_rule import GOES_ON
from eurdf_conformance.corpus.read import CorpusCase, all_cases
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.failure_text import failure_text
from eurdf_conformance.judging.judge import Judgement, judge
from eurdf_conformance.judging.result import RESULT
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties import PROPERTIES
from eurdf_conformance.protocol.message import (
    Accepted,
    AnyAnswer,
    Errored,
    Evaluated,
    Issue,
    ParserInfo,
    Rejected,
    Skipped,
    Started,
    Unsupported,
)
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
from eurdf_conformance.runner.session import Session
from eurdf_conformance.suite.item import case_items, planned_items
from eurdf_conformance.suite.item_runner import ItemRunner
from eurdf_conformance.suite.options import OPTIONS, Options
from eurdf_conformance.suite.plugin import Collector
from eurdf_conformance.suite.protocol_check import Setup, check
from eurdf_conformance.suite.smoke import SMOKE
from eurdf_conformance.suite.summary import summary_lines
from suite_runs import result, run, started
from support.warm import run_module

ROOT = Path(__file__).parents[2]
CASES = {case.name: case for case in all_cases()}
VALID, INVALID, EITHER = (
    CASES["closures/parallelogram-3d-closure"],
    CASES["frames/closure-at-unknown-frame"],
    CASES["inertia/negative-mass"],
)


class Scripted:
    """A parser with given answers, which keeps the requests."""

    def __init__(self, load: Outcome, evaluate: Outcome | None = None) -> None:
        self.answers = {"load": load, "evaluate": evaluate}
        self.asked: list[str] = []

    def load(self, *_: object) -> Outcome:
        return self._outcome("load")

    def evaluate(self, *_: object) -> Outcome:
        return self._outcome("evaluate")

    def _outcome(self, command: str) -> Outcome:
        self.asked.append(command)
        outcome = self.answers[command]
        assert outcome is not None
        return outcome


def accepts(case: CorpusCase | None = None, *issues: Issue) -> Outcome:
    robot = None if case is None else case.expected.robot
    return Answered(Accepted(id=1, robot=robot, issues=list(issues)), 0.0)


def rejects(*issues: Issue) -> Outcome:
    return Answered(Rejected(id=1, issues=list(issues)), 0.0)


FAILURES: list[tuple[Outcome, Verdict]] = [
    (Answered(Unsupported(id=1, feature="closures"), 0.0), Verdict.UNSUPPORTED),
    (Answered(Skipped(id=1, reason="no"), 0.0), Verdict.SKIPPED),
    (Answered(Errored(id=1, message="oh"), 0.0), Verdict.ERRORED),
    (Crashed(3, None, "log"), Verdict.CRASHED),
    (Crashed(None, "SIGSEGV", "log"), Verdict.CRASHED),
    (TimedOut(10.0), Verdict.TIMED_OUT),
    (Malformed("{", "no JSON"), Verdict.MALFORMED),
    (Misplaced("{}", 2, 1), Verdict.MISPLACED),
    (Chatter(("hello",)), Verdict.CHATTER),
    (CannotStart("no such program"), Verdict.NOT_STARTED),
]


@pytest.mark.parametrize(("outcome", "verdict"), FAILURES, ids=lambda value: type(value).__name__)
def test_non_answer_is_never_a_rejection(outcome: Outcome, verdict: Verdict) -> None:
    for case in (VALID, INVALID, EITHER):
        for level in case.levels:
            found = judge(case, level, Conversation(Scripted(outcome)))
            assert found.verdict == verdict
            assert found.reason
    for level in (Level.KINEMATICS, Level.DYNAMICS):
        assert judge(VALID, level, Conversation(Scripted(accepts(VALID), outcome))).verdict == verdict


@pytest.mark.parametrize(
    ("case", "outcome", "verdict"),
    [
        (VALID, accepts(VALID), Verdict.PASSED),
        (VALID, accepts(), Verdict.PASSED),
        (VALID, rejects(), Verdict.FAILED),
        (INVALID, rejects(), Verdict.PASSED),
        (INVALID, accepts(VALID), Verdict.FAILED),
        (EITHER, accepts(VALID), Verdict.PASSED),
        (EITHER, rejects(), Verdict.PASSED),
    ],
)
def test_valid_cases_are_accepted_and_invalid_ones_rejected(
    case: CorpusCase, outcome: Outcome, verdict: Verdict
) -> None:
    assert judge(case, Level.ACCEPT, Conversation(Scripted(outcome))).verdict == verdict


def test_a_parser_that_claims_structure_must_send_the_robot() -> None:
    def structure(outcome: Outcome) -> Verdict:
        return judge(VALID, Level.STRUCTURE, Conversation(Scripted(outcome))).verdict

    assert structure(accepts(VALID)) == Verdict.PASSED
    assert (
        structure(accepts())
        == structure(rejects())
        == structure(accepts(CASES["frames/closures-at-inline-poses"]))
        == Verdict.FAILED
    )


def test_each_configuration_needs_one_set_of_values() -> None:
    values = VALID.expected.values
    for level in (Level.KINEMATICS, Level.DYNAMICS):
        for given, verdict in ((values, Verdict.PASSED), (values[:1], Verdict.FAILED), (values[::-1], Verdict.FAILED)):
            parser = Scripted(accepts(), Answered(Evaluated(id=1, values=given), 0.0))
            assert judge(VALID, level, Conversation(parser)).verdict == verdict


@pytest.mark.parametrize(
    ("case", "level", "answer", "told"),
    [
        (
            VALID,
            Level.ACCEPT,
            Rejected(id=1, issues=[]),
            ("accepted", "rejected", "the parser rejects a valid description"),
        ),
        (
            VALID,
            Level.STRUCTURE,
            Rejected(id=1, issues=[]),
            ("accepted", "rejected", "the parser rejects a valid description"),
        ),
        (VALID, Level.DIAGNOSE, Unsupported(id=1, feature="f"), ("accepted", "unsupported", "unsupported feature")),
        (VALID, Level.DYNAMICS, Unsupported(id=1, feature="f"), ("accepted", "unsupported", "unsupported feature")),
        (INVALID, Level.ACCEPT, Unsupported(id=1, feature="f"), ("rejected", "unsupported", "unsupported feature")),
        (INVALID, Level.DIAGNOSE, Skipped(id=1, reason=""), ("rejected", "skipped", "the parser skipped the request")),
        (
            EITHER,
            Level.ACCEPT,
            Errored(id=1, message="oh"),
            ("accepted or rejected", "errored", "the parser reported a failure"),
        ),
    ],
)
def test_unexpected_answer_is_reported_with_the_expected_one(
    case: CorpusCase, level: Level, answer: AnyAnswer, told: tuple[str, str, str]
) -> None:
    (found,) = judge(case, level, Conversation(Scripted(Answered(answer, 0.0)))).differences
    assert (found.pointer, found.expected, found.given, found.why) == ("/outcome", *told)


def test_missing_values_are_reported_for_an_accepted_robot() -> None:
    parser = Scripted(accepts(VALID), Answered(Unsupported(id=1, feature="evaluate"), 0.0))
    (found,) = judge(VALID, Level.KINEMATICS, Conversation(parser)).differences
    assert (found.expected, found.given) == ("evaluated", "unsupported")
    assert parser.asked == ["load", "evaluate"]


def expected_issue(case: CorpusCase, **changes: object) -> Issue:
    said = case.case.model_dump()
    return Issue.model_validate({"code": said["code"], "message": "?", **said["place"], **changes})


def test_error_of_an_acceptable_robot_is_reported() -> None:
    def diagnose(case: CorpusCase, outcome: Outcome) -> Verdict:
        return judge(case, Level.DIAGNOSE, Conversation(Scripted(outcome))).verdict

    assert (
        diagnose(EITHER, accepts(None, expected_issue(EITHER)))
        == diagnose(EITHER, rejects(expected_issue(EITHER)))
        == Verdict.PASSED
    )
    assert diagnose(EITHER, accepts()) == diagnose(EITHER, rejects()) == Verdict.FAILED
    assert diagnose(INVALID, rejects(expected_issue(INVALID))) == Verdict.PASSED
    assert diagnose(INVALID, rejects(expected_issue(INVALID, line=1))) == Verdict.FAILED
    assert diagnose(INVALID, accepts(None, expected_issue(INVALID))) == Verdict.FAILED
    assert diagnose(VALID, accepts()) == Verdict.PASSED
    assert diagnose(VALID, accepts(None, expected_issue(INVALID, severity="warning"))) == Verdict.FAILED


def test_case_is_loaded_once_for_all_levels() -> None:
    parser = Scripted(accepts(VALID), Answered(Evaluated(id=1, values=VALID.expected.values), 0.0))
    conversation = Conversation(parser)
    for level in VALID.levels:
        assert judge(VALID, level, conversation).verdict == Verdict.PASSED
    assert parser.asked == ["load", "evaluate", "evaluate"]
    parser.answers["evaluate"] = TimedOut(1.0)
    judge(VALID, Level.KINEMATICS, conversation)
    judge(VALID, Level.KINEMATICS, conversation)
    assert parser.asked[3:] == ["evaluate", "load", "evaluate"]
    judge(CASES["frames/closures-at-inline-poses"], Level.ACCEPT, conversation)
    conversation.forget()
    judge(CASES["frames/closures-at-inline-poses"], Level.ACCEPT, conversation)
    assert parser.asked[6:] == ["load", "load"]


def test_no_two_items_have_the_same_id_and_level() -> None:
    items = list(planned_items(CASES.values()))
    assert len({item.key for item in items}) == len(items)


def test_the_smoke_cases_have_their_version_and_an_evaluation() -> None:
    for version, three in SMOKE.items():
        valid, invalid, evaluated = (CASES[case_id] for case_id in (three.valid, three.invalid, three.evaluated))
        assert {case.case.version for case in (valid, invalid, evaluated)} == {version}
        assert len({valid.id, invalid.id, evaluated.id}) == 3
        assert (valid.case.valid, invalid.case.valid) == (True, False)
        assert Level.KINEMATICS in evaluated.levels


def test_a_failure_text_shows_clause_place_and_command() -> None:
    item = next(each.item for each in case_items([INVALID]) if each.item.level == Level.DIAGNOSE)
    judgement = judge(INVALID, Level.DIAGNOSE, Conversation(Scripted(rejects(expected_issue(INVALID, column=6)))))
    line = Options(parser="cmd:./my parser").reproduce(item)
    lines = failure_text(item, judgement, line, INVALID).splitlines()
    assert lines == [
        "frames/closure-at-unknown-frame/diagnose: failed: the reported errors differ",
        "  pytest conformance/ '--parser=cmd:./my parser' -n0 -k frames/closure-at-unknown-frame/diagnose",
        f"  {INVALID.case.title}",
        f"  EU-FRM-001: {read_clauses()['EU-FRM-001'].text}",
        f"  EU-DIA-001: {read_clauses()['EU-DIA-001'].text}",
        "  /issues/0/column: unknown-frame, column: expected 27, got 6",
        "  reported issues:",
        "    error unknown-frame robot.yaml:5:6: ?",
        f"  {INVALID.description}:5:6",
        "        5 |     frames: [coupler_tip, folower_end]",
        "          |      ^ given",
        "        5 |     frames: [coupler_tip, folower_end]",
        "          |                           ^ expected",
        f"  {INVALID.urdf}",
        "  fix: Name the frame as it is called under `frames`, `follower_end`.",
    ]


#: What clears a screen, and what turns round the text behind it; and what of all scripts must be left as it is.
STEERING, PLAIN = "\x1b[2J\x9b31m \u202e \u2066 \r", "관절 Ω é e\u0301 \u00a0 می\u200cخوریم 👩\u200d🔧"


def test_control_characters_are_escaped_and_scripts_of_languages_kept() -> None:
    item = next(each.item for each in case_items([INVALID]) if each.item.level == Level.DIAGNOSE)
    said = f"{STEERING}{PLAIN}"
    answers = (
        rejects(Issue(code=said, file=said, message=said)),
        accepts(None, Issue(message=said)),
        Answered(Errored(id=1, message=f"{said}\nin two lines"), 0.0),
        Crashed(1, None, log=said),
        Malformed(said, said, log=said),
    )
    for outcome in answers:
        judgement = judge(INVALID, Level.DIAGNOSE, Conversation(Scripted(outcome)))
        text = failure_text(item, judgement, "", INVALID)
        assert not set(text) & {"\x1b", "\x9b", "\u202e", "\u2066", "\r"}
        assert "\\x1b[2J" in text
        assert PLAIN in text
    assert "\nin two lines" in failure_text(
        item, judge(INVALID, Level.ACCEPT, Conversation(Scripted(answers[2]))), "", None
    )


def test_run_ends_with_one_line_on_the_parser() -> None:
    name = f"{STEERING}\nversion 2, accept: 9 of 9 passed: certified"
    wrong = result(next(case_items([INVALID])).item, Verdict.ERRORED, STEERING)
    for smoke in (False, True):
        ended = run(started=started({"2": [Level.ACCEPT]}, name), results=(wrong,), smoke=smoke)
        lines = list(summary_lines(ended, [], None))
        assert not any(set(line) & set("\x1b\x9b\u202e\u2066\r\n") for line in lines)
        assert lines[0].startswith("\\x1b[2J\\x9b31m \\u202e \\u2066 \\r\\nversion 2, accept")


def test_a_failure_of_values_shows_the_configuration() -> None:
    item = next(each.item for each in case_items([VALID]) if each.item.level == Level.KINEMATICS)
    first, *_ = VALID.expected.values
    wrong = [first, *(each.model_copy(update={"residuals": {}}) for each in VALID.expected.values[1:])]
    judgement = judge(
        VALID, Level.KINEMATICS, Conversation(Scripted(accepts(), Answered(Evaluated(id=1, values=wrong), 0)))
    )
    assert isinstance(VALID.case, ValidCase)
    where, lines = json.dumps(VALID.case.configurations[1]), failure_text(item, judgement, "", VALID).splitlines()
    assert f"  at configuration 1: {where}" in lines
    # Whatever the case is about, what the quantity is comes first.
    clauses = [line.split(":")[0].strip() for line in lines if line.startswith("  EU-")]
    assert clauses == list(dict.fromkeys(["EU-CLO-008", "EU-CLO-009", *item.clauses]))


def test_an_item_tests_only_clauses_visible_at_its_level() -> None:
    clauses, seen = read_clauses(), {level: set[str]() for level in Level}
    for item in planned_items(CASES.values()):
        assert item.clauses, item.id
        seen[item.level] |= {clauses[name].level for name in item.clauses}
    assert seen == {
        Level.ACCEPT: {"accept"},
        Level.STRUCTURE: {"accept", "structure"},
        Level.KINEMATICS: {"accept", "structure", "kinematics"},
        Level.DYNAMICS: {"accept", "structure", "kinematics", "dynamics"},
        Level.DIAGNOSE: {"accept", "diagnose"},
    }
    accept = {each.case.id: each.item for each in case_items([VALID, INVALID]) if each.item.level == Level.ACCEPT}
    assert accept[VALID.id].clauses[-1] == "EU-CNF-002"
    assert accept[INVALID.id].clauses[-1] == "EU-CNF-001"


def test_every_cited_clause_is_tested_by_an_item() -> None:
    cited = {clause for case in CASES.values() for clause in case.case.clauses}
    cited |= {clause for found in PROPERTIES for clause in found.clauses}
    assert cited <= {clause for item in planned_items(CASES.values()) for clause in item.clauses}


class NoParser(Session):
    """Started by its own word, and nothing else."""

    @property
    def started(self) -> Started:
        claims: dict[Version, list[Level]] = {"2": list(Level)}
        return Started(id=1, protocol="1.0", parser=ParserInfo(name="r", version="1", language="Python"), claims=claims)


def test_an_error_in_the_suite_is_reported_as_a_failure() -> None:
    item_runner, item = ItemRunner(Options(), NoParser("cmd:nothing")), next(case_items([VALID])).item
    item_runner.node = SimpleNamespace(user_properties=[])  # type: ignore[assignment]

    def broken() -> Judgement:
        raise KeyError("elbow")

    with pytest.raises(pytest.fail.Exception, match="an error in the suite itself, please report it: KeyError"):
        item_runner.run(item, broken)
    assert item_runner.node is not None
    kept = dict(item_runner.node.user_properties)[RESULT]
    assert isinstance(kept, dict)
    assert kept["verdict"] == "failed"


def test_a_failed_protocol_rule_names_its_files() -> None:
    with Session("cmd:" + shlex.join([sys.executable, "-c", "print(1)"])) as session:
        found = check(GOES_ON, Setup(session, lambda: session, VALID, INVALID))
    assert found.verdict != Verdict.PASSED
    assert {str(VALID.description), str(INVALID.urdf)} <= set(found.log.splitlines())


@pytest.mark.slow
@pytest.mark.parametrize("code", [pytest.ExitCode.INTERRUPTED, pytest.ExitCode.INTERNAL_ERROR])
def test_an_interrupted_run_writes_no_certificate(code: pytest.ExitCode, tmp_path: Path) -> None:
    config = SimpleNamespace(stash={OPTIONS: Options(certificate=tmp_path)})
    collector = Collector(config)  # type: ignore[arg-type]
    collector._started = NoParser("cmd:nothing").started
    session = SimpleNamespace(exitstatus=pytest.ExitCode.OK)
    collector.pytest_sessionfinish(session, code)  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []
    collector.pytest_sessionfinish(session, pytest.ExitCode.OK)  # type: ignore[arg-type]
    assert (tmp_path / "certificate.json").is_file()


# As pytest runs it


def suite(
    *arguments: str, parser: str | None = None, command: Sequence[str] = ("conformance/",), cwd: Path = ROOT
) -> tuple[int, str]:
    """Run the suite, in one process: exit code, and what it writes."""
    parser = [f"--parser=case_parser:{parser}"] if parser else []
    seed = [] if "-n2" in arguments else ["--seed=0"]  # several processes agree on a seed by themselves
    argv = [*command, "-n0", "-p", "no:cacheprovider", *seed, *parser, *arguments]
    environment = os.environ | {"PYTHONPATH": str(ROOT / "conformance" / "tests" / "parsers"), "COLUMNS": "200"}
    done = run_module("pytest", argv, cwd=cwd, environment=environment)
    assert "INTERNALERROR" not in done.stdout + done.stderr
    return done.returncode, done.stdout + done.stderr


#: The two cases at which wrong parsers go wrong, and what asks of the protocol with them.
FEW = "closures/parallelogram-3d-closure or frames/closure-at-unknown-frame"


def test_a_clause_selects_what_tests_it() -> None:
    code, out = suite("--collect-only", "-k", "EU-CPL-006", parser="Right")
    tested = {item.id for item in planned_items(all_cases()) if "EU-CPL-006" in item.clauses}
    found = set(re.findall(r"\[([^\]]+)/\w+\]", out))
    assert (code, found) == (0, tested)


@pytest.mark.slow
def test_printed_command_reproduces_a_failure() -> None:
    code, out = suite("-k", FEW, parser="Misread")
    assert code == 1
    assert "3 failed, 4 passed" in out
    assert "/robot/joints/0/upper/0: joint 'motor', upper: expected 1.5, got 9.0" in out
    assert "/values/0/poses/elbow/translation: origin of frame 'elbow' in the world, m, off by 7" in out
    assert "/issues/0/column: unknown-frame, column: expected 27, got 28" in out
    assert re.search(r"version 2, accept: 2 of \d+ passed, valid .* \(\d+ not run\): not certified", out)
    line = next(line.strip() for line in out.splitlines() if "-k closures/parallelogram-3d-closure/structure" in line)
    program, *arguments = shlex.split(line)
    assert program == "pytest"
    code, out = suite(command=arguments)
    assert code == 1
    assert "1 failed" in out
    assert "passed" not in out.splitlines()[-1]


@pytest.mark.slow
def test_unclaimed_level_is_skipped_and_unsupported_claim_fails() -> None:
    code, out = suite("-k", FEW, parser="Modest")
    assert code == 0
    assert "2 passed, 5 skipped" in out
    assert "not claimed: accept of version 1" in out
    code, out = suite("-k", FEW, "-rs", parser="Shy")
    assert code == 1
    assert "7 failed" in out
    assert "closures/parallelogram-3d-closure/accept: unsupported: closures: not written yet" in out
    assert "frames/closure-at-unknown-frame/accept: skipped: it is Sunday" in out


KNOWN = """
- {id: frames/closure-at-unknown-frame, level: accept, verdict: failed, reason: It looks only odd.}
- {id: frames/closure-at-unknown-frame, level: diagnose, verdict: failed, reason: It looks only odd.}
"""


@pytest.mark.slow
def test_fixed_known_failure_is_reported(tmp_path: Path) -> None:
    path = tmp_path / "known.yaml"
    path.write_text(KNOWN, encoding="utf-8")
    code, out = suite("-k", FEW, f"--known-failures={path}", parser="Lenient")
    assert code == 0
    assert re.search("5 passed.* 2 xfailed", out)
    assert re.search(r"accept: 1 of \d+ passed, valid .* \(1 failed, .*; known failures: 1\): not certified", out)
    code, out = suite("-k", FEW, f"--known-failures={path}", parser="Right")
    assert code == 1
    assert "listed as 'failed' but passes; remove it from the known failures" in out
    path.write_text(KNOWN.replace("failed", "crashed"), encoding="utf-8")
    code, out = suite("-k", FEW, f"--known-failures={path}", parser="Lenient")
    assert code == 1
    assert "2 failed, 5 passed" in out
    assert "listed as 'crashed', but the verdict is 'failed'" in out
    path.write_text(KNOWN.replace("closure-at-unknown-frame", "nobody"), encoding="utf-8")
    code, out = suite("-k", FEW, f"--known-failures={path}", parser="Right")
    assert code == 1
    assert "frames/nobody/accept: the suite has no such item" in out


@pytest.mark.slow
def test_impossible_requests_of_the_user_are_reported(tmp_path: Path) -> None:
    for arguments, why in (
        ([f"--known-failures={tmp_path / 'nowhere.yaml'}"], "No such file"),
        (["--parser-timeout=0"], "a time limit must be positive"),
        (["--parser-start-timeout=nan"], "a time limit must be positive"),
        (["--explore=-1"], "--explore must not be negative"),
        (["--smoke", "--explore=1"], "--smoke cannot be combined with --known-failures or --explore"),
        ([f"--certificate={__file__}"], "is a file; a certificate is written into a folder"),
        (["--certificate="], "the folder name is empty"),
        (["--level=everything"], "invalid choice"),
        (["--parser="], "--parser is empty"),
        (
            ["--parser=cmd:no-such-program-anywhere"],
            "'cmd:no-such-program-anywhere' could not be started: program 'no-such-program-anywhere' is not in PATH",
        ),
    ):
        code, out = suite(*arguments, parser="Right")
        assert code == pytest.ExitCode.USAGE_ERROR
        assert why in out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("parser", "asked"),
    [
        (
            "Right",
            [
                "closures/parallelogram-3d-closure/accept",
                "frames/closure-at-unknown-frame/accept",
                "urdf/gantry/kinematics",
            ],
        ),
        ("Moving", ["urdf/gantry/dynamics"]),
        ("Telling", ["closures/parallelogram-3d-closure/structure", "frames/closure-at-unknown-frame/diagnose"]),
    ],
)
def test_smoke_runs_three_cases_at_the_first_claimed_level(parser: str, asked: list[str]) -> None:
    code, out = suite("--smoke", "-vv", "--format-version=2", parser=parser)
    assert code == 0
    assert "nothing was asked" not in out
    assert sorted(re.findall(r"test_case\[([\w/-]+)\] PASSED", out)) == asked


@pytest.mark.slow
def test_run_without_claimed_levels_fails() -> None:
    code, out = suite("--smoke", parser="Silent")
    assert code == 1
    assert "nothing was tested: your parser claims none of the requested levels" in out
    code, out = suite("--level=dynamics", parser="Modest")
    assert code == 1
    assert "not claimed: dynamics of version 1, dynamics of version 2" in out


@pytest.mark.slow
def test_the_reference_is_tested_by_default() -> None:
    code, out = suite("--smoke")
    assert code == 0
    assert "eurdf " in out


@pytest.mark.slow
def test_the_suite_runs_as_an_installed_package() -> None:
    command = ["--pyargs", "eurdf_conformance.suite", "-p", "eurdf_conformance.suite.plugin"]
    code, out = suite("--noconftest", "-k", FEW, parser="Right", command=command)
    assert code == 0
    assert "7 passed" in out
    code, out = suite("-k", FEW, parser="Lenient", command=command)
    assert (
        f"pytest {' '.join(command)} --parser=case_parser:Lenient -n0 -k frames/closure-at-unknown-frame/accept" in out
    )
    code, out = suite("-k", FEW, parser="Right", command=command)
    assert code == 0


@pytest.mark.slow
def test_in_another_folder_the_printed_command_names_the_package(tmp_path: Path) -> None:
    code, out = suite(
        "-k",
        "frames/closure-at-unknown-frame/accept",
        parser="Lenient",
        command=[str(ROOT / "conformance")],
        cwd=tmp_path,
    )
    assert code == 1
    assert "  pytest --pyargs eurdf_conformance.suite -p eurdf_conformance.suite.plugin --parser=" in out
