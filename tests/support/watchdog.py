"""A watchdog for what must end: it measures nothing, and only ends what would go on for minutes."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

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
