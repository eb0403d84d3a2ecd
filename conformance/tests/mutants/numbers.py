"""Parsers with other bounds of numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from eurdf_conformance.oracle import plain_value, urdf
from eurdf_conformance.protocol.reply import accepted
from mutants.mutant import Answer, Deviation, answers, instead, means, refuses


def _accepting(is_accepted: Callable[[str], Any]) -> Callable[..., Answer]:
    """A number that is out of bounds is accepted, where the text from its place on is such a one."""

    def answer(right: Answer, *files: Path) -> Answer:
        if {issue.code for issue in right.issues} != {"number-out-of-bounds"}:
            return right
        issue = right.issues[0]
        (file,) = (file for file in files if file.name == issue.file)
        line = file.read_text(encoding="utf-8").splitlines()[(issue.line or 1) - 1]
        return accepted() if is_accepted(line[(issue.column or 1) - 1 :]) else right

    return answer


wrong = answers("EU-FIL-005", versions=("2", "2.1"))
wrong(
    "A gear ratio, a pitch or a coefficient may be as near to 0 as it likes.",
    lambda right, *files: _accepting(lambda text: re.match(r"-?[0-9.]+e-", text))(right, *files),
)

wrong = answers("EU-FIL-005")
wrong(
    "Numbers are compared with the bound, and not their sizes.",
    lambda right, *files: _accepting(lambda text: text.startswith("-"))(right, *files),
)

wrong = answers("EU-FIL-005", versions=("2",))
wrong(
    "Multipliers of mimic joints are checked, and not those at the end of a chain.",
    lambda right, *files: _accepting(lambda text: re.match(r"2\"|0\.5\"|<mimic", text))(right, *files),
)

wrong = answers("EU-FIL-005")
wrong(
    "Limits have no bound at all, also where they exclude all numbers within bounds.",
    lambda right, *files: _accepting(lambda text: re.match(r"-?[0-9]e1[67]", text))(right, *files),
)

wrong = refuses("EU-FIL-005")
wrong(
    "A number must be less than the bound.",
    lambda data, robot: any(abs(float(value)) == 1e15 for value in robot.xpath("//limit/@*|//dynamics/@*")),
)


def _limits(limit: Callable[..., float | None]) -> Deviation:
    """The numbers of limits mean something else."""

    @contextmanager
    def entered() -> Any:
        with ExitStack() as stack:
            for owner in (urdf, plain_value):
                stack.enter_context(instead(owner, "limit", lambda right, *arguments: limit(*arguments)))
            yield

    return entered()


wrong = means("EU-FIL-006")
wrong("A limit is the number that the file states.", lambda: _limits(lambda name, value: value))
wrong(
    "A limit of 1e15 is none.",
    lambda: _limits(lambda name, value: None if value * plain_value.NO_LIMIT[name] >= plain_value.LARGEST else value),
)
wrong(
    "A limit beyond the bound is the bound.",
    lambda: _limits(lambda name, value: max(-plain_value.LARGEST, min(value, plain_value.LARGEST))),
)
