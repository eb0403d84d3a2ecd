"""A search beyond the frozen examples: more mechanisms, and for what is wrong with one the smallest that shows it."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from hypothesis.configuration import set_hypothesis_home_dir
from hypothesis.errors import Flaky, FlakyFailure, Unsatisfiable
from hypothesis.strategies import SearchStrategy

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.bench import Bench
from eurdf_conformance.properties.conditioning import is_well_conditioned
from eurdf_conformance.properties.culprit import culprit
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.found_case import how_to_keep, write_case
from eurdf_conformance.properties.law import LARGEST, Law
from eurdf_conformance.properties.smaller import smaller
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.trying import try_example, with_log
from eurdf_conformance.suite.judge import PASSED, Judgement
from eurdf_conformance.suite.property import Trial
from eurdf_conformance.verdict.verdict import Verdict

#: Where cases are written that were found, from where the suite is run.
EXPLORED = Path("explored")

#: s, after which what was found is taken as it is.
SHRINKING = 30.0


class _Wrong(Exception):  # noqa: N818 - it says what the reader is
    """The reader departs from the law."""


def explore(law: Law, level: Level, trial: Trial, bench: Bench, folder: Path = EXPLORED) -> Judgement:
    """Try a law on mechanisms that are drawn at random.

    What it fails on is made as small as it can be while it fails in the same way, and written as a case.

    Args:
        law: The law.
        level: The level at which it is asked.
        trial: How many mechanisms, and for which version.
        bench: The reader.
        folder: Where to write the case.
    """
    found = search(law, level, trial.version, bench, trial.explore, trial.seed)
    if found is None:
        drawn_from = f"{trial.explore} more mechanisms, drawn from seed {trial.seed}"
        return with_log(PASSED, f"exploring has found nothing wrong on {drawn_from}, and no case is written")
    example, judgement = found
    # Once more, since the bench was asked about others meanwhile.
    again = try_example(law, level, trial.version, bench, example)
    case = write_case(law, culprit(bench, level), folder)
    told = replace(judgement, reason=f"on a mechanism found by exploring: {judgement.reason}")
    log = [
        f"found by exploring from seed {trial.seed}: {judgement.verdict}: {judgement.reason}",
        f"made small, and written as a case: {case}",
        *how_to_keep(case),
    ]
    log += ["asked again, the reader answers otherwise"] * (again != judgement)
    return with_log(told, *log)


def search(
    law: Law, level: Level, version: Version, bench: Bench, count: int, seed: int
) -> tuple[Example, Judgement] | None:
    """The smallest example found on which a reader departs from a law, and how; None where it does not.

    Args:
        law: The law.
        level: The level at which it is asked.
        version: Version of the format.
        bench: The reader.
        count: So many examples are drawn.
        seed: What they are drawn from.
    """
    best: list[tuple[Example, Judgement]] = []
    since = 0.0

    @hypothesis.seed(seed)
    @settings(
        max_examples=count,
        database=None,
        deadline=None,
        derandomize=False,
        print_blob=False,
        report_multiple_bugs=False,
        phases=[Phase.generate, Phase.shrink],
        suppress_health_check=list(HealthCheck),
    )
    @given(drawn(law, version))
    def attempt(example: Example) -> None:
        nonlocal since
        if best and example != best[-1][0] and time.monotonic() - since > SHRINKING:
            return
        judgement = try_example(law, level, version, bench, example)
        if judgement.verdict == Verdict.PASSED or (best and judgement.verdict != best[0][1].verdict):
            return
        since = since or time.monotonic()
        best.append((example, judgement))
        raise _Wrong

    # What it keeps would otherwise lie about where the suite is run.
    set_hypothesis_home_dir(bench.folder / "hypothesis")
    try:
        attempt()
    except (_Wrong, Flaky, FlakyFailure):
        # Flaky: the time for making it smaller was over, or the reader does not answer alike when asked again.
        return _reduced(law, level, version, bench, *best[-1]) if best else None
    except Unsatisfiable:
        return None
    finally:
        set_hypothesis_home_dir(None)
    return None


def _reduced(
    law: Law, level: Level, version: Version, bench: Bench, example: Example, judgement: Judgement
) -> tuple[Example, Judgement]:
    """Without the parts that are not needed for the reader to depart from the law in the same way."""
    until = time.monotonic() + SHRINKING
    # A family is of certain mechanisms, of which more is known than they say.
    candidates = iter(() if law.family else smaller(example.mechanism))
    while (mechanism := next(candidates, None)) is not None and time.monotonic() < until:
        few = len(mechanism.closures) < law.closures
        if few or not law.applies(mechanism) or not is_well_conditioned(mechanism, version):
            continue
        tried = example.model_copy(update={"mechanism": mechanism})
        found = try_example(law, level, version, bench, tried)
        if found.verdict == judgement.verdict:
            example, judgement, candidates = tried, found, smaller(mechanism)
    return example, judgement


def drawn(law: Law, version: Version) -> SearchStrategy[Example]:
    """What a law is tried with."""
    if law.family is not None:
        return st.integers(law.smallest, LARGEST).map(law.family)
    examples = st.builds(Example, mechanism=mechanisms(version, law.closures), seed=st.integers(0, 10**6))
    return examples.filter(lambda example: law.applies(example.mechanism))
