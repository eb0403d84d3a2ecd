"""What a person sees who runs a program in a terminal."""

from __future__ import annotations

import os
import pty
import select
import sys
import time


def on_a_terminal(argv: list[str], columns: int = 80) -> tuple[int, str]:
    """Run Python with these arguments: its exit code, and what a person sees."""
    child, terminal = pty.fork()
    if child == 0:
        os.environ.update(TERM="xterm-256color", COLUMNS=str(columns), LINES="40", PYTHONIOENCODING="utf-8")
        for name in ("NO_COLOR", "FORCE_COLOR"):
            os.environ.pop(name, None)
        os.execv(sys.executable, [sys.executable, *argv])
    seen, end = b"", time.monotonic() + 60
    while time.monotonic() < end and select.select([terminal], [], [], 30)[0]:
        try:
            some = os.read(terminal, 65536)
        except OSError:  # the other end is closed
            break
        if not some:
            break
        seen += some
    _, status = os.waitpid(child, 0)
    os.close(terminal)
    return os.waitstatus_to_exitcode(status), seen.decode("utf-8")
