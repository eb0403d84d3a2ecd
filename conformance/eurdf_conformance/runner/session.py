"""A conversation with a parser, which may take several processes."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType

from eurdf_conformance.protocol.message import (
    PROTOCOL,
    Accepted,
    AnyRequest,
    Evaluate,
    Load,
    Quantity,
    Start,
    Started,
    Stop,
)
from eurdf_conformance.runner.command import command_of, why_not
from eurdf_conformance.runner.outcome import Answered, CannotStart, Outcome
from eurdf_conformance.runner.pipes import LINE_LIMIT
from eurdf_conformance.runner.process import ParserProcess
from eurdf_conformance.visible import cut


class NotStarted(Exception):  # noqa: N818 - it says what the parser is
    """The parser did not answer `start` with `started`.

    Attributes:
        outcome: What came of it instead.
    """

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome
        super().__init__(cut(_why(outcome)))


class Session:
    """A parser to ask; as a context manager it starts the parser, and ends it whatever happens.

    After an outcome that breaks the process, another one is started when the parser is next asked: one a request at
    most, so that there are never more starts than requests. A parser that does not start the first time, or fails to
    start several times in a row later on, is given up: whatever it is asked, the outcome is `CannotStart`.

    Restarts as such have no other bound. What becomes of a request would depend on it: on how many others had broken
    the process before, and so on how they are spread over sessions.

    Attributes:
        seconds_in_parser: Time spent waiting for the parser, its starts included, s.
        restarts: How often it was started again.
        left: Names of the processes that it left behind outside the group of its own, and that were ended.
        ended: What came of `stop`, once the session is over; None where there was no process to stop.
    """

    def __init__(
        self,
        parser: str,
        *,
        timeout: float = 10.0,
        start_timeout: float = 30.0,
        stop_timeout: float = 5.0,
        failed_starts: int = 3,
        line_limit: int = LINE_LIMIT,
    ) -> None:
        """Prepare a session; nothing is started yet.

        Args:
            parser: ``package.module:object`` or ``cmd:`` and a command line, see `command_of`.
            timeout: Time allowed for an answer, s.
            start_timeout: Time allowed for starting the process and the answer to `start`, s.
            stop_timeout: Time allowed from `stop` to the end of the process, s.
            failed_starts: So many restarts that fail, one after the other, are enough to give the parser up.
            line_limit: Bytes that a line may have.
        """
        self.parser = parser
        self.seconds_in_parser = 0.0
        self.restarts = 0
        self.left: list[str] = []
        self.ended: Outcome | None = None
        self._timeout, self._start_timeout, self._stop_timeout = timeout, start_timeout, stop_timeout
        self._most_failed_starts, self._line_limit = failed_starts, line_limit
        self._process: ParserProcess | None = None
        self._accounted: ParserProcess | None = None  # the last one of which `left` is known
        self._asked = 0
        self._first: Outcome | None = None  # what came of the first start
        self._failed_starts = 0  # in a row
        self._last = ""  # what came of the last of them
        self._accepted: Load | None = None  # the robot that `evaluate` is of

    def __enter__(self) -> Session:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        if error is None:
            self.stop()
        elif self._process is not None:
            self._process.end()
            self._account()

    @property
    def started(self) -> Started:
        """The parser's answer to `start`: its name and its claims.

        Raises:
            NotStarted: It did not say.
        """
        outcome = self.start()
        if isinstance(outcome, Answered) and isinstance(outcome.answer, Started):
            return outcome.answer
        raise NotStarted(outcome)

    def start(self) -> Outcome:
        """Start the parser, if it is not started; the outcome of the first start."""
        if self._first is None:
            self._first = self._begin()
        return self._first

    def load(self, description: Path, urdf: Path, *, timeout: float | None = None) -> Outcome:
        """Ask the parser to read a robot.

        Args:
            description: The YAML file.
            urdf: The URDF that it names.
            timeout: Time allowed, s, in place of that of the session.
        """
        request = Load(id=0, description=str(description.absolute()), urdf=str(urdf.absolute()))
        return self.ask(request, timeout=timeout)

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
        *,
        timeout: float | None = None,
    ) -> Outcome:
        """Ask the parser to evaluate the robot of the last `load`, which was accepted.

        Args:
            configurations: For each, by joint its coordinates as files have them.
            frames: Names of the frames of which poses are asked for.
            quantities: What to say.
            timeout: Time allowed, s, in place of that of the session.
        """
        given = [{joint: list(map(float, values)) for joint, values in each.items()} for each in configurations]
        request = Evaluate(id=0, quantities=list(quantities), frames=list(frames), configurations=given)
        return self.ask(request, timeout=timeout)

    def ask(self, request: AnyRequest, *, timeout: float | None = None) -> Outcome:
        """Send any request except `start` and `stop`.

        EU-PRO-006: only an answer that says so is a rejection; each other outcome is one of its own.

        Where a process broke after it had accepted a robot, the next one is given that robot before it is asked to
        evaluate.

        Args:
            request: Its id is replaced by one that was not used in this session.
            timeout: Time allowed, s, in place of that of the session.
        """
        cannot = self._ready(request)
        if cannot is not None:
            return cannot
        if isinstance(request, Load):
            self._accepted = None
        outcome = self._put(request, self._timeout if timeout is None else timeout)
        if isinstance(request, Load) and isinstance(outcome, Answered) and isinstance(outcome.answer, Accepted):
            self._accepted = request
        return outcome

    def stop(self) -> Outcome | None:
        """End the conversation; its outcome, or None if no process was running."""
        process = self._process
        if process is not None and process.alive:
            self.ended = process.stop(Stop(id=self._next_id()), self._stop_timeout)
        self._account()
        return self.ended

    def _account(self) -> None:
        """Keep what a process that has ended left behind, once."""
        if self._process is not None and not self._process.alive and self._process is not self._accounted:
            self._accounted = self._process
            self.left += self._process.left

    def _ready(self, request: AnyRequest) -> CannotStart | None:
        """Make sure that a process is running; the reason if there is none."""
        first = self.start()
        if not _is_started(first):
            return CannotStart(_why(first))
        if self._process is not None and self._process.alive:
            return None
        if self._failed_starts >= self._most_failed_starts:
            return CannotStart(f"given up because it did not start {self._failed_starts} times in a row: {self._last}")
        self.restarts += 1
        again = self._begin()
        if not _is_started(again):
            self._failed_starts, self._last = self._failed_starts + 1, _why(again)
            return CannotStart(f"it did not restart: {_why(again)}")
        self._failed_starts = 0
        if isinstance(request, Evaluate) and self._accepted is not None:
            loaded = self._put(self._accepted, self._timeout)
            if not (isinstance(loaded, Answered) and isinstance(loaded.answer, Accepted)):
                return CannotStart(f"after a restart it does not accept the robot that it accepted before: {loaded}")
        return None

    def _begin(self) -> Outcome:
        """Start a process and send `start`."""
        try:
            command = command_of(self.parser)
        except ValueError as why:
            return CannotStart(str(why))
        self._account()
        try:
            self._process = ParserProcess(command, self._line_limit)
        except (OSError, ValueError) as why:
            return CannotStart(why_not(command[0], why))
        outcome = self._put(Start(id=0, protocol=PROTOCOL), self._start_timeout)
        if not _is_started(outcome):
            self._process.end()
        return outcome

    def _put(self, request: AnyRequest, timeout: float) -> Outcome:
        """Send a request to the running process."""
        assert self._process is not None
        begin = time.perf_counter()
        outcome = self._process.ask(request.model_copy(update={"id": self._next_id()}), timeout)
        # What was answered says itself how long the parser took; the rest is ours.
        self.seconds_in_parser += outcome.seconds if isinstance(outcome, Answered) else time.perf_counter() - begin
        return outcome

    def _next_id(self) -> int:
        self._asked += 1
        return self._asked


def _why(outcome: Outcome) -> str:
    """What became of a start, for those who know that it failed."""
    return outcome.why if isinstance(outcome, CannotStart) else str(outcome)


def _is_started(outcome: Outcome) -> bool:
    return isinstance(outcome, Answered) and isinstance(outcome.answer, Started)
