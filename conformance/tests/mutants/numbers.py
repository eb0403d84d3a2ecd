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


@answers("EU-FIL-005", versions=("2", "2.1"))
def divisors_may_be_small(right: Answer, *files: Path) -> Answer:
    """A gear ratio, a pitch or a coefficient may be as near to 0 as it likes."""
    return _accepting(lambda text: re.match(r"-?[0-9.]+e-", text))(right, *files)


@answers("EU-FIL-005")
def negative_numbers_may_have_any_size(right: Answer, *files: Path) -> Answer:
    """Numbers are compared with the bound, and not their sizes."""
    return _accepting(lambda text: text.startswith("-"))(right, *files)


@answers("EU-FIL-005", versions=("2",))
def chains_of_mimics_may_leave_bounds(right: Answer, *files: Path) -> Answer:
    """Multipliers of mimic joints are checked, and not those at the end of a chain."""
    return _accepting(lambda text: re.match(r"2\"|0\.5\"|<mimic", text))(right, *files)


@answers("EU-FIL-005")
def limits_may_be_any_number(right: Answer, *files: Path) -> Answer:
    """Limits have no bound at all, also where they exclude all numbers within bounds."""
    return _accepting(lambda text: re.match(r"-?[0-9]e1[67]", text))(right, *files)


@refuses("EU-FIL-005")
def bounds_themselves_are_beyond(data: Any, robot: Any) -> bool:
    """A number must be less than the bound."""
    return any(abs(float(value)) == 1e15 for value in robot.xpath("//limit/@*|//dynamics/@*"))


def _limits(limit: Callable[..., float | None]) -> Deviation:
    """The numbers of limits mean something else."""

    @contextmanager
    def entered() -> Any:
        with ExitStack() as stack:
            for owner in (urdf, plain_value):
                stack.enter_context(instead(owner, "limit", lambda right, *arguments: limit(*arguments)))
            yield

    return entered()


@means("EU-FIL-006")
def limits_beyond_bounds_are_kept() -> Deviation:
    """A limit is the number that the file states."""
    return _limits(lambda name, value: value)


@means("EU-FIL-006")
def limits_at_the_bound_are_none() -> Deviation:
    """A limit of 1e15 is none."""
    return _limits(lambda name, value: None if value * plain_value.NO_LIMIT[name] >= plain_value.LARGEST else value)


@means("EU-FIL-006")
def limits_beyond_bounds_are_the_bound() -> Deviation:
    """A limit beyond the bound is the bound."""
    return _limits(lambda name, value: max(-plain_value.LARGEST, min(value, plain_value.LARGEST)))
