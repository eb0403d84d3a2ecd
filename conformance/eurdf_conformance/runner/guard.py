"""What this process has started ends with it, also where it is killed and can no longer see to it itself.

A second process, the guard, holds the other end of a pipe. It learns of each group of processes that begins or ends.
When this process is gone, however it went, the pipe closes; then the guard kills the groups that are left, and ends.
This file is also the guard's program, so it imports nothing of the package. It works wherever there are pipes and
groups of processes, as on Linux and macOS; what leaves its group is out of reach.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterable
from functools import cache


def begins(group: int) -> None:
    """Register a group of processes that must end with this process."""
    _tell(f"+{group}")


def ends(group: int) -> None:
    """Unregister a group that has ended, before its id can be reused."""
    _tell(f"-{group}")


def _tell(text: str) -> None:
    pipe = _guard().stdin
    assert pipe is not None
    # Somebody has killed the guard, or this process is about to end: it sees to the rest itself.
    with contextlib.suppress(BrokenPipeError, ValueError):
        pipe.write(f"{text}\n".encode())


@cache
def _guard() -> subprocess.Popen[bytes]:
    """The guard of this process. In a session of its own, it lives on when Ctrl-C ends this one's group."""
    guard = subprocess.Popen(
        [sys.executable, "-I", "-S", __file__],
        bufsize=0,
        cwd="/",
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    atexit.register(guard.communicate)
    return guard


def _watch(lines: Iterable[bytes]) -> None:
    """The guard: read registrations until the pipe closes, then kill the groups that are left."""
    groups: set[int] = set()
    for line in lines:
        change = groups.add if line.startswith(b"+") else groups.discard
        change(int(line[1:]))
    for group in groups:
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(group, signal.SIGKILL)


if __name__ == "__main__":
    _watch(sys.stdin.buffer)
