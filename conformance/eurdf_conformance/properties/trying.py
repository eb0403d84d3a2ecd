"""A law, tried on a reader: on the frozen examples, and then on as many more as are asked for."""

from __future__ import annotations

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.bench import Bench, NotAnswered
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.law import Law
from eurdf_conformance.properties.shape import WrongShape
from eurdf_conformance.suite.judge import PASSED, Judgement, judge_outcome
from eurdf_conformance.suite.property import Trial
from eurdf_conformance.verdict.verdict import Verdict


def try_law(law: Law, level: Level, trial: Trial) -> Judgement:
    """Whether a law holds of a reader."""
    bench = Bench(trial.reader, trial.folder)
    for number, example in enumerate(law.frozen(trial.version), 1):
        judgement = try_example(law, level, trial.version, bench, example)
        if judgement.verdict != Verdict.PASSED:
            return _told(judgement, f"example {number}", bench)
    if trial.explore:
        # Hypothesis is needed only here.
        from eurdf_conformance.properties.explore import explore

        return explore(law, level, trial, bench)
    return PASSED


def try_example(law: Law, level: Level, version: Version, bench: Bench, example: Example) -> Judgement:
    """Whether a law holds of a reader on one example."""
    try:
        found = law.check(bench, example, version, level)
    except NotAnswered as failure:
        return judge_outcome(failure.outcome)
    except WrongShape as wrong:
        return Judgement(Verdict.FAILED, "its values are not those asked for", wrong.differences)
    return Judgement(Verdict.FAILED, f"it is not so: {law.title}", tuple(found)) if found else PASSED


def _told(judgement: Judgement, where: str, bench: Bench) -> Judgement:
    """A judgement that says on which mechanism, and where the files are that the reader was given last."""
    log = [judgement.log, *map(str, bench.paths)]
    return Judgement(
        judgement.verdict,
        f"{where}: {judgement.reason}",
        judgement.differences,
        judgement.issues,
        "\n".join(line for line in log if line),
    )
