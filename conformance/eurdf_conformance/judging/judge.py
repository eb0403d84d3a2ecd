"""Judges the answers of a parser on one case at one level."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.comparison.issues import error_differences, warning_differences
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.corpus.case import InvalidCase, ValidCase
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.feature import Feature, ordered
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
    """The verdict on the answers, with the reason.

    Attributes:
        verdict: The verdict.
        reason: What is wrong, in one sentence; empty if nothing is.
        differences: Differences between the expected and the given answer.
        issues: The issues that the parser reported.
        log: Further details, which may differ from run to run.
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
    """Ask a parser about a case and judge its answers.

    Args:
        case: The case.
        level: One of its levels.
        conversation: The conversation with the parser.
    """
    lacks = conversation.lacks
    if lacked := lacks and lacks & case.features:
        found = judge_lacking(conversation.load(case), lacked)
        if found is not None and (found.verdict == Verdict.EXCUSED or _to_load(case) != "rejected"):
            return found
    judgement = _judge_at(case, level, conversation)
    if judgement.verdict == Verdict.UNSUPPORTED:
        return replace(judgement, reason=f"{judgement.reason}{_not_excused(conversation.load(case), lacks)}")
    return judgement


def judge_lacking(outcome: Outcome, lacked: frozenset[Feature]) -> Judgement | None:
    """EU-CNF-004, EU-CNF-008: the judgement on loading files that use features that the parser lacks.

    Args:
        outcome: The outcome of loading them.
        lacked: The features that the parser lacks and the files use.

    Returns:
        None if the outcome is judged as without these features.
    """
    match outcome:
        case Answered(answer=Unsupported(feature=feature)) if feature in lacked:
            return Judgement(Verdict.EXCUSED, f"the parser lacks {feature}")
        case Answered(answer=Accepted(issues=issues)):
            named = ", ".join(ordered(lacked))
            why = f"the parser names {named} in `lacks`, but accepts a description that uses it"
            wrong = Difference("/outcome", "unsupported", "accepted", why)
            return Judgement(Verdict.FAILED, why, (wrong,), tuple(issues))
    return None


def _not_excused(outcome: Outcome, lacks: frozenset[Feature]) -> str:
    """Why the answer `unsupported` is not excused, if it names a feature that a parser may lack."""
    match outcome:
        case Answered(answer=Unsupported(feature=feature)) if feature in list(Feature):
            return "; the files do not use it" if feature in lacks else "; the parser does not name it in `lacks`"
    return ""


def _judge_at(case: CorpusCase, level: Level, conversation: Conversation) -> Judgement:
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
    """EU-PRO-006: the judgement if the outcome is not an answer of the requested kind.

    Args:
        outcome: The outcome.
        expected: The `outcome` that the answer should have, if given.
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
            # The error names its place in the answer, so the beginning of the line is not shown.
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
    """The judgement of an answer of another kind than requested, and a description of that answer."""
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
    """The expected `outcome` of loading a case."""
    if not isinstance(case.case, InvalidCase):
        return "accepted"
    return "accepted or rejected" if case.case.either else "rejected"


def _judge_accept(case: CorpusCase, conversation: Conversation) -> Judgement:
    """EU-CNF-001, EU-CNF-002: accept valid files, reject invalid ones; inertia and closure errors may be either."""
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
    """EU-CNF-003, and whether the reported issues have the expected codes and places."""
    outcome = conversation.load(case)
    match outcome, case.case:
        case Answered(answer=Accepted(issues=issues)), ValidCase(warnings=warnings):
            found = warning_differences(warnings, issues)
            return _unless(found, "the reported warnings differ", "", issues)
        case Answered(answer=Accepted()), InvalidCase(either=False):
            return _judge_accept(case, conversation)
        case Answered(answer=Accepted(issues=issues) | Rejected(issues=issues)), InvalidCase() as invalid:
            return _unless(error_differences(invalid, issues, case.warnings), "the reported errors differ", "", issues)
    return judge_outcome(outcome, _to_load(case))


def _unless(found: Sequence[Difference], reason: str, pointer: str, issues: Sequence[Issue] = ()) -> Judgement:
    if not found:
        return PASSED
    return Judgement(Verdict.FAILED, reason, tuple(each.within(pointer) for each in found), tuple(issues))


def _only(values: Values, quantities: Collection[Quantity]) -> Values:
    return values.model_copy(update={name: None for name in Values.model_fields if name not in quantities})
