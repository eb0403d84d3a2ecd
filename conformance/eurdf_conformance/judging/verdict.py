"""The verdicts on an item."""

from __future__ import annotations

from eurdf_conformance.text_enum import TextEnum


class Verdict(TextEnum):
    """The verdict on an item. Only `PASSED` is a pass; `EXCUSED` is neither a pass nor a failure."""

    PASSED = "passed"
    #: The parser answers that it lacks a feature, which it names in `lacks` and the files use.
    EXCUSED = "excused"
    #: The answer is not the expected one.
    FAILED = "failed"
    #: The parser answers that it lacks a feature, which it may not lack or which the files do not use.
    UNSUPPORTED = "unsupported"
    #: The parser chose not to answer.
    SKIPPED = "skipped"
    #: The parser reported that it failed.
    ERRORED = "errored"
    #: The process ended without an answer.
    CRASHED = "crashed"
    TIMED_OUT = "timed out"
    #: The line is not a valid answer.
    MALFORMED = "malformed"
    #: The answer is to another request.
    MISPLACED = "misplaced"
    #: More lines than requests.
    CHATTER = "chatter"
    #: The process cannot be started, or not again.
    NOT_STARTED = "not started"
    #: The item was never asked: the run was cut short, or limited to other items.
    NOT_RUN = "not run"


#: Verdicts that are no failure.
NO_FAILURE = frozenset({Verdict.PASSED, Verdict.EXCUSED})

#: Verdicts that point to an error in the adapter rather than in the parser.
OF_THE_ADAPTER = frozenset(
    {Verdict.CRASHED, Verdict.TIMED_OUT, Verdict.MALFORMED, Verdict.MISPLACED, Verdict.CHATTER, Verdict.NOT_STARTED}
)
