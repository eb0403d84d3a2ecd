"""Parsers with other bounds of numbers."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from eurdf_conformance.oracle import plain_value, urdf
from eurdf_conformance.protocol.message import Issue
from mutants.mutant import Answer, Deviation, accepting, instead, text_of


def _accepting(pattern: str) -> Callable[..., Answer]:
    """A number that is out of bounds is accepted, where the text from its place on is such a one."""

    def is_accepted(issue: Issue, *files: Path) -> Any:
        (text,) = (text_of(file) for file in files if file.name == issue.file)
        return re.match(pattern, text.splitlines()[(issue.line or 1) - 1][(issue.column or 1) - 1 :])

    return accepting("number-out-of-bounds", is_accepted)


def _limits(limit: Callable[..., float | None]) -> tuple[Deviation, ...]:
    """The numbers of limits mean something else: limit(name, value)."""
    return tuple(instead(owner, "limit", lambda right, *stated: limit(*stated)) for owner in (urdf, plain_value))


ANSWERS = {
    ("EU-FIL-005", "2", "2.1"): {
        "A gear ratio, a pitch or a coefficient may be as near to 0 as it likes.": _accepting(r"-?[0-9.]+e-"),
    },
    "EU-FIL-005": {
        "Numbers are compared with the bound, and not their sizes.": _accepting("-"),
        "Limits have no bound at all, also where they exclude all numbers within bounds.": _accepting("-?[0-9]e1[67]"),
    },
    ("EU-FIL-005", "2"): {
        "Multipliers of mimic joints are checked, and not those at the end of a chain.": _accepting(
            r"2\"|0\.5\"|<mimic"
        ),
    },
}

REFUSES = {
    "EU-FIL-005": {
        "A number must be less than the bound.": lambda data, robot: any(
            abs(float(value)) == 1e15 for value in robot.xpath("//limit/@*|//dynamics/@*")
        ),
    },
}

MEANS = {
    "EU-FIL-006": {
        "A limit is the number that the file states.": _limits(lambda name, value: value),
        "A limit of 1e15 is none.": _limits(
            lambda name, value: None if value * plain_value.NO_LIMIT[name] >= plain_value.LARGEST else value
        ),
        "A limit beyond the bound is the bound.": _limits(
            lambda name, value: max(-plain_value.LARGEST, min(value, plain_value.LARGEST))
        ),
    },
}
