"""The possible outcomes of a request. Only an `Answered` with the answer `rejected` is a rejection."""

from __future__ import annotations

from dataclasses import dataclass

from eurdf_conformance.protocol.message import AnyAnswer, Errored, Skipped, Unsupported


@dataclass(frozen=True, slots=True)
class Answered:
    """An answer to the request, of a kind that the request may have, which fits its schema.

    Attributes:
        answer: The answer.
        seconds: From the request to the end of the line that answers it.
    """

    answer: AnyAnswer
    seconds: float

    @property
    def word(self) -> str:
        """The outcome in the words of the protocol."""
        return self.answer.outcome

    def __str__(self) -> str:
        match self.answer:
            case Errored(message=said) | Skipped(reason=said) | Unsupported(feature=said):
                return f"answered '{self.word}'" + (f": {said}" if said else "")
        return f"answered '{self.word}'"


@dataclass(frozen=True, slots=True)
class Crashed:
    """The process ended without an answer.

    Attributes:
        code: Its exit code; None where a signal ended it, or where it closed its standard output and went on.
        signal: Name of the signal that ended it, or None.
        log: The end of what it wrote to standard error meanwhile.
        written: The beginning of what it wrote in place of an answer.
        before: Whether it had ended already when it was to be asked: after the answer to the request before.
    """

    code: int | None
    signal: str | None
    log: str
    written: str = ""
    before: bool = False

    word = "crashed"

    def __str__(self) -> str:
        if self.signal is not None:
            how = f"crashed: ended by {self.signal}"
        elif self.code is not None:
            how = f"crashed: ended with exit code {self.code}"
        else:
            how = "crashed: closed its standard output"
        when = " after answering the previous request" if self.before else " without answering"
        return how + when + _written(self.written) + _logged(self.log)


@dataclass(frozen=True, slots=True)
class TimedOut:
    """There was no answer in the time allowed.

    Attributes:
        seconds: The time allowed.
        written: The beginning of what was written in place of an answer: of a line that did not end, for example.
        log: The end of what went to standard error meanwhile.
    """

    seconds: float
    written: str = ""
    log: str = ""

    word = "timed out"

    def __str__(self) -> str:
        return f"timed out: no answer in {self.seconds:g} s" + _written(self.written) + _logged(self.log)


@dataclass(frozen=True, slots=True)
class Malformed:
    """A line that is no JSON object, or does not fit the schema of an answer to the request.

    Attributes:
        line: Its beginning; empty where `why` is all that it says.
        why: What is wrong with it.
        placed: Whether it repeats the id of the request, so that the process can be asked on.
        log: The end of what went to standard error meanwhile.
    """

    line: str
    why: str
    placed: bool = False
    log: str = ""

    word = "malformed"

    def __str__(self) -> str:
        return f"malformed: {self.why}" + _written(self.line) + _logged(self.log)


@dataclass(frozen=True, slots=True)
class Misplaced:
    """An answer to another request.

    Attributes:
        line: Its beginning.
        expected_id: Id of the request.
        given_id: Id of the answer.
    """

    line: str
    expected_id: int
    given_id: int

    word = "misplaced"

    def __str__(self) -> str:
        return f"misplaced: the answer to request {self.expected_id} has the id {self.given_id}"


@dataclass(frozen=True, slots=True)
class Chatter:
    """There are more lines than requests: the answer is among lines that are not answers.

    Attributes:
        lines: The others, each by its beginning.
        answer: The answer that was found among them.
    """

    lines: tuple[str, ...]
    answer: AnyAnswer | None = None

    word = "chatter"

    def __str__(self) -> str:
        count = "an unexpected line" if len(self.lines) == 1 else f"{len(self.lines)} unexpected lines"
        return f"chatter: {count} on standard output" + _written("\n".join(self.lines))


@dataclass(frozen=True, slots=True)
class CannotStart:
    """There is no process to ask.

    Attributes:
        why: Why not: there is no such program, or it did not answer `start`.
    """

    why: str

    word = "cannot start"

    def __str__(self) -> str:
        return f"cannot start: {self.why}"


#: Lines shown of a log: of Node.js, the last dozen say where it was when it found that a package is missing.
_LOG_LINES = 20

Failure = Crashed | TimedOut | Malformed | Misplaced | Chatter | CannotStart
Outcome = Answered | Failure


def _written(text: str) -> str:
    return f"\n  it wrote: {text!r}" if text else ""


def _logged(text: str) -> str:
    lines = text.strip().splitlines()[-_LOG_LINES:]
    return "".join(f"\n  log: {line}" for line in lines)
