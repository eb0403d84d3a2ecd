"""A property: what holds of any reader and any mechanism, tried on many."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from eurdf_conformance.level import Level, Version
from eurdf_conformance.suite.conversation import Reader
from eurdf_conformance.suite.judge import Judgement

#: The package whose ``PROPERTIES`` are all of them.
_PACKAGE = "eurdf_conformance.properties"


@dataclass(frozen=True)
class Trial:
    """What a property is tried with.

    Attributes:
        reader: Who is asked.
        version: Version of the format that the files are of.
        explore: Further random mechanisms to try; 0 for the frozen ones alone.
        folder: Empty, to write files into.
        seed: What further mechanisms are drawn from.
    """

    reader: Reader
    version: Version
    explore: int
    folder: Path
    seed: int = 0


@dataclass(frozen=True)
class Property:
    """A property.

    Attributes:
        name: Permanent.
        title: What holds, as a sentence.
        clauses: The clauses that it tests.
        level: Level at which it is asked.
        versions: Versions of the format for which it is asked.
        check: Whether it holds of a reader.
    """

    name: str
    title: str
    clauses: tuple[str, ...]
    level: Level
    versions: tuple[Version, ...]
    check: Callable[[Trial], Judgement]


def all_properties() -> Sequence[Property]:
    """Every property that there is."""
    found: Sequence[Property] = import_module(_PACKAGE).PROPERTIES
    return found
