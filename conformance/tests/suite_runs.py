"""Runs of the conformance suite, made by hand."""

from __future__ import annotations

from typing import Any

from eurdf_conformance.judging.result import Item, Result
from eurdf_conformance.judging.run import Run
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.protocol.message import ParserInfo, Started

VALID, INVALID = "closures/aaaaa1", "closures/bbbbb2"


def started(claims: dict[Version, list[Level]], name: str = "my_parser") -> Started:
    """A parser that claims these levels."""
    return Started(id=1, protocol="1.0", parser=ParserInfo(name=name, version="0.3", language="C++"), claims=claims)


def item(id_: str, level: Level, version: Version = "2", *clauses: str) -> Item:
    """A question."""
    return Item(id_, level, version, clauses or ("EU-CLO-001",), "Two closures may not have one name.")


def result(of: Item, verdict: Verdict = Verdict.PASSED, *differences: str) -> Result:
    """What became of it."""
    return Result(of, verdict, differences, f"pytest conformance/ -k {of.id}/{of.level}", seconds=0.1)


#: Two cases of version 2: one valid, at three levels; one invalid, at two.
PLANNED = (
    *(item(VALID, level, "2", "EU-CLO-008") for level in (Level.ACCEPT, Level.STRUCTURE, Level.DIAGNOSE)),
    *(item(INVALID, level) for level in (Level.ACCEPT, Level.DIAGNOSE)),
)


def run(verdicts: dict[tuple[str, Level], Verdict] | None = None, **changes: Any) -> Run:
    """A run in which a parser of version 2, that claims accept and structure, passes everything but what is said."""
    claims: dict[Version, list[Level]] = changes.pop("claims", {"2": [Level.ACCEPT, Level.STRUCTURE]})
    of = verdicts or {}
    results = tuple(
        result(each, of.get(each.key, Verdict.PASSED), *(["/outcome: expected"] if each.key in of else []))
        for each in PLANNED
        if each.level in claims.get(each.version, [])
    )
    given: dict[str, Any] = {
        "parser": "cmd:./my_parser",
        "started": started(claims),
        "planned": PLANNED,
        "results": results,
    }
    return Run(**(given | changes))
