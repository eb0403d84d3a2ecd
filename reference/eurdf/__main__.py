"""The command ``eurdf``, also as ``python -m eurdf``; an interrupt (Ctrl-C, SIGINT) ends it quietly at any time.

This module imports nothing slow, so it can handle an interrupt before the command is imported. A process that was
started with interrupts ignored, such as a background job of a script, keeps ignoring them.
"""

from __future__ import annotations

import gc
import signal
import sys
from types import FrameType

from eurdf.commands import INTERRUPTED


def start() -> int:
    """Run the command line of this process.

    Returns:
        The exit code of `eurdf.commands.main.main`.
    """
    # Nearly all that a command imports and reads stays until it ends: there is little garbage to look for.
    gc.set_threshold(100_000, 50, 50)
    try:
        handled = signal.getsignal(signal.SIGINT) is signal.default_int_handler
        if handled:
            signal.signal(signal.SIGINT, _interrupt)
        from eurdf.commands.main import main

        code = main()
        if handled:
            signal.signal(signal.SIGINT, signal.SIG_DFL)  # nothing to clean up
        gc.freeze()  # or else the interpreter would look at all objects for garbage, twice, when it ends
    except KeyboardInterrupt:
        return INTERRUPTED
    return code


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, once: the next interrupt ends the process at once."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    raise KeyboardInterrupt


if __name__ == "__main__":
    sys.exit(start())
