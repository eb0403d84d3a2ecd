"""The clauses of the specification, read from its registry."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

from eurdf_conformance.carried import carried
from eurdf_conformance.level import VERSIONS, Version


@dataclass(frozen=True, slots=True)
class Clause:
    """One requirement.

    Attributes:
        id: Permanent id.
        keyword: MUST, MUST NOT, SHOULD, SHOULD NOT or MAY.
        text: What it says.
        level: Level at which it is tested; ``parser`` where no suite sees it.
        versions: Versions of the format that it is of; a clause of version 2 is also of version 2.1.
        codes: Diagnostics that say that it is not met.
        testable: Whether a suite can test it.
    """

    id: str
    keyword: str
    text: str
    level: str
    versions: tuple[Version, ...]
    codes: frozenset[str]
    testable: bool

    @property
    def must(self) -> bool:
        """Whether a violation is an error."""
        return self.keyword.startswith("MUST")


def read_registry() -> dict[str, Any]:
    """The registry of clauses and diagnostics, as ``spec/clauses.schema.json`` describes it."""
    registry: dict[str, Any] = json.loads(carried("spec/clauses.json").read_text(encoding="utf-8"))
    return registry


@cache
def read_clauses() -> Mapping[str, Clause]:
    """The clauses of this edition by id, read once per process."""
    registry = read_registry()
    codes: defaultdict[str, set[str]] = defaultdict(set)
    for diagnostic in registry["diagnostics"]:
        codes[diagnostic["clause"]].add(diagnostic["code"])
    clauses = {
        entry["id"]: Clause(
            entry["id"],
            entry["keyword"],
            entry["text"],
            entry["level"],
            tuple(version for version in VERSIONS if {version, version.split(".")[0]} & set(entry["versions"])),
            frozenset(codes[entry["id"]]),
            entry["untested"] is None and entry["level"] != "parser",
        )
        for entry in registry["clauses"]
    }
    return MappingProxyType(clauses)
