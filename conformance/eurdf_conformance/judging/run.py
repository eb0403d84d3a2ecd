"""Everything known at the end of a run of the suite, as collected by the plug-in of pytest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from eurdf_conformance.feature import Feature, ordered
from eurdf_conformance.judging.known_failures import NONE_KNOWN, KnownFailures
from eurdf_conformance.judging.result import Item, Result
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.protocol.message import Started


@dataclass(frozen=True)
class Run:
    """One run of the suite on one parser."""

    #: The parser as the user named it.
    parser: str
    #: Name, version and claims that the parser reported; None if it could not be started.
    started: Started | None
    #: Every item of the suite, at any level and for any version. An item that is claimed and requested but has no
    #: result counts as not run, so a parser cannot be certified on half of the suite.
    planned: tuple[Item, ...]
    results: tuple[Result, ...]
    #: Levels and versions that the user asked for.
    levels: tuple[Level, ...] = tuple(Level)
    versions: tuple[Version, ...] = VERSIONS
    smoke: bool = False
    #: Further random mechanisms tried for each property.
    explore: int = 0
    #: The seed of the order of the items, of the fresh cases and of further mechanisms.
    seed: int = 0
    #: Hash of the fresh cases; None if there were none.
    fresh: str | None = None
    #: Names of the processes that the parser left behind, outside its group, and that the suite has ended.
    left: tuple[str, ...] = ()
    known_failures: KnownFailures = field(default=NONE_KNOWN)

    def claims(self, version: Version, level: Level) -> bool:
        """Whether the parser claims the level for the version."""
        return self.started is not None and level in self.started.claims.get(version, ())

    @property
    def lacks(self) -> tuple[Feature, ...]:
        """The features that the parser lacks, in the order of the specification."""
        return () if self.started is None else ordered(frozenset(self.started.lacks))

    def asks(self, version: Version, level: Level) -> bool:
        """Whether the user asked for the level of the version."""
        return version in self.versions and level in self.levels

    def accounted(self) -> Iterator[Result]:
        """A result for each item that is claimed and requested, by id and level.

        If an item has several results, which does not happen in a run, the last one counts.
        """
        results = {result.item.key: result for result in self.results}
        items = {item.key: item for item in self.planned} | {key: result.item for key, result in results.items()}
        for key, item in sorted(items.items(), key=lambda entry: (entry[0][0], list(Level).index(entry[0][1]))):
            if key in results:
                yield results[key]
            elif self.claims(item.version, item.level) and self.asks(item.version, item.level) and not self.smoke:
                yield Result(item, Verdict.NOT_RUN)
