"""Draws the fresh cases of a run: ``python -m eurdf_conformance.fresh.draw`` reads a seed and writes JSON."""

from __future__ import annotations

import json
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import Any

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from eurdf_conformance.corpus.case import CasePlace
from eurdf_conformance.corpus.expect import expected_of
from eurdf_conformance.fresh.case import Drawn
from eurdf_conformance.fresh.fault import Fault, Subject, with_fault
from eurdf_conformance.fresh.faults import FAULTS
from eurdf_conformance.fresh.kind import COUNTS, FreshKind
from eurdf_conformance.level import VERSIONS, Version
from eurdf_conformance.oracle import read
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.files import DESCRIPTION, URDF
from eurdf_conformance.properties.freeze import chosen
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.query import Query, query_of
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.truth import truth

#: For so many mechanisms that are kept one more is drawn: those are kept that differ most in what they use.
_KEPT = 3


def draw(seed: int) -> Iterator[Drawn]:
    """The fresh cases of a seed, in the order of their versions and kinds."""
    for version in VERSIONS:
        left = drawn_examples(version, seed)
        for kind, count in COUNTS.items():
            faults = [fault for fault in FAULTS if version in fault.versions and fault.makes is kind]
            if kind is FreshKind.VALID:
                examples = left[:count]
                yield from (_valid(kind, version, example) for example in examples)
            else:
                examples = list(islice((each for each in left if _takes_one(each, version, faults)), count))
                yield from _faulty(kind, version, examples, faults, Chance(seed))
            left = [each for each in left if not any(each is example for example in examples)]


def drawn_examples(version: Version, seed: int) -> list[Example]:
    """Mechanisms that a version of the format can express, most of them with closures: one for each fresh case."""
    found: list[Example] = []
    count = sum(COUNTS.values())
    any_number = st.sampled_from([0, 1, 1, 2]).flatmap(lambda closures: mechanisms(version, closures))

    @hypothesis.seed(seed)
    @settings(
        max_examples=count + count // _KEPT,
        database=None,
        deadline=None,
        derandomize=False,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(any_number, st.integers(0, 10**6))
    def keep(mechanism: Mechanism, variation: int) -> None:
        hypothesis.assume(truth(mechanism, version).loops_close())  # EU-CLO-016: else parsers may differ
        found.append(Example(mechanism=mechanism, seed=variation))

    keep()
    return Chance(seed).shuffled(chosen(found, count))


def _valid(
    kind: FreshKind, version: Version, example: Example, files: Mapping[str, str] | None = None, **error: Any
) -> Drawn:
    """A valid case, with the answers of the oracle on its files: those of the mechanism unless others are given."""
    query = query_of(example.mechanism, version)
    files = files or _texts(query)
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            Path(folder, name).write_text(text, encoding="utf-8", newline="")
        robot = read(Path(folder, DESCRIPTION), Path(folder, URDF), version)
    configurations = [{name: list(q) for name, q in each.items()} for each in query.configurations]
    return Drawn(
        version=version,
        kind=kind,
        files=dict(files),
        example=example,
        configurations=configurations,
        frames=list(query.frames),
        expected=expected_of(robot, configurations, query.frames),
        **error,
    )


def _takes_one(example: Example, version: Version, faults: Iterable[Fault]) -> bool:
    """Whether one of the errors can be put into a mechanism: without an inertia there is none of an inertia."""
    files = _texts(query_of(example.mechanism, version))
    return any(with_fault(fault, files[fault.file], Chance(0)) for fault in faults)


def _faulty(
    kind: FreshKind, version: Version, examples: Iterable[Example], faults: Iterable[Fault], chance: Chance
) -> Iterator[Drawn]:
    """Each of the mechanisms with one error: equally many about each subject, and as different ones as possible."""
    left, subjects = chance.shuffled(faults), Counter[Subject]()
    for example in examples:
        files = _texts(query_of(example.mechanism, version))
        fault, faulty = next(
            (fault, faulty)
            for fault in sorted(left, key=lambda each: subjects[each.subject])
            if (faulty := with_fault(fault, files[fault.file], chance)) is not None
        )
        left = [*(other for other in left if other is not fault), fault]  # it is the last to be used again
        subjects[fault.subject] += 1
        texts = {**files, fault.file: faulty.text}
        error: dict[str, Any] = {
            "error": fault.name,
            "code": fault.code,
            "place": CasePlace(file=fault.file, line=faulty.line, column=faulty.column),
            "fix": fault.fix,
        }
        if kind is FreshKind.WARNED:
            yield _valid(kind, version, example, texts, **error)
        else:
            yield Drawn(version=version, kind=kind, files=texts, example=example, **error)


def _texts(query: Query) -> dict[str, str]:
    return {DESCRIPTION: query.files.description.decode(), URDF: query.files.urdf.decode()}


if __name__ == "__main__":
    values = [each.model_dump(mode="json", exclude_defaults=True) for each in draw(json.load(sys.stdin))]
    sys.stdout.write(json.dumps(values, ensure_ascii=False))
