"""Checks whether a parser follows the rules of the protocol."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.corpus.protocol_rule import GOES_ON, QUIET, START, STOP, ProtocolRule
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.feature import Feature
from eurdf_conformance.judging.handout import Handout
from eurdf_conformance.judging.judge import PASSED, Judgement, judge_lacking, judge_outcome
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.protocol.message import Accepted, Rejected, Started
from eurdf_conformance.runner.outcome import Answered, Outcome
from eurdf_conformance.runner.session import Session


@dataclass(frozen=True, slots=True)
class Setup:
    """What a check of a rule needs.

    Attributes:
        session: A session with the parser.
        another: Opens a further session with it.
        valid: A case that the parser should accept.
        invalid: A case that it should reject.
        handout: The files that it receives.
        lacks: The features that the parser lacks.
    """

    session: Session
    another: Callable[[], Session]
    valid: CorpusCase
    invalid: CorpusCase
    handout: Handout = field(default_factory=Handout)
    lacks: frozenset[Feature] = frozenset()

    def load(self, case: CorpusCase) -> Outcome:
        """The outcome of loading a case."""
        return self.session.load(*self.handout.files(case))


def check(rule: ProtocolRule, setup: Setup) -> Judgement:
    """Whether a parser follows a rule; if not, the log names the files that were loaded."""
    judgement = _CHECKS[rule](setup)
    if judgement.verdict == Verdict.PASSED or rule not in (QUIET, GOES_ON):
        return judgement
    files = [str(path) for case in (setup.valid, setup.invalid) for path in (case.description, case.urdf)]
    return replace(judgement, log="\n".join(filter(None, (judgement.log, *files))))


def _start(setup: Setup) -> Judgement:
    """EU-PRO-001, EU-PRO-003."""
    outcome = setup.session.start()
    match outcome:
        case Answered(answer=Started()):
            return PASSED
    return judge_outcome(outcome, "started")


def _quiet(setup: Setup) -> Judgement:
    """EU-PRO-002: every answer is one line."""
    for case in (setup.valid, setup.invalid, setup.valid):
        outcome = setup.load(case)
        if not isinstance(outcome, Answered):
            return judge_outcome(outcome)
    return PASSED


def _goes_on(setup: Setup) -> Judgement:
    """EU-PRO-004, EU-PRO-005."""
    first, rejected, again = [setup.load(case) for case in (setup.valid, setup.invalid, setup.valid)]
    lacked = setup.lacks and setup.lacks & setup.valid.features
    if lacked and (lacking := judge_lacking(first, lacked)):
        return lacking
    match rejected:
        case Answered(answer=Rejected()):
            pass
        case Answered(answer=Accepted()):
            why = "the parser accepts an invalid description"
            return Judgement(Verdict.FAILED, why, (Difference("/outcome", "rejected", "accepted", why),))
        case _:
            return judge_outcome(rejected, "rejected")
    match first, again:
        case Answered(answer=Accepted(robot=None)), Answered(answer=Accepted(robot=None)):
            return PASSED
        case Answered(answer=Accepted(robot=one)), Answered(answer=Accepted(robot=other)) if one and other:
            found = canonical_differences(one, other, setup.valid.expected.bodies)
            reason = "after a rejected description the same files give another canonical description"
            return Judgement(Verdict.FAILED, reason, tuple(found)) if found else PASSED
        case Answered(answer=Accepted()), Answered(answer=Accepted()):
            return Judgement(Verdict.FAILED, "only one of two answers on the same files has a canonical description")
        case Answered(answer=Accepted()), _:
            return judge_outcome(again, "accepted")
    return judge_outcome(first, "accepted")


def _stop(setup: Setup) -> Judgement:
    """EU-PRO-001."""
    with setup.another() as session:
        first = session.start()
        begin = time.perf_counter()
        outcome = session.stop()
        stopping = time.perf_counter() - begin
    setup.session.seconds_in_parser += session.seconds_in_parser + stopping
    setup.session.left += session.left
    if outcome is None:
        return judge_outcome(first, "started")
    return PASSED if isinstance(outcome, Answered) else judge_outcome(outcome)


_CHECKS: Mapping[ProtocolRule, Callable[[Setup], Judgement]] = {
    START: _start,
    QUIET: _quiet,
    GOES_ON: _goes_on,
    STOP: _stop,
}
