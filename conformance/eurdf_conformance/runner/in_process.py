"""Runs a Python parser in this process: for tests of a parser, or of the suite, that start no process."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from eurdf_conformance.protocol.message import AnyAnswer, Errored, Evaluated, Quantity, Unsupported
from eurdf_conformance.protocol.serve import Evaluator, PythonParser
from eurdf_conformance.runner.outcome import Answered, Outcome


class InProcess:
    """A parser with the interface of a `Session`; if it crashes, this process crashes."""

    def __init__(self, parser: PythonParser) -> None:
        self._parser = parser

    def load(self, description: Path, urdf: Path) -> Outcome:
        """Ask it to read a robot."""
        begin = time.perf_counter()
        try:
            answer: AnyAnswer = self._parser.load(description.absolute(), urdf.absolute())
        except Exception as error:
            answer = _errored(error)
        return Answered(answer, time.perf_counter() - begin)

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> Outcome:
        """Ask it to evaluate the robot of the last `load`, which was accepted."""
        begin = time.perf_counter()
        answer: AnyAnswer
        if isinstance(self._parser, Evaluator):
            try:
                found = self._parser.evaluate(configurations, frames, quantities)
                answer = Evaluated(id=0, values=found) if isinstance(found, list) else found
            except Exception as error:
                answer = _errored(error)
        else:
            answer = Unsupported(id=0, feature="evaluate")
        return Answered(answer, time.perf_counter() - begin)


def _errored(error: Exception) -> Errored:
    return Errored(id=0, message=f"{type(error).__name__}: {error}")
