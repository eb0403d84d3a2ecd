"""Tries a property on a parser: on one example, or on the frozen ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from eurdf_conformance.judging.failure_text import where_it_stood
from eurdf_conformance.judging.judge import PASSED, Judgement, judge_outcome
from eurdf_conformance.judging.verdict import Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.harness import Harness, Lacked, NotAnswered
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.shape import WrongShape


def try_frozen(prop: Property, level: Level, version: Version, harness: Harness) -> Judgement:
    """Whether a property holds on the examples of every certification, up to the first on which it does not.

    It is excused if each example needs a feature that the parser lacks.
    """
    excused, excused_count = PASSED, 0
    for number, example in enumerate(examples := prop.frozen(version), 1):
        judgement = try_example(prop, level, version, harness, example)
        if judgement.verdict == Verdict.EXCUSED:
            excused, excused_count = judgement, excused_count + 1
        elif judgement.verdict != Verdict.PASSED:
            found = replace(judgement, reason=f"example {number}: {judgement.reason}")
            return with_log(found, *queried(harness, judgement))
    return excused if 0 < len(examples) == excused_count else PASSED


def queried(harness: Harness, judgement: Judgement) -> Iterable[str]:
    """The files of the queries since `Harness.begin`, and the configuration of each robot at the first difference."""
    return dict.fromkeys(_queried(harness, judgement))


def _queried(harness: Harness, judgement: Judgement) -> Iterator[str]:
    for query, paths in harness.queries:
        yield from map(str, paths)
        yield from where_it_stood(judgement, query.configurations)


def try_example(prop: Property, level: Level, version: Version, harness: Harness, example: Example) -> Judgement:
    """Whether a property holds of a parser on one example."""
    harness.begin()
    try:
        found = prop.check(harness, example, version, level)
    except Lacked as lacking:
        return lacking.judgement
    except NotAnswered as failure:
        return judge_outcome(failure.outcome, failure.expected)
    except WrongShape as wrong:
        return Judgement(Verdict.FAILED, "the values do not have the requested shape", wrong.differences)
    return Judgement(Verdict.FAILED, f"the property does not hold: {prop.title}", tuple(found)) if found else PASSED


def with_log(judgement: Judgement, *lines: str) -> Judgement:
    """A judgement with more lines in its log."""
    return replace(judgement, log="\n".join(line for line in (judgement.log, *lines) if line))
