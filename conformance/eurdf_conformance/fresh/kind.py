"""The kinds of fresh cases."""

from __future__ import annotations

from collections.abc import Mapping

from eurdf_conformance.level import Level
from eurdf_conformance.text_enum import TextEnum


class FreshKind(TextEnum):
    """A kind of fresh cases."""

    VALID = "valid"
    #: Valid, with one warning.
    WARNED = "warned"
    #: With one error that leaves a robot: a parser may accept or reject it.
    EITHER = "either"
    INVALID = "invalid"


#: Fresh cases of each version.
COUNTS: Mapping[FreshKind, int] = {
    FreshKind.VALID: 8,
    FreshKind.WARNED: 2,
    FreshKind.EITHER: 2,
    FreshKind.INVALID: 10,
}

#: What a fresh case is, whatever is drawn.
TITLES: Mapping[FreshKind, str] = {
    FreshKind.VALID: "A mechanism that was drawn for this run.",
    FreshKind.WARNED: "A mechanism that was drawn for this run, with one warning.",
    FreshKind.EITHER: "A mechanism that was drawn for this run, with one error of inertia.",
    FreshKind.INVALID: "A mechanism that was drawn for this run, with one error.",
}


def fresh_levels(kind: FreshKind) -> tuple[Level, ...]:
    """The levels at which fresh cases of a kind are tested."""
    return tuple(Level) if kind in (FreshKind.VALID, FreshKind.WARNED) else (Level.ACCEPT, Level.DIAGNOSE)


def accept_clause(kind: FreshKind) -> str:
    """The clause that fresh cases of a kind test at level accept."""
    return {FreshKind.EITHER: "EU-PRO-001", FreshKind.INVALID: "EU-CNF-001"}.get(kind, "EU-CNF-002")
