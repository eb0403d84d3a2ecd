"""A worker that is watched: whatever it does, there is an outcome, and the next case finds a worker."""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

#: Time after which a case is taken to hang, s: it may wait without using the processor.
WALL_SECONDS = 120.0

_ROOT = Path(__file__).parents[2]


@dataclass(frozen=True)
class Outcome:
    """What became of a case.

    Attributes:
        word: ``refused``, ``robot``, ``answered``, ``imported`` or ``with errors``; else ``raised``, ``noise``,
            ``memory``, ``crashed`` or ``hangs``.
        trouble: What went wrong; empty if nothing did.
        kind: Of the case, where it is known.
    """

    word: str
    trouble: str = ""
    kind: str = ""


class Watched:
    """A worker, started when it is needed."""

    def __init__(self, wall: float = WALL_SECONDS, program: Sequence[str] = ("-m", "benchmarks.fuzz.worker")) -> None:
        """Nothing is started yet.

        Args:
            wall: Time after which a case is taken to hang, s.
            program: Arguments of Python that start a worker.
        """
        self._program = program
        self._process: subprocess.Popen[bytes] | None = None
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - closed with this
        self._wall = wall

    def __enter__(self) -> Watched:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._end()
        self._log.close()

    def try_number(self, seed: int, number: int, kind: str | None = None) -> Outcome:
        """What becomes of a case of a seed, of a kind."""
        return self._ask({"seed": seed, "number": number, "of": kind})

    def try_folder(self, folder: Path) -> Outcome:
        """What becomes of a case that was written into a folder."""
        return self._ask({"folder": str(folder.absolute())})

    def _ask(self, request: dict[str, Any]) -> Outcome:
        process = self._process or self._start()
        assert process.stdin is not None
        process.stdin.write(json.dumps(request).encode() + b"\n")
        process.stdin.flush()
        line = self._line(process, time.monotonic() + self._wall)
        if line is None:
            self._end()
            return Outcome("hangs", f"no answer in {self._wall:g} s")
        if line.endswith(b"\n"):
            answer = json.loads(line)
            return Outcome(answer["outcome"], answer["trouble"], answer["kind"])
        code = process.wait()
        log = self._tail()
        self._end()
        if code == -signal.SIGPROF:
            return Outcome("hangs", f"too much processor time: {log}")
        return Outcome("crashed", f"ended with {code}: {log}")

    def _line(self, process: subprocess.Popen[bytes], until: float) -> bytes | None:
        """The next line; without a line end, if the process ends; None if the time is over."""
        assert process.stdout is not None
        found = b""
        with selectors.DefaultSelector() as selector:
            selector.register(process.stdout, selectors.EVENT_READ)
            while not found.endswith(b"\n"):
                if not selector.select(max(0.0, until - time.monotonic())):
                    return None
                if not (chunk := os.read(process.stdout.fileno(), 2**16)):
                    break
                found += chunk
        return found

    def _start(self) -> subprocess.Popen[bytes]:
        # One thread, so that processor time is time, also beside other programs.
        threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
        self._process = subprocess.Popen(
            [sys.executable, *self._program],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            cwd=_ROOT,
            env={**os.environ, **threads},
            start_new_session=True,
        )
        return self._process

    def _tail(self) -> str:
        """The end of what the worker wrote to its log: where it was."""
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").splitlines()
        frames = [line.strip() for line in lines if line.startswith("  File")]
        return " < ".join(_place(frame) for frame in frames[:4]) or " ".join(lines[-3:])[:300]

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is None:
            return
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        for stream in (process.stdin, process.stdout):
            assert stream is not None
            stream.close()
        self._log.seek(0)
        self._log.truncate()


def _place(frame: str) -> str:
    """File and function of a line of a traceback of `faulthandler`."""
    path, _, function = frame.removeprefix('File "').partition('", line ')
    return f"{Path(path).name}:{function.partition(' in ')[2]}"
