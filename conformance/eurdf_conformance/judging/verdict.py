"""The words for what became of an item."""

from __future__ import annotations

from enum import StrEnum


class Verdict(StrEnum):
    """What became of an item. `PASSED` alone is a pass, whatever the others are."""

    PASSED = "passed"
    #: The answer is not the expected one.
    FAILED = "failed"
    #: The parser says that it lacks a feature.
    UNSUPPORTED = "unsupported"
    #: The parser would rather not answer.
    SKIPPED = "skipped"
    #: The parser failed by its own word.
    ERRORED = "errored"
    #: The process ended without an answer.
    CRASHED = "crashed"
    TIMED_OUT = "timed out"
    #: The line is no answer.
    MALFORMED = "malformed"
    #: The answer is to another request.
    MISPLACED = "misplaced"
    #: More lines than requests.
    CHATTER = "chatter"
    #: The process cannot be started, or not again.
    NOT_STARTED = "not started"
    #: The item was never asked: the run was cut short, or limited to other items.
    NOT_RUN = "not run"


#: Verdicts that say something of how a parser is connected rather than of what it reads.
OF_THE_ADAPTER = frozenset(
    {Verdict.CRASHED, Verdict.TIMED_OUT, Verdict.MALFORMED, Verdict.MISPLACED, Verdict.CHATTER, Verdict.NOT_STARTED}
)
