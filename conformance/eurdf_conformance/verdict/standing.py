"""What one run comes to, for each version and level."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.verdict.run import Run
from eurdf_conformance.verdict.verdict import Verdict


@dataclass(frozen=True)
class Standing:
    """What a reader has come to at one level for one version."""

    version: Version
    level: Level
    claimed: bool
    #: Whether the run was to test it.
    asked: bool
    #: How many items the suite has there.
    items: int
    #: How many came to which verdict.
    counts: Mapping[Verdict, int]
    #: How many of those that did not pass are known failures.
    known_failures: int
    #: Whether the run can certify at all: three cases tried out cannot.
    whole: bool = True

    @property
    def certified(self) -> bool:
        """Claimed, and every item of it passed. A level without an item proves nothing."""
        passed = self.counts.get(Verdict.PASSED, 0)
        return self.claimed and self.asked and self.whole and 0 < self.items == passed == sum(self.counts.values())


def standings(run: Run) -> tuple[Standing, ...]:
    """What a run comes to, by version and level: all of them, also those that are not claimed."""
    results = list(run.accounted())
    items = Counter((item.version, item.level) for item in run.planned)
    found = []
    for version in VERSIONS:
        for level in Level:
            here = [result for result in results if (result.item.version, result.item.level) == (version, level)]
            found.append(
                Standing(
                    version=version,
                    level=level,
                    claimed=run.claims(version, level),
                    asked=run.asks(version, level),
                    items=items[version, level],
                    counts=Counter(result.verdict for result in here),
                    known_failures=sum(run.known_failures.expects(result) for result in here),
                    whole=not run.smoke,
                )
            )
    return tuple(found)


def is_certified(run: Run) -> bool:
    """Whether every level that is claimed and asked for is certified, and there is one.

    Where the user has asked for some levels only, each of them must be claimed, for one version at least.
    """
    tested = [standing for standing in standings(run) if standing.claimed and standing.asked]
    return not unclaimed(run) and all(standing.certified for standing in tested)


def unclaimed(run: Run) -> tuple[Level, ...]:
    """The levels that the user has asked for and the reader claims for no version asked for.

    Where the user has asked for all of them, one that is claimed will do.
    """
    missing = tuple(level for level in run.levels if not any(run.claims(version, level) for version in run.versions))
    return () if len(missing) < len(run.levels) == len(Level) else missing
