"""Programs that tests run: on a terminal, with a watchdog, or with packages of npm."""

from __future__ import annotations

import os
import pty
import select
import shutil
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from support.places import ROOT


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


#: Processor time in s after which something is taken not to end: at least thirty times what it takes on a slow machine.
SECONDS = 60.0


@contextmanager
def watchdog(seconds: float = SECONDS) -> Iterator[None]:
    """Fail the test if its block takes more processor time than that, on any machine and under any load."""

    def late(signum: int, frame: FrameType | None) -> None:
        raise AssertionError(f"it has not ended after {seconds:g} s of processor time")

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


#: The package in JavaScript, and where ``npm install --prefix js`` installs what it and the tests import.
JAVASCRIPT = ROOT / "js"
MODULES = JAVASCRIPT / "node_modules"


def why_not_installed(*packages: str) -> str:
    """Why a program for Node.js that imports some packages cannot be run; empty if it can."""
    if shutil.which("node") is None:
        return "Node.js is not on the PATH: install it, then npm install --prefix js"
    missing = [package for package in packages if not (MODULES / package).is_dir()]
    if missing:
        return f"{', '.join(missing)} is not installed: npm install --prefix js"
    return ""
