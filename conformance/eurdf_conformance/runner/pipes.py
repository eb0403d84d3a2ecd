"""A process and its three pipes: reads whole lines of its standard output, with a deadline and a bound on memory.

One selector waits for all of them, and for the end of the process, so that a parser that fills one pipe while another
is waited for can neither hang nor hang up. A `keeper` starts the process. What the process has started ends with it,
and with this process.
"""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from enum import Enum, auto
from pathlib import Path

_KEEPER = Path(__file__).with_name("keeper.py")

#: Largest length of a line, bytes. The mass matrix of a robot with 1000 velocities takes 20 MB.
LINE_LIMIT = 64 * 2**20

#: Bytes that are kept of standard error, the last ones.
LOG_LIMIT = 2**14

_CHUNK = 2**16

# How long a process that has closed its standard output may take to end, s; the keeper to start; and all that was
# killed to end.
_LAST_BREATH = 1.0
_BIRTH = 60.0
_DEATH = 10.0


class Silence(Enum):
    """Why there is no line."""

    TIME_OUT = auto()
    ENDED = auto()
    TOO_LONG = auto()


class Pipes:
    """A running process. It is not thread-safe.

    Attributes:
        exit_code: Of the process as `subprocess` has it, negative for a signal; None while it runs, and where it was
            ended from here.
        left: Once it is closed, the names of the processes that had left its group, and were ended with it.
    """

    def __init__(self, command: Sequence[str], line_limit: int = LINE_LIMIT) -> None:
        """Start the process.

        Args:
            command: Program and arguments.
            line_limit: Bytes that a line may have.

        Raises:
            OSError: It cannot be started.
        """
        self.exit_code: int | None = None
        self.left: tuple[str, ...] = ()
        self._line_limit = line_limit
        self._received = bytearray()
        self._searched = 0  # so many of the bytes received hold no line feed
        self._log = bytearray()
        self._begun = False  # whether anything was sent
        self._unsent = bytearray()
        self._output_closed: float | None = None  # when
        self._log_open, self._ended, self._closed = True, False, False
        self._control, control = socket.socketpair()
        self._told = b""
        with control:
            self._process = subprocess.Popen(
                [sys.executable, "-I", "-S", str(_KEEPER), str(control.fileno()), *command],
                bufsize=0,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                pass_fds=[control.fileno()],
                start_new_session=True,
                # PYTEST_CURRENT_TEST says which case is next.
                env={name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")},
            )
        self._await_start(command[0])
        streams = self._process.stdin, self._process.stdout, self._process.stderr
        self._stdin, self._stdout, self._stderr = (stream.fileno() for stream in streams if stream is not None)
        self._selector = selectors.DefaultSelector()
        for fd, handle in (
            (self._stdout, self._receive),
            (self._stderr, self._take_log),
            (self._control.fileno(), self._hear),
        ):
            os.set_blocking(fd, False)
            self._selector.register(fd, selectors.EVENT_READ, handle)
        os.set_blocking(self._stdin, False)
        self._listen()  # it may have ended already

    @property
    def log(self) -> str:
        """The end of its standard error since the last `send`, or since it started."""
        return self._log.decode("utf-8", "replace")

    @property
    def unfinished(self) -> bytes:
        """The beginning of a line that has not ended."""
        return bytes(self._received)

    def send(self, line: bytes) -> None:
        """Write a line to its standard input; `line` sends the rest if the pipe is full."""
        if self._begun:
            self._log.clear()
        self._begun = True
        self._unsent += line + b"\n"
        self._write()
        if self._unsent and self._stdin not in self._selector.get_map():
            self._selector.register(self._stdin, selectors.EVENT_WRITE, self._write)

    def close_input(self) -> None:
        """Close its standard input."""
        assert self._process.stdin is not None
        if self._stdin in self._selector.get_map():
            self._selector.unregister(self._stdin)
        self._unsent.clear()
        self._process.stdin.close()

    def line(self, deadline: float) -> bytes | Silence:
        """The next line of its standard output, without its line feed.

        Args:
            deadline: Time of `time.monotonic`; one that has passed gives a line only if it is there.
        """
        looked = False
        while True:
            line = self._next_line()
            if line is not None:
                return line
            if self._ended:
                return Silence.ENDED
            # Nothing more can come of a closed output; but how the process ends is worth a moment.
            closed = self._output_closed
            until = deadline if closed is None else closed + _LAST_BREATH
            if looked and time.monotonic() >= until:
                return Silence.TIME_OUT if closed is None else Silence.ENDED
            self._handle(until)
            looked = True

    def await_exit(self, deadline: float) -> bool:
        """Whether the process ends by itself before the deadline, a time of `time.monotonic`."""
        while not self._ended and time.monotonic() < deadline:
            self._handle(deadline)
            self._received.clear()
            self._searched = 0
        return self._ended

    def close(self) -> None:
        """End the process and all that it started, and release its resources."""
        if self._closed:
            return
        self._closed = True
        self._selector.close()
        self._end_keeper()
        for stream in (self._process.stdin, self._process.stdout, self._process.stderr):
            assert stream is not None
            stream.close()

    def _await_start(self, program: str) -> None:
        """Wait for the word of the keeper.

        Raises:
            OSError: The program cannot be started.
        """
        self._control.settimeout(_BIRTH)
        with contextlib.suppress(TimeoutError):
            while not self._told.endswith(b"\n") and (chunk := self._control.recv(_CHUNK)):
                self._told += chunk
        first, self._told = self._told.partition(b"\n")[::2]
        if first == b"started":
            return
        self._closed = True
        self._end_keeper()
        for stream in (self._process.stdin, self._process.stdout, self._process.stderr):
            assert stream is not None
            stream.close()
        if first.startswith(b"failed "):
            errno = int(first.removeprefix(b"failed "))
            raise OSError(errno, os.strerror(errno), program)
        raise OSError(f"the process that starts '{program}' does not answer")

    def _end_keeper(self) -> None:
        """Let the keeper end the process and itself, and read its last words."""
        with contextlib.suppress(OSError):
            self._control.shutdown(socket.SHUT_WR)
            self._control.settimeout(_DEATH)
            while chunk := self._control.recv(_CHUNK):
                self._told += chunk
        self._control.close()
        self._listen()
        try:
            self._process.wait(_DEATH)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _hear(self) -> None:
        """Read what the keeper says. Without it nothing is known of the process any more."""
        chunk = _read(self._control.fileno())
        self._told += chunk or b""
        self._listen()
        if chunk == b"" and not self._ended:
            self._notice_exit()

    def _listen(self) -> None:
        *lines, self._told = self._told.split(b"\n")
        for line in lines:
            word, _, value = line.partition(b" ")
            if word == b"ended" and not self._closed:
                self.exit_code = int(value)
                self._notice_exit()
            elif word == b"left":
                self.left = tuple(json.loads(value))

    def _handle(self, deadline: float) -> None:
        """Wait for an event and handle it."""
        for key, _ in self._selector.select(max(deadline - time.monotonic(), 0.0)):
            key.data()

    def _next_feed(self) -> int:
        feed = self._received.find(b"\n", self._searched)
        if feed < 0:
            self._searched = len(self._received)
        return feed

    def _next_line(self) -> bytes | Silence | None:
        feed = self._next_feed()
        if feed > self._line_limit or (feed < 0 and len(self._received) > self._line_limit):
            return Silence.TOO_LONG
        if feed < 0:
            return None
        line = bytes(self._received[:feed])
        del self._received[: feed + 1]
        self._searched = 0
        return line

    def _receive(self) -> bool:
        """Read what is in standard output; return whether there was anything."""
        if self._output_closed is not None:
            return False
        chunk = _read(self._stdout)
        if chunk == b"":
            self._selector.unregister(self._stdout)
            self._output_closed = time.monotonic()
        self._received += chunk or b""
        return bool(chunk)

    def _take_log(self) -> bool:
        """Read what is in standard error; return whether there was anything."""
        if not self._log_open:
            return False
        chunk = _read(self._stderr)
        if chunk == b"":
            self._selector.unregister(self._stderr)
            self._log_open = False
        self._log += chunk or b""
        del self._log[:-LOG_LIMIT]
        return bool(chunk)

    def _notice_exit(self) -> None:
        """The process has ended: read what it wrote last; later output comes from other processes."""
        self._selector.unregister(self._control)
        _empty(self._receive, self._line_limit)
        _empty(self._take_log, self._line_limit)
        self._ended = True

    def _write(self) -> None:
        try:
            while self._unsent:
                del self._unsent[: os.write(self._stdin, self._unsent[:_CHUNK])]
        except BlockingIOError:
            return
        except BrokenPipeError:
            self._unsent.clear()  # it ends, or does not listen: what it does next tells
        if self._stdin in self._selector.get_map():
            self._selector.unregister(self._stdin)


def _read(fd: int) -> bytes | None:
    """What there is to read; nothing at the end, None where there is nothing now."""
    try:
        return os.read(fd, _CHUNK)
    except BlockingIOError:
        return None


def _empty(read: Callable[[], bool], limit: int) -> None:
    """Read until there is nothing now, but no more than about ``limit`` bytes: others may go on writing."""
    for _ in range(limit // _CHUNK + 1):
        if not read():
            return
