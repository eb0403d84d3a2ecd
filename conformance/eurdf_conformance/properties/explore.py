"""Tries a property beyond the frozen examples, and reduces a failure to the smallest mechanism that shows it."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from hypothesis.configuration import set_hypothesis_home_dir
from hypothesis.errors import Flaky, FlakyFailure, Unsatisfiable
from hypothesis.strategies import SearchStrategy

from eurdf_conformance.feature import Feature
from eurdf_conformance.judging.conversation import Parser
from eurdf_conformance.judging.judge import PASSED, Judgement
from eurdf_conformance.judging.verdict import NO_FAILURE, Verdict
from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.conditioning import is_well_conditioned
from eurdf_conformance.properties.culprit import culprit
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.property import LARGEST, Property
from eurdf_conformance.properties.smaller import smaller
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.trying import queried, try_example, try_frozen, with_log
from eurdf_conformance.properties.write_case import how_to_keep, write_case

#: Where cases are written that were found, from where the suite is run.
EXPLORED = Path("explored")

#: s, after which what was found is taken as it is.
SHRINKING = 30.0


class _Wrong(Exception):  # noqa: N818 - it says what the parser is
    """The parser violates the property."""


@dataclass(frozen=True)
class Trial:
    """What a property is tried with.

    Attributes:
        parser: The parser that answers.
        version: Version of the format that the files are of.
        explore: Number of further random mechanisms to try.
        folder: Empty, to write files into.
        seed: What further mechanisms are drawn from.
        fresh: Examples that were drawn for this run.
        lacks: The features that the parser lacks.
    """

    parser: Parser
    version: Version
    explore: int
    folder: Path
    seed: int = 0
    fresh: Sequence[Example] = ()
    lacks: frozenset[Feature] = frozenset()


def try_property(prop: Property, level: Level, trial: Trial) -> Judgement:
    """Whether a property holds of a parser; if the user explores, also whether it fails on a smaller mechanism."""
    harness = Harness(trial.parser, trial.folder, trial.lacks)
    judgement = try_frozen(prop, level, trial.version, harness)
    if judgement.verdict in NO_FAILURE and (fresh := try_fresh(prop, level, trial, harness)).verdict not in NO_FAILURE:
        judgement = fresh
    if not trial.explore:
        return judgement
    further = explore(prop, level, trial, harness)
    if judgement.verdict == Verdict.EXCUSED and further.verdict == Verdict.PASSED:
        return judgement
    if judgement.verdict in NO_FAILURE:
        return further
    return with_log(judgement, further.log)


def try_fresh(prop: Property, level: Level, trial: Trial, harness: Harness) -> Judgement:
    """Try a property on the examples that were drawn for this run, and make the first one on which it fails small."""
    for example in () if prop.family else trial.fresh:
        if len(example.mechanism.closures) < prop.closures or not prop.applies(example.mechanism):
            continue
        judgement = try_example(prop, level, trial.version, harness, example)
        if judgement.verdict not in NO_FAILURE:
            small, _ = _reduced(prop, level, trial.version, harness, example, judgement)
            # Once more, so that the files are those of its queries.
            judgement = try_example(prop, level, trial.version, harness, small)
            reason = f"on a mechanism drawn from seed {trial.seed}: {judgement.reason}"
            return with_log(replace(judgement, reason=reason), *queried(harness, judgement))
    return PASSED


def explore(prop: Property, level: Level, trial: Trial, harness: Harness, folder: Path = EXPLORED) -> Judgement:
    """Try a property on random mechanisms.

    What it fails on is made as small as it can be while it fails in the same way, and written as a case.

    Args:
        prop: The property.
        level: The level at which it is asked.
        trial: How many mechanisms, and for which version.
        harness: The parser.
        folder: Where to write the case.
    """
    found = search(prop, level, trial.version, harness, trial.explore, trial.seed)
    if found is None:
        drawn_from = f"{trial.explore} more mechanisms, drawn from seed {trial.seed}"
        return with_log(PASSED, f"exploring found no error on {drawn_from}; no case is written")
    example, judgement = found
    # Once more, since the harness was asked about others meanwhile.
    again = try_example(prop, level, trial.version, harness, example)
    case = write_case(prop, culprit(harness, level), folder)
    explained = replace(judgement, reason=f"on a mechanism found by exploring: {judgement.reason}")
    log = [
        f"found by exploring from seed {trial.seed}: {judgement.verdict}: {judgement.reason}",
        f"reduced and written as a case: {case}",
        *how_to_keep(case),
    ]
    log += ["the parser answers differently when asked again"] * (again != judgement)
    return with_log(explained, *log)


def search(
    prop: Property, level: Level, version: Version, harness: Harness, count: int, seed: int
) -> tuple[Example, Judgement] | None:
    """The smallest example found on which a parser departs from a property, and how; None where it does not.

    Args:
        prop: The property.
        level: The level at which it is asked.
        version: Version of the format.
        harness: The parser.
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
    @given(drawn(prop, version))
    def attempt(example: Example) -> None:
        nonlocal since
        if best and example != best[-1][0] and time.monotonic() - since > SHRINKING:
            return
        judgement = try_example(prop, level, version, harness, example)
        if judgement.verdict in NO_FAILURE or (best and judgement.verdict != best[0][1].verdict):
            return
        since = since or time.monotonic()
        best.append((example, judgement))
        raise _Wrong

    # What it keeps would otherwise lie about where the suite is run.
    set_hypothesis_home_dir(harness.folder / "hypothesis")
    try:
        attempt()
    except (_Wrong, Flaky, FlakyFailure):
        # Flaky: the time for making it smaller was over, or the parser does not answer alike when asked again.
        return _reduced(prop, level, version, harness, *best[-1]) if best else None
    except Unsatisfiable:
        return None
    finally:
        set_hypothesis_home_dir(None)
    return None


def _reduced(
    prop: Property, level: Level, version: Version, harness: Harness, example: Example, judgement: Judgement
) -> tuple[Example, Judgement]:
    """Without the parts that are not needed for the parser to depart from the property in the same way."""
    until = time.monotonic() + SHRINKING
    # A family is of certain mechanisms, of which more is known than they say.
    candidates = iter(() if prop.family else smaller(example.mechanism))
    while (mechanism := next(candidates, None)) is not None and time.monotonic() < until:
        few = len(mechanism.closures) < prop.closures
        if few or not prop.applies(mechanism) or not is_well_conditioned(mechanism, version):
            continue
        tried = example.model_copy(update={"mechanism": mechanism})
        found = try_example(prop, level, version, harness, tried)
        if found.verdict == judgement.verdict:
            example, judgement, candidates = tried, found, smaller(mechanism)
    return example, judgement


def drawn(prop: Property, version: Version) -> SearchStrategy[Example]:
    """An example for a property."""
    if prop.family is not None:
        return st.integers(prop.smallest, LARGEST).map(prop.family)
    examples = st.builds(Example, mechanism=mechanisms(version, prop.closures), seed=st.integers(0, 10**6))
    return examples.filter(lambda example: prop.applies(example.mechanism))
