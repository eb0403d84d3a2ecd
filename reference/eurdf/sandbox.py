"""Programs that read files of others in a process of their own, bounded in time and memory.

A damaged or hostile file can make a library crash, or take minutes and gigabytes: here this ends a process, not that
of a caller. Such a program imports this module, so it imports nothing else of this package.
"""

from __future__ import annotations

import contextlib
import faulthandler
import json
import os
import signal
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO, Literal, NamedTuple

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

_ADDRESS_SPACE = "/proc/self/statm"

#: Whether `bound_memory` has an effect. macOS has such a bound, and does not enforce it.
BOUNDS_MEMORY = resource is not None and os.path.exists(_ADDRESS_SPACE)

# The exit code and the message of `faulthandler`.
_OVERDUE, _TIMEOUT = 1, b"Timeout ("

# A module in the working directory is not one that the program means. This package may be in a folder that only the
# process of the caller has added to those that it searches.
_RUN = """\
import sys
package = sys.argv.pop()
sys.path = [folder for folder in sys.path if folder]
if package not in sys.path:
    sys.path.insert(0, package)
import runpy
runpy.run_path(sys.argv[1], run_name="__main__")
"""


class Done(NamedTuple):
    """A program that has ended.

    Attributes:
        code: Its exit code, as `subprocess` has it.
        output: What it answered.
        stderr: What it wrote to the standard error.
    """

    code: int
    output: bytes
    stderr: bytes

    @property
    def exceeded(self) -> Literal["time", "processor time"] | None:
        """The bound of time that ended it; None if none did."""
        if self.code == _OVERDUE and _TIMEOUT in self.stderr:
            return "time"
        return "processor time" if self.code == -getattr(signal, "SIGXCPU", sys.maxsize) else None


def run(
    program: Path,
    request: object,
    *,
    seconds: float | None = None,
    folder: str | None = None,
    environment: Mapping[str, str] | None = None,
) -> Done:
    """Run a file of Python, which can import this package, and begins with `request_and_answers`.

    The request is JSON. By default, it has the working folder and the environment of this process, and no bound of
    time; for programs in C++, `bound_time` says more.
    """
    import subprocess  # only now: few robots need it

    try:
        done = subprocess.run(
            [sys.executable, "-c", _RUN, str(program), str(Path(__file__).parents[1])],
            input=json.dumps(request).encode(),
            capture_output=True,
            timeout=seconds,
            check=False,
            cwd=folder,
            env=environment,
        )
    except subprocess.TimeoutExpired:
        return Done(_OVERDUE, b"", _TIMEOUT)
    return Done(done.returncode, done.stdout, done.stderr)


def request_and_answers() -> tuple[Any, BinaryIO]:
    """In the program: the request, and where to write the answer. What libraries print is no part of it."""
    request = json.load(sys.stdin.buffer)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    if resource is not None:  # an image of its memory is for nobody
        _limit(resource.RLIMIT_CORE, 0)
    return request, answers


def bound_memory(more: int) -> None:
    """Let this process take so many more bytes of memory; no effect unless `BOUNDS_MEMORY`."""
    if BOUNDS_MEMORY:
        with open(_ADDRESS_SPACE, encoding="ascii") as stream:
            pages = int(stream.read().split()[0])
        _limit(resource.RLIMIT_AS, pages * resource.getpagesize() + more)


def bound_time(seconds: float, processor: float | None = None) -> None:
    """End this process after a time, also one that is in C++; the bounds of an earlier call no longer count.

    Both times are from now on; that of the processor has no effect on Windows.
    """
    faulthandler.dump_traceback_later(seconds, exit=True)
    if processor is not None and resource is not None:
        used = resource.getrusage(resource.RUSAGE_SELF)
        _limit(resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime + processor) + 1)


def _limit(what: int, soft: int) -> None:
    with contextlib.suppress(OSError, ValueError):  # there is a lower one already
        resource.setrlimit(what, (soft, resource.getrlimit(what)[1]))
