"""A finding: what broke a promise, and a smaller case that still does."""

from __future__ import annotations

import re
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from benchmarks.fuzz.case import Case
from benchmarks.fuzz.watched import Outcome, Watched


@dataclass(frozen=True)
class Finding:
    """A case that broke a promise.

    Attributes:
        case: The case.
        outcome: What became of it.
    """

    case: Case
    outcome: Outcome

    @property
    def signature(self) -> str:
        """What findings of one cause have in common: the outcome without numbers and names of the case."""
        words = re.sub(r"'[^']*'|\d+", "#", self.outcome.trouble.partition(": ")[0])
        of = self.case.kind if self.case.call is None else f"{self.case.kind} of {self.case.call['function']}"
        return f"{of}: {self.outcome.word}: {words}"[:200]


def minimized(finding: Finding, worker: Watched, seconds: float) -> Finding:
    """The smallest case found in some time that breaks the promise in the same way."""
    until = time.monotonic() + seconds
    candidates = _smaller(finding.case)
    while (case := next(candidates, None)) is not None and time.monotonic() < until:
        with tempfile.TemporaryDirectory() as folder:
            case.write(Path(folder))
            tried = Finding(case, worker.try_folder(Path(folder)))
        if tried.signature == finding.signature:
            finding, candidates = tried, _smaller(case)
    return finding


def _smaller(case: Case) -> Iterator[Case]:
    """Cases with less: fewer lines or bytes of a file, fewer arguments of a call, rounder numbers."""
    for name, content in case.files.items():
        lines = content.splitlines(keepends=True)
        parts = lines if len(lines) > 1 else [content[i : i + 1] for i in range(len(content))]
        size = len(parts) // 2
        while size:
            for start in range(0, len(parts), size):
                yield case.with_file(name, b"".join(parts[:start] + parts[start + size :]))
            size //= 2
    if case.call is not None:
        arguments: dict[str, Any] = case.call["arguments"]
        for name in arguments:
            yield replace(case, call={**case.call, "arguments": {k: v for k, v in arguments.items() if k != name}})
        for name, value in arguments.items():
            for index, number in enumerate(value) if isinstance(value, list) else ():
                if isinstance(number, float) and number != 0.0:
                    rounder = [*value[:index], 0.0, *value[index + 1 :]]
                    yield replace(case, call={**case.call, "arguments": {**arguments, name: rounder}})
