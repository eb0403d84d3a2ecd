"""A law, tried on a reader: on the frozen examples, and then on as many more as are asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.bench import Bench, NotAnswered
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.law import Law
from eurdf_conformance.properties.shape import WrongShape
from eurdf_conformance.suite.failure_text import where_it_stood
from eurdf_conformance.suite.judge import PASSED, Judgement, judge_outcome
from eurdf_conformance.suite.property import Trial
from eurdf_conformance.verdict.verdict import Verdict


def try_law(law: Law, level: Level, trial: Trial) -> Judgement:
    """Whether a law holds of a reader; where exploring is asked for, also whether it fails on a smaller mechanism."""
    bench = Bench(trial.reader, trial.folder)
    judgement = try_frozen(law, level, trial.version, bench)
    if not trial.explore:
        return judgement
    # Hypothesis is needed only here.
    from eurdf_conformance.properties.explore import explore

    further = explore(law, level, trial, bench)
    if judgement.verdict == Verdict.PASSED:
        return further
    return with_log(judgement, further.log)


def try_frozen(law: Law, level: Level, version: Version, bench: Bench) -> Judgement:
    """Whether a law holds of a reader on the examples of every certification, up to the first on which it does not."""
    for number, example in enumerate(law.frozen(version), 1):
        judgement = try_example(law, level, version, bench, example)
        if judgement.verdict != Verdict.PASSED:
            told = replace(judgement, reason=f"example {number}: {judgement.reason}")
            return with_log(told, *dict.fromkeys(_files(bench, judgement)))
    return PASSED


def _files(bench: Bench, judgement: Judgement) -> Iterator[str]:
    """The files that a reader was asked about, and where the robot of each stood at the first difference."""
    for asked, paths in bench.asked:
        yield from map(str, paths)
        yield from where_it_stood(judgement, asked.configurations)


def try_example(law: Law, level: Level, version: Version, bench: Bench, example: Example) -> Judgement:
    """Whether a law holds of a reader on one example."""
    bench.begin()
    try:
        found = law.check(bench, example, version, level)
    except NotAnswered as failure:
        return judge_outcome(failure.outcome, failure.expected)
    except WrongShape as wrong:
        return Judgement(Verdict.FAILED, "its values are not those asked for", wrong.differences)
    return Judgement(Verdict.FAILED, f"it is not so: {law.title}", tuple(found)) if found else PASSED


def with_log(judgement: Judgement, *lines: str) -> Judgement:
    """A judgement with more lines in its log."""
    return replace(judgement, log="\n".join(line for line in (judgement.log, *lines) if line))
