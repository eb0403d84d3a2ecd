"""What not every operating system has: bounds on a process, and opening a file without waiting.

The processes that read files of others import this, so it imports nothing else.
"""

from __future__ import annotations

import contextlib
import faulthandler
import os
import signal
import sys
from typing import Literal

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

#: Flags with which `os.open` opens a file to read its bytes: it waits for nobody who writes to a pipe.
READ_NOW = os.O_RDONLY | sum(getattr(os, name, 0) for name in ("O_NONBLOCK", "O_NOCTTY", "O_BINARY"))

_ADDRESS_SPACE = "/proc/self/statm"

#: Whether `bound_memory` has an effect. macOS has such a bound, and does not enforce it.
BOUNDS_MEMORY = resource is not None and os.path.exists(_ADDRESS_SPACE)

# The exit code and the message of `faulthandler`.
_OVERDUE, _TIMEOUT = 1, b"Timeout ("


def bound_memory(more: int) -> None:
    """Let this process take so many more bytes of memory; no effect unless `BOUNDS_MEMORY`."""
    if BOUNDS_MEMORY:
        with open(_ADDRESS_SPACE, encoding="ascii") as stream:
            pages = int(stream.read().split()[0])
        _limit(resource.RLIMIT_AS, pages * resource.getpagesize() + more)


def bound_time(seconds: float, processor: float | None = None) -> None:
    """End this process after a time, also one that is in C++; the bounds of an earlier call no longer count.

    Args:
        seconds: Time from now on.
        processor: Processor time from now on; no effect on Windows.
    """
    faulthandler.dump_traceback_later(seconds, exit=True)
    if processor is not None and resource is not None:
        used = resource.getrusage(resource.RUSAGE_SELF)
        _limit(resource.RLIMIT_CPU, int(used.ru_utime + used.ru_stime + processor) + 1)


def leave_no_core() -> None:
    """Let this process write no image of its memory if it crashes."""
    if resource is not None:
        _limit(resource.RLIMIT_CORE, 0)


def exceeded(code: int, stderr: bytes) -> Literal["time", "processor time"] | None:
    """The bound of `bound_time` that ended a process; None if none did.

    Args:
        code: Its exit code, as `subprocess` has it.
        stderr: What it wrote to the standard error.
    """
    if code == _OVERDUE and _TIMEOUT in stderr:
        return "time"
    return "processor time" if code == -getattr(signal, "SIGXCPU", sys.maxsize) else None


def _limit(what: int, soft: int) -> None:
    with contextlib.suppress(OSError, ValueError):  # there is a lower one already
        resource.setrlimit(what, (soft, resource.getrlimit(what)[1]))
