"""The items of the suite: protocol rules, every case at each of its levels, and every property."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

from eurdf_conformance.bounds import BoundCase, bound_cases
from eurdf_conformance.corpus.case import Case, InvalidCase, ValidCase
from eurdf_conformance.corpus.clause import read_clauses
from eurdf_conformance.corpus.protocol_rule import RULES, ProtocolRule
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.fresh.case import fresh_name
from eurdf_conformance.fresh.kind import COUNTS, TITLES, FreshKind, accept_clause, fresh_levels
from eurdf_conformance.judging.result import Item
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.level_spec import LEVELS
from eurdf_conformance.properties import PROPERTIES
from eurdf_conformance.properties.property import Property


@dataclass(frozen=True)
class CaseItem:
    """A case at one of its levels."""

    item: Item
    case: CorpusCase


@dataclass(frozen=True)
class ProtocolItem:
    """A protocol rule, tested if the parser claims the version."""

    item: Item
    rule: ProtocolRule


@dataclass(frozen=True)
class PropertyItem:
    """A property, tested if the parser claims its level for the version."""

    item: Item
    property: Property


def case_items(cases: Iterable[CorpusCase]) -> Iterator[CaseItem]:
    """The items of cases."""
    for case in cases:
        for level in case.levels:
            said = case.case
            clauses = clauses_at(level, said.version, said.clauses, _general(case, level))
            yield CaseItem(Item(case.name, level, said.version, clauses, said.title, is_valid(said)), case)


def is_valid(case: Case) -> bool:
    """Whether the files of a case are valid."""
    return isinstance(case, ValidCase)


def clauses_at(level: Level, version: Version, cited: Iterable[str], general: str) -> tuple[str, ...]:
    """The clauses that an item tests: the cited ones that are visible at its level, and the one of the level itself.

    An answer that only accepts a description does not show how the parser understood it.
    """
    clauses = read_clauses()
    seen = (name for name in cited if clauses[name].level in LEVELS[level].shows and version in clauses[name].versions)
    return tuple(dict.fromkeys((*seen, general)))


def _general(case: CorpusCase, level: Level) -> str:
    """The clause that every case like this tests at a level."""
    if level is Level.ACCEPT and isinstance(case.case, InvalidCase):
        return "EU-PRO-001" if case.case.either else "EU-CNF-001"
    return LEVELS[level].clause


#: The kinds of fresh cases whose files are valid.
_VALID = (FreshKind.VALID, FreshKind.WARNED)


@dataclass(frozen=True)
class FreshItem:
    """A fresh case at one of its levels; it is drawn when it is asked for."""

    item: Item


def fresh_items() -> Iterator[FreshItem]:
    """The items on fresh cases: whatever is drawn, their ids, levels and clauses are the same."""
    for version, (kind, count) in product(VERSIONS, COUNTS.items()):
        for number, level in product(range(1, count + 1), fresh_levels(kind)):
            general = accept_clause(kind) if level is Level.ACCEPT else LEVELS[level].clause
            yield FreshItem(
                Item(fresh_name(version, kind, number), level, version, (general,), TITLES[kind], kind in _VALID)
            )


@dataclass(frozen=True)
class BoundItem:
    """A robot at a bound, or beyond it."""

    item: Item
    case: BoundCase


def bound_items() -> Iterator[BoundItem]:
    """The items on bounds."""
    for case in bound_cases():
        said = case.case
        clauses = clauses_at(Level.ACCEPT, said.version, said.clauses, _general(case, Level.ACCEPT))
        yield BoundItem(Item(case.name, Level.ACCEPT, said.version, clauses, said.title, is_valid(said)), case)


def planned_items(cases: Iterable[CorpusCase]) -> Iterator[Item]:
    """Every item of the suite."""
    yield from (found.item for found in protocol_items())
    yield from (found.item for found in case_items(cases))
    yield from (found.item for found in property_items())
    yield from (found.item for found in fresh_items())
    yield from (found.item for found in bound_items())


def protocol_items() -> Iterator[ProtocolItem]:
    """The items of the protocol."""
    for version in VERSIONS:
        for rule in RULES:
            item = Item(f"protocol/{rule.name}-{version}", Level.ACCEPT, version, rule.clauses, rule.title)
            yield ProtocolItem(item, rule)


def property_items() -> Iterator[PropertyItem]:
    """The items of properties."""
    for each in PROPERTIES:
        for level, version in product(each.levels, each.versions):
            clauses = clauses_at(level, version, each.clauses, LEVELS[level].clause)
            yield PropertyItem(
                Item(f"properties/{each.name}-{version}", level, version, clauses, each.title, valid=True), each
            )
