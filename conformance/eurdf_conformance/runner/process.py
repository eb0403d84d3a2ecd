"""One process of a parser. It gets one request at a time, and is ended when answers can no longer be matched."""

from __future__ import annotations

import signal
import time
from collections.abc import Sequence
from dataclasses import replace

from eurdf_conformance.protocol.message import AnyRequest, Start
from eurdf_conformance.runner.answer import read_answer, shown
from eurdf_conformance.runner.outcome import Answered, Chatter, Crashed, Malformed, Misplaced, Outcome, TimedOut
from eurdf_conformance.runner.pipes import LINE_LIMIT, Pipes, Silence

# After a line that is no answer, one may still follow within this time, s: then a library has only been talkative.
_SETTLE = 1.0

# So many lines that are no answers are one too many.
_MOST_LINES = 100


class ParserProcess:
    """A running parser."""

    def __init__(self, command: Sequence[str], line_limit: int = LINE_LIMIT) -> None:
        """Start it; for the exceptions see `Pipes`."""
        self._line_limit = line_limit
        self._pipes = Pipes(command, line_limit)
        self.alive = True

    def ask(self, request: AnyRequest, timeout: float) -> Outcome:
        """EU-PRO-010: send a request and wait for its answer.

        What was written since the last answer belongs to no request. The process is ended, and not to be asked again,
        after any outcome that leaves open which line would be the next answer: all but `Answered`, `Chatter` and a
        `Malformed` line that repeats the id.

        Args:
            request: The request. Its id must be one that this process was not asked before.
            timeout: Time allowed, s.
        """
        outcome = self._ask(request, timeout)
        if not (isinstance(outcome, Answered | Chatter) or (isinstance(outcome, Malformed) and outcome.placed)):
            self.end()
        return outcome

    def stop(self, request: AnyRequest, timeout: float) -> Outcome:
        """Send the last request, and end the process if it does not end by itself, with exit code 0, in the time."""
        deadline = time.monotonic() + timeout
        outcome = self.ask(request, timeout)
        if isinstance(outcome, Answered) and self.alive:
            self._pipes.close_input()
            if not self._pipes.await_exit(deadline):
                outcome = TimedOut(timeout, log="it answered 'stopped' but did not exit")
            elif (crashed := self._crashed("", before=True)).code != 0:
                outcome = crashed
        self.end()
        return outcome

    @property
    def left(self) -> tuple[str, ...]:
        """Names of the processes that it left behind outside its group; known, and ended, with it."""
        return self._pipes.left

    def end(self) -> None:
        """End the process and all that it started."""
        self.alive = False
        self._pipes.close()

    def _ask(self, request: AnyRequest, timeout: float) -> Outcome:
        strays: list[bytes] = []  # lines that were written before anything was asked, ...
        while len(strays) < _MOST_LINES and (line := self._pipes.line(0.0)) is not Silence.TIME_OUT:
            if isinstance(line, Silence):
                return self._silent(line, timeout, strays, before=not isinstance(request, Start))
            strays.append(line)
        others: list[bytes] = []  # ... and afterwards, and are no answers
        begin = time.perf_counter()
        self._pipes.send(request.model_dump_json().encode())
        deadline = time.monotonic() + timeout
        while len(strays) + len(others) < _MOST_LINES:
            line = self._pipes.line(deadline)
            if line is Silence.TIME_OUT and others:
                break
            if isinstance(line, Silence):
                return self._silent(line, timeout, strays + others)
            seconds = time.perf_counter() - begin
            found = read_answer(line, request)
            if isinstance(found, Misplaced):
                return found
            if not isinstance(found, Malformed):
                others += self._rest()
                lines = tuple(map(shown, strays + others))
                return Chatter(lines, found) if lines else Answered(found, seconds)
            if found.placed:
                return replace(found, log=self._pipes.log)
            others.append(line)
            deadline = min(deadline, time.monotonic() + _SETTLE)
        first = (others or strays)[0]
        found = read_answer(first, request)
        why = found.why if isinstance(found, Malformed) else f"{_MOST_LINES} unexpected lines"
        return Malformed(shown(first), why, log=self._pipes.log)

    def _rest(self) -> list[bytes]:
        """The lines after an answer that are there already."""
        lines: list[bytes] = []
        while len(lines) < _MOST_LINES and isinstance(line := self._pipes.line(0.0), bytes):
            lines.append(line)
        return lines

    def _silent(self, silence: Silence, timeout: float, lines: Sequence[bytes], before: bool = False) -> Outcome:
        """The outcome if no answer came."""
        pipes = self._pipes
        if silence is Silence.TOO_LONG:
            why = f"a line of more than {self._line_limit:,} bytes"
            return Malformed(shown(pipes.unfinished), why, log=pipes.log)
        written = "\n".join(shown(line) for line in (*lines, pipes.unfinished) if line)
        if silence is Silence.TIME_OUT:
            return TimedOut(timeout, written, pipes.log)
        return self._crashed(written, before)

    def _crashed(self, written: str, before: bool) -> Crashed:
        """The outcome if the process ended."""
        self.end()
        code = self._pipes.exit_code
        if code is not None and code < 0:
            try:
                name = signal.Signals(-code).name
            except ValueError:
                name = f"signal {-code}"
            return Crashed(None, name, self._pipes.log, written, before)
        return Crashed(code, None, self._pipes.log, written, before)
