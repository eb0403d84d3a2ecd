"""An error that can be put into a file: one replacement of text, with the code and place of its diagnostic."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from eurdf_conformance.fresh.kind import FreshKind
from eurdf_conformance.level import VERSIONS, Version
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.text_enum import TextEnum

#: In `Fault.text`: the place of the diagnostic.
PLACE = "¦"


class Subject(TextEnum):
    """What an error is about. Every run has at least one error about each subject, in each version that has it."""

    DANGLING = "dangling name"
    DUPLICATE = "duplicate name"
    CYCLE = "cycle"
    TREE = "tree"
    INERTIA = "inertia"
    SYNTAX = "syntax"
    VALUE = "value"
    CLOSURE = "closure of version 2.1"
    COUPLING = "coupling"
    MOTOR = "motor of version 2.1"
    SPRING = "spring, or freed joint"


@dataclass(frozen=True, slots=True)
class Fault:
    """One error, or what deserves a warning.

    Attributes:
        name: What is wrong, in words.
        subject: What it is about.
        code: Code of its diagnostic.
        file: The file that has it.
        pattern: Regular expression of the text that is replaced, in any of the places where it occurs.
        text: The replacement, as `re.Match.expand` reads it, or what gives it; a broken bar is before the place of the
            diagnostic.
        fix: What to do about it.
        versions: Versions of the format of the descriptions that can have it.
        makes: The kind of case that it makes of a valid one.
    """

    name: str
    subject: Subject
    code: str
    file: str
    pattern: str
    text: str | Callable[[Chance], str]
    fix: str
    versions: tuple[Version, ...] = VERSIONS
    makes: FreshKind = FreshKind.INVALID


@dataclass(frozen=True, slots=True)
class Faulty:
    """A file with one error: its text, and the line and column of the diagnostic, from 1."""

    fault: Fault
    text: str
    line: int
    column: int


def with_fault(fault: Fault, text: str, chance: Chance) -> Faulty | None:
    """The text of a file with an error, in one of the places that can have it; None if there is none."""
    found = list(re.finditer(fault.pattern, text))
    if not found:
        return None
    match = chance.one_of(found)
    replacement = match.expand(fault.text) if isinstance(fault.text, str) else fault.text(chance)
    wrong = text[: match.start()] + replacement + text[match.end() :]
    before, _, after = wrong.partition(PLACE)
    return Faulty(fault, before + after, before.count("\n") + 1, len(before) - before.rfind("\n"))
