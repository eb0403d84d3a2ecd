"""The result of each level of a run, for each version of the format."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from eurdf_conformance.judging.result import Result
from eurdf_conformance.judging.run import Run
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import VERSIONS, Level, Version

Count = Annotated[int, Field(ge=0)]


class Tally(BaseModel):
    """Items of one kind."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    items: Count
    """Number of them that a parser is asked."""
    passed: Count
    """Number of them that it passed."""


class LevelResult(BaseModel):
    """Pass or fail of one level for one version."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    version: Version
    level: Level
    claimed: bool
    """Whether the parser claims it. If not, nothing was tested."""
    asked: bool
    """Whether the user asked for it. If not, nothing was tested."""
    items: Count
    """Number of cases and properties of the suite at this level."""
    counts: dict[Verdict, Count]
    """Number of items by verdict."""
    valid: Tally
    """The items with valid files, properties included."""
    invalid: Tally
    """The items with invalid files."""
    known_failures: Count
    """Number of failures that were expected."""
    certified: bool
    """Whether it is claimed and every item has passed or is excused; excused is what needs a feature in `lacks`."""


def level_results(run: Run) -> tuple[LevelResult, ...]:
    """The result of every level for every version, also of those that are not claimed."""
    results: defaultdict[tuple[Version, Level], list[Result]] = defaultdict(list)
    for result in run.accounted():
        results[result.item.version, result.item.level].append(result)
    items = Counter((item.version, item.level) for item in run.planned)
    return tuple(
        _level_result(run, version, level, items[version, level], results[version, level])
        for version in VERSIONS
        for level in Level
    )


def _level_result(run: Run, version: Version, level: Level, items: int, results: Sequence[Result]) -> LevelResult:
    claimed, asked = run.claims(version, level), run.asks(version, level)
    counts = Counter(result.verdict for result in results)
    # A level without an item proves nothing, and a smoke run certifies nothing.
    # Neither does one of which every item is excused.
    no_failure = items == counts[Verdict.PASSED] + counts[Verdict.EXCUSED] == counts.total()
    all_passed = counts[Verdict.PASSED] > 0 and no_failure
    return LevelResult(
        version=version,
        level=level,
        claimed=claimed,
        asked=asked,
        items=items,
        counts={verdict: counts[verdict] for verdict in Verdict if counts[verdict]},
        valid=_tally(run, version, level, results, valid=True),
        invalid=_tally(run, version, level, results, valid=False),
        known_failures=sum(run.known_failures.expects(result) for result in results),
        certified=claimed and asked and all_passed and not run.smoke,
    )


def _tally(run: Run, version: Version, level: Level, results: Sequence[Result], *, valid: bool) -> Tally:
    planned = [item for item in run.planned if (item.version, item.level, item.valid) == (version, level, valid)]
    passed = [each for each in results if each.item.valid is valid and each.verdict == Verdict.PASSED]
    return Tally(items=len(planned), passed=len(passed))


def is_certified(run: Run) -> bool:
    """Whether at least one level is claimed and requested, and all such levels are certified.

    If the user has requested only some levels, each of them must be claimed for at least one version.
    """
    tested = [result for result in level_results(run) if result.claimed and result.asked]
    return not unclaimed(run) and all(result.certified for result in tested)


def unclaimed(run: Run) -> tuple[Level, ...]:
    """The requested levels that the parser claims for none of the requested versions.

    If all levels are requested, one claimed level is enough.
    """
    missing = tuple(level for level in run.levels if not any(run.claims(version, level) for version in run.versions))
    return () if len(missing) < len(run.levels) == len(Level) else missing
