"""Damaged robots, drawn from sound ones, and what becomes of them.

``python tests/support/mutation.py SEED FIRST COUNT [FOLDER…]`` checks and loads the cases FIRST to FIRST + COUNT - 1
of a seed in this one process, and writes two JSON lines a case: one when it begins, one with what came of it. A call
that takes more than `CPU_SECONDS` ends the process by SIGPROF, so that an endless loop in C++ is found as well. The
folders hold more robots to damage, each as robot.urdf and robot.yaml; with them, those of the project are left alone.
``--show`` writes the files of the cases instead of checking them.
"""

from __future__ import annotations

import faulthandler
import json
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from benchmarks.fuzz.robots import Case, case_of, seeds, try_robot, write_case

#: Processor time after which one call is taken not to end: to check, to load, or to analyse.
CPU_SECONDS = 30.0


def restart_clock(seconds: float = CPU_SECONDS) -> None:
    """Let SIGPROF end the process, be it in C++ or not, after so much more processor time; 0 for never."""
    signal.setitimer(signal.ITIMER_PROF, seconds)


Attempt = Callable[..., str]


def work(seed: int, first: int, count: int, folders: Sequence[Path] = (), attempt: Attempt | None = None) -> None:
    """Run cases one after the other in this process, whose own output is reported as noise from here on."""
    attempt = attempt or partial(try_robot, clock=restart_clock)
    lines = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    log = os.fdopen(os.dup(2), "w", encoding="utf-8")
    faulthandler.enable(file=log)
    faulthandler.register(signal.SIGPROF, file=log, chain=True)

    def tell(line: dict[str, Any]) -> None:
        lines.write(json.dumps(line) + "\n")

    robots = seeds(folders)
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as noise:
        for descriptor in (1, 2):
            os.dup2(noise.fileno(), descriptor)
        sound = robots[0]
        attempt(write_case(Case("sound", sound.urdf, sound.description), Path(folder)), analyse=True)  # imports all
        quiet = os.fstat(noise.fileno()).st_size
        for index in range(first, first + count):
            tell({"begin": index})
            case = case_of(seed, index, robots)
            path = write_case(case, Path(folder))
            begin = time.process_time()
            try:
                outcome, trouble = attempt(path, analyse=index % 4 == 0), ""
            except Exception as error:  # any exception is reported
                outcome, trouble = "raised", _where(error)
            restart_clock(0)
            sys.stdout.flush()
            sys.stderr.flush()
            size = os.fstat(noise.fileno()).st_size
            if size > quiet:
                outcome, trouble = "noise", os.pread(noise.fileno(), 500, quiet).decode(errors="replace")
                quiet = size
            seconds = time.process_time() - begin
            tell({"case": index, "title": case.title, "outcome": outcome, "trouble": trouble, "seconds": seconds})


def _where(error: BaseException) -> str:
    import traceback

    frames = traceback.extract_tb(error.__traceback__)[-4:]
    trail = " < ".join(f"{Path(frame.filename).name}:{frame.lineno}" for frame in reversed(frames))
    return f"{type(error).__name__}: {str(error)[:300]} at {trail}"


def main(arguments: Sequence[str]) -> None:
    """The command described at the top."""
    show = "--show" in arguments
    seed, first, count, *folders = [argument for argument in arguments if argument != "--show"]
    if show:
        robots = seeds([Path(folder) for folder in folders])
        for index in range(int(first), int(first) + int(count)):
            case = case_of(int(seed), index, robots)
            sys.stdout.buffer.write(f"=== {case.title}\n".encode() + (case.description or b"") + b"\n===\n" + case.urdf)
        return
    work(int(seed), int(first), int(count), [Path(folder) for folder in folders])


if __name__ == "__main__":
    main(sys.argv[1:])
