"""What the answers of a parser on one case come to, at one level."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.comparison.issues import error_differences, warning_differences
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.corpus.case import InvalidCase, ValidCase
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.judging.conversation import Conversation
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level
from eurdf_conformance.level_spec import LEVELS, Compared
from eurdf_conformance.protocol.message import (
    Accepted,
    AnyAnswer,
    Errored,
    Evaluated,
    Issue,
    Quantity,
    Rejected,
    Skipped,
    Unsupported,
    Values,
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


@dataclass(frozen=True, slots=True)
class Judgement:
    """What the answers come to.

    Attributes:
        verdict: The word for it.
        reason: What is wrong, in a sentence; empty where nothing is.
        differences: Of answers that are not the expected ones.
        issues: What the parser said that is wrong with the files.
        log: What there is to know beside, which may differ from run to run.
    """

    verdict: Verdict
    reason: str = ""
    differences: tuple[Difference, ...] = ()
    issues: tuple[Issue, ...] = ()
    log: str = ""


PASSED = Judgement(Verdict.PASSED)

#: Characters shown of a line that is no answer.
_WIDTH = 200


def judge(case: CorpusCase, level: Level, conversation: Conversation) -> Judgement:
    """Ask a parser on a case, and say what its answers come to.

    Args:
        case: The case.
        level: One of its levels.
        conversation: With the parser.
    """
    match LEVELS[level].compared:
        case Compared.OUTCOME:
            return _judge_accept(case, conversation)
        case Compared.ROBOT:
            return _judge_structure(case, conversation)
        case Compared.VALUES:
            return _judge_values(case, conversation, LEVELS[level].quantities)
        case Compared.ISSUES:
            return _judge_diagnose(case, conversation)


def judge_outcome(outcome: Outcome, expected: str = "") -> Judgement:
    """EU-PRO-006: what becomes of an item whose outcome is none of the answers that it was asked for.

    Args:
        outcome: The outcome.
        expected: The word that the answer should be, if given.
    """
    match outcome:
        case Answered(answer=answer):
            judgement, why = _judge_answer(answer)
            wrong = Difference("/outcome", expected, answer.outcome, why)
            return replace(judgement, differences=(wrong,)) if expected else judgement
        case Crashed(code=None, signal=None):
            verdict, why = Verdict.CRASHED, "the process closed its standard output without answering"
        case Crashed(code=code, signal=signal):
            verdict, how = Verdict.CRASHED, f"by {signal}" if signal else f"with exit code {code}"
            why = f"the process ended {how} without answering"
        case TimedOut():
            verdict, why = Verdict.TIMED_OUT, "no answer within the time limit"
        case Malformed(line=line, why=what, placed=placed):
            # The beginning of an answer with an error says nothing; the error says where it is.
            verdict, quoted = Verdict.MALFORMED, "" if placed else f": {line[:_WIDTH]!r}"
            why = f"invalid answer: {what}{quoted}"
        case Misplaced():
            verdict, why = Verdict.MISPLACED, "the answer has the id of another request"
        case Chatter(lines=lines):
            verdict, why = Verdict.CHATTER, f"unexpected output: {lines[0][:_WIDTH]!r}"
        case CannotStart(why=what):
            verdict, why = Verdict.NOT_STARTED, what.splitlines()[0]
    log = str(outcome)
    if isinstance(outcome, Malformed | CannotStart):
        log = log.partition("\n")[2]  # the first line is the reason
    return Judgement(verdict, why, log=log)


def _judge_answer(answer: AnyAnswer) -> tuple[Judgement, str]:
    """What an answer comes to that is not the one asked for, and what it is, in words of the suite."""
    match answer:
        case Unsupported(feature=feature, reason=reason):
            return Judgement(Verdict.UNSUPPORTED, f"{feature}: {reason}" if reason else feature), "unsupported feature"
        case Skipped(reason=reason):
            return Judgement(Verdict.SKIPPED, reason), "the parser skipped the request"
        case Errored(message=message):
            return Judgement(Verdict.ERRORED, message), "the parser reported a failure"
        case Rejected(issues=issues):
            why = "the parser rejects a valid description"
            return Judgement(Verdict.FAILED, why, issues=tuple(issues)), why
        case _:
            why = f"the outcome is '{answer.outcome}'"
            return Judgement(Verdict.FAILED, why), why


def _to_load(case: CorpusCase) -> str:
    """The answer that a case is to be loaded with."""
    if not isinstance(case.case, InvalidCase):
        return "accepted"
    return "accepted or rejected" if case.case.either else "rejected"


def _judge_accept(case: CorpusCase, conversation: Conversation) -> Judgement:
    """EU-CNF-001, EU-CNF-002: valid in, invalid out; an error of inertia or closure may be either."""
    outcome = conversation.load(case)
    match outcome, case.case:
        case Answered(answer=Accepted()), ValidCase():
            return PASSED
        case Answered(answer=Accepted() | Rejected()), InvalidCase(either=True):
            return PASSED
        case Answered(answer=Rejected()), InvalidCase():
            return PASSED
        case Answered(answer=Accepted(issues=issues)), InvalidCase(code=code):
            why = f"the parser accepts an invalid description: {code}"
            wrong = Difference("/outcome", "rejected", "accepted", why)
            return Judgement(Verdict.FAILED, why, (wrong,), tuple(issues))
    return judge_outcome(outcome, _to_load(case))


def _judge_structure(case: CorpusCase, conversation: Conversation) -> Judgement:
    outcome = conversation.load(case)
    match outcome:
        case Answered(answer=Accepted(robot=None)):
            wrong = Difference("/robot", case.expected.robot, None, "level structure requires it")
            return Judgement(Verdict.FAILED, "the answer has no canonical description", (wrong,))
        case Answered(answer=Accepted(robot=robot)) if robot is not None:
            found = canonical_differences(case.expected.robot, robot, case.expected.bodies)
            return _unless(found, "the canonical description differs", "/robot")
    return judge_outcome(outcome, _to_load(case))


def _judge_values(case: CorpusCase, conversation: Conversation, quantities: Sequence[Quantity]) -> Judgement:
    loaded = conversation.load(case)
    outcome = conversation.evaluate(case, quantities)
    match outcome:
        case Answered(answer=Evaluated(values=values)):
            expected = case.expected
            if len(values) != len(expected.values):
                wrong = Difference("/values", len(expected.values), len(values), "number of configurations")
                return _unless([wrong], "one value per configuration is required", "")
            found = []
            for index, (one, other, size) in enumerate(zip(expected.values, values, expected.sizes, strict=True)):
                pointer = f"/values/{index}"
                found += [each.within(pointer) for each in values_differences(_only(one, quantities), other, size)]
            return _unless(found, "the values differ", "")
    return judge_outcome(outcome, _to_load(case) if outcome is loaded else "evaluated")


def _judge_diagnose(case: CorpusCase, conversation: Conversation) -> Judgement:
    """EU-CNF-003, and that what is said to be wrong, and where, is what is wrong."""
    outcome = conversation.load(case)
    match outcome, case.case:
        case Answered(answer=Accepted(issues=issues)), ValidCase(warnings=warnings):
            found = warning_differences(warnings, issues)
            return _unless(found, "the reported warnings differ", "", issues)
        case Answered(answer=Accepted()), InvalidCase(either=False):
            return _judge_accept(case, conversation)
        case Answered(answer=Accepted(issues=issues) | Rejected(issues=issues)), InvalidCase() as invalid:
            return _unless(error_differences(invalid, issues), "the reported errors differ", "", issues)
    return judge_outcome(outcome, _to_load(case))


def _unless(found: Sequence[Difference], reason: str, pointer: str, issues: Sequence[Issue] = ()) -> Judgement:
    if not found:
        return PASSED
    return Judgement(Verdict.FAILED, reason, tuple(each.within(pointer) for each in found), tuple(issues))


def _only(values: Values, quantities: Collection[Quantity]) -> Values:
    return values.model_copy(update={name: None for name in Values.model_fields if name not in quantities})
