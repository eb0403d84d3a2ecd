"""A broken variant of the reference reader."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from eurdf_conformance.adapters.reference import Reference
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.coverage import said_in
from eurdf_conformance.level import Level, Version
from eurdf_conformance.mutants.deviation import Deviation
from eurdf_conformance.protocol.message import Accepted, Quantity, Rejected, Values
from eurdf_conformance.verdict.verdict import Verdict

#: An answer that is wrong. A reader that fails by its own word may merely be one that was broken badly.
_WRONG = frozenset({Verdict.FAILED})


class Mutant(Reference):
    """The reference, with one deviation.

    Attributes:
        name: What it is called.
        clause: The clause that it breaks.
        breaks: How, as a sentence.
        level: The level at which it is to be caught, that of the clause.
        versions: The versions in which it is to be caught: those of the clause in which its deviation can be seen.
        caught_by: The verdicts that count as catching it.
        as_process: Whether it is broken in how it speaks, which is seen only where it runs as a process of its own.
    """

    def __init__(
        self,
        name: str,
        clause: str,
        breaks: str,
        deviation: Callable[[], Deviation],
        *,
        level: Level | None = None,
        versions: tuple[Version, ...] | None = None,
        caught_by: frozenset[Verdict] = _WRONG,
        as_process: bool = False,
    ) -> None:
        super().__init__()
        self.name = name
        self.clause = clause
        self.breaks = breaks
        self.deviation = deviation
        self.level = level or Level(read_clauses()[clause].level)
        self.versions = versions or said_in(read_clauses()[clause])
        self.caught_by = caught_by
        self.as_process = as_process

    def load(self, description: Path, urdf: Path) -> Accepted | Rejected:
        """As the reference would, were it so broken."""
        with self.deviation():
            return super().load(description, urdf)

    def evaluate(
        self,
        configurations: Sequence[Mapping[str, Sequence[float]]],
        frames: Sequence[str],
        quantities: Sequence[Quantity],
    ) -> list[Values]:
        """As the reference would, were it so broken."""
        with self.deviation():
            return super().evaluate(configurations, frames, quantities)


def mutant(
    clause: str,
    *,
    level: Level | None = None,
    versions: tuple[Version, ...] | None = None,
    caught_by: frozenset[Verdict] = _WRONG,
    as_process: bool = False,
) -> Callable[[Callable[[], Deviation]], Mutant]:
    """Make a mutant of a function that returns its deviation; its name and docstring are the mutant's.

    Args:
        clause: The clause that it breaks.
        level: The level at which it is to be caught, where that is not the one of the clause.
        versions: The versions in which it is to be caught, where its deviation cannot be seen in all of the clause.
        caught_by: The verdicts that count as catching it.
        as_process: Whether it is broken in how it speaks.
    """

    def made(deviation: Callable[[], Deviation]) -> Mutant:
        breaks = " ".join((deviation.__doc__ or "").split())
        return Mutant(
            deviation.__name__,
            clause,
            breaks,
            deviation,
            level=level,
            versions=versions,
            caught_by=caught_by,
            as_process=as_process,
        )

    return made
