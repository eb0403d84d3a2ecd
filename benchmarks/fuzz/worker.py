"""A process that tries cases: ``python -m benchmarks.fuzz.worker`` reads JSON lines and answers each with one.

A request is ``{"seed": …, "number": …, "of": …}``, where ``of`` is a kind of case or null, or ``{"folder": …}``, a case
that was written there. The answer is
``{"outcome": …, "trouble": …}``; trouble is empty if no promise was broken. A case that takes more than `CPU_SECONDS`
of processor time ends the process by SIGPROF, also where it is in C++. The process may have `MEMORY` bytes.
"""

from __future__ import annotations

import faulthandler
import json
import os
import resource
import signal
import sys
import tempfile
import traceback
from pathlib import Path
from typing import IO, Any

from benchmarks.fuzz.calls import try_call
from benchmarks.fuzz.case import Case, case_of, read_case
from benchmarks.fuzz.imports import try_import
from benchmarks.fuzz.parsers import try_parsers
from benchmarks.fuzz.robots import try_robot

#: Processor time after which a step of a case is taken not to end, s.
CPU_SECONDS = 20.0

#: Bytes of address space that a worker may have.
MEMORY = 6 * 2**30


def restart_clock(seconds: float = CPU_SECONDS) -> None:
    """Let SIGPROF end the process after so much more processor time; 0 for never."""
    signal.setitimer(signal.ITIMER_PROF, seconds)


def try_case(case: Case, folder: Path, number: int = 0) -> str:
    """Try a case.

    Args:
        case: The case.
        folder: Empty.
        number: Every fourth robot is analysed too.

    Returns:
        What it came to.

    Raises:
        Exception: A promise is broken.
    """
    restart_clock()
    if case.call is not None:
        return try_call(case.call)
    for name, content in case.files.items():
        (folder / name).write_bytes(content)
    if case.kind.startswith("import-"):
        return try_import(folder / case.path, case.kind.removeprefix("import-"), clock=restart_clock)
    if case.kind == "parsers":
        return try_parsers(folder / case.path, folder / "robot.urdf", clock=restart_clock)
    return try_robot(folder / case.path, analyse=number % 4 == 0, clock=restart_clock)


def serve(requests: IO[str], answers: IO[str], noise: int) -> None:
    """Answer requests until there are no more.

    Args:
        requests: Lines.
        answers: Lines.
        noise: Descriptor of the file that standard output and error go to: nothing should be written there.
    """
    size = os.fstat(noise).st_size
    for line in requests:
        request = json.loads(line)
        number = request.get("number", 0)
        if "folder" in request:
            case = read_case(Path(request["folder"]))
        else:
            case = case_of(request["seed"], number, request["of"])
        with tempfile.TemporaryDirectory() as folder:
            try:
                outcome, trouble = try_case(case, Path(folder), number), ""
            except MemoryError:
                outcome, trouble = "memory", f"more than {MEMORY:,} bytes"
            except Exception as error:  # any exception is a finding
                outcome, trouble = "raised", _where(error)
            restart_clock(0)
        sys.stdout.flush()
        sys.stderr.flush()
        if (now := os.fstat(noise).st_size) > size:
            outcome, trouble = "noise", os.pread(noise, 500, size).decode(errors="replace")
            size = now
        answer = {"outcome": outcome, "trouble": trouble, "kind": case.kind, "title": case.title}
        answers.write(json.dumps(answer) + "\n")
        answers.flush()


def _where(error: BaseException) -> str:
    frames = traceback.extract_tb(error.__traceback__)[-4:]
    trail = " < ".join(f"{Path(frame.filename).name}:{frame.name}" for frame in reversed(frames))
    return f"{type(error).__name__} at {trail}: {str(error)[:300]}"


def main() -> None:
    """Serve standard input."""
    answers: Any = os.fdopen(os.dup(1), "w", encoding="utf-8")
    log = os.fdopen(os.dup(2), "w", encoding="utf-8")
    faulthandler.enable(file=log)
    faulthandler.register(signal.SIGPROF, file=log, chain=True)
    with tempfile.TemporaryFile() as noise:
        for descriptor in (1, 2):
            os.dup2(noise.fileno(), descriptor)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        serve(sys.stdin, answers, noise.fileno())


if __name__ == "__main__":
    main()
