"""What there is to ask: the rules of the protocol, every case at each of its levels, and every property."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from eurdf_conformance.corpus.protocol_rule import RULES, ProtocolRule
from eurdf_conformance.corpus.read import CorpusCase
from eurdf_conformance.level import VERSIONS, Level
from eurdf_conformance.suite.property import Property, all_properties
from eurdf_conformance.verdict.result import Item


@dataclass(frozen=True)
class CaseItem:
    """A case at one of its levels."""

    item: Item
    case: CorpusCase


@dataclass(frozen=True)
class ProtocolItem:
    """A rule of the protocol, asked of those who claim a version."""

    item: Item
    rule: ProtocolRule


@dataclass(frozen=True)
class PropertyItem:
    """A property, asked of those who claim its level for a version."""

    item: Item
    property: Property


def case_items(cases: Iterable[CorpusCase]) -> Iterator[CaseItem]:
    """What there is to ask on cases."""
    for case in cases:
        for level in case.levels:
            said = case.case
            yield CaseItem(Item(case.path, level, said.version, tuple(said.clauses), said.title), case)


def planned_items(cases: Iterable[CorpusCase]) -> Iterator[Item]:
    """Every item of the suite."""
    yield from (found.item for found in protocol_items())
    yield from (found.item for found in case_items(cases))
    yield from (found.item for found in property_items())


def protocol_items() -> Iterator[ProtocolItem]:
    """What there is to ask on the protocol."""
    for version in VERSIONS:
        for rule in RULES:
            item = Item(f"protocol/{rule.name}-{version}", Level.ACCEPT, version, rule.clauses, rule.title)
            yield ProtocolItem(item, rule)


def property_items() -> Iterator[PropertyItem]:
    """What there is to ask on random mechanisms."""
    for found in all_properties():
        for version in found.versions:
            item = Item(f"properties/{found.name}-{version}", found.level, version, found.clauses, found.title)
            yield PropertyItem(item, found)
