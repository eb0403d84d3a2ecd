"""Draws the fresh cases of a run: ``python -m eurdf_conformance.fresh.draw`` reads a seed and writes JSON."""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import hypothesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from eurdf_conformance.corpus.case import CasePlace
from eurdf_conformance.corpus.expect import expected_of
from eurdf_conformance.fresh.case import COUNT, Drawn
from eurdf_conformance.fresh.fault import FAULTS, with_fault
from eurdf_conformance.level import Version
from eurdf_conformance.oracle import read
from eurdf_conformance.properties.chance import Chance
from eurdf_conformance.properties.example import DRAWN_VERSIONS, Example
from eurdf_conformance.properties.files import DESCRIPTION, URDF
from eurdf_conformance.properties.freeze import chosen
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.query import Query, query_of
from eurdf_conformance.properties.strategies.mechanisms import mechanisms

#: Mechanisms drawn for each that is kept: those are kept that differ most in what they use.
_DRAWN = 2


def draw(seed: int) -> Iterator[Drawn]:
    """The fresh cases of a seed: for each version the valid ones, then the invalid ones."""
    for version in DRAWN_VERSIONS:
        found = drawn_mechanisms(version, seed)
        yield from (_valid(query_of(mechanism, version)) for mechanism in found[:COUNT])
        yield from _invalid([query_of(mechanism, version) for mechanism in found[COUNT:]], Chance(seed))


def drawn_mechanisms(version: Version, seed: int) -> list[Mechanism]:
    """Twice `COUNT` mechanisms that a version of the format can express, most of them with closures."""
    found: list[Example] = []
    any_number = st.sampled_from([0, 1, 1, 2]).flatmap(lambda closures: mechanisms(version, closures))

    @hypothesis.seed(seed)
    @settings(
        max_examples=2 * COUNT * _DRAWN,
        database=None,
        deadline=None,
        derandomize=False,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(any_number)
    def keep(mechanism: Mechanism) -> None:
        found.append(Example(mechanism=mechanism))

    keep()
    return Chance(seed).shuffled(example.mechanism for example in chosen(found, 2 * COUNT))


def _valid(query: Query) -> Drawn:
    with tempfile.TemporaryDirectory() as folder:
        robot = read(*query.files.write(Path(folder)), query.version)
    configurations = [{name: list(q) for name, q in each.items()} for each in query.configurations]
    return Drawn(
        version=query.version,
        valid=True,
        files={DESCRIPTION: query.files.description.decode(), URDF: query.files.urdf.decode()},
        configurations=configurations,
        frames=list(query.frames),
        expected=expected_of(robot, configurations, query.frames),
    )


def _invalid(queries: Sequence[Query], chance: Chance) -> Iterator[Drawn]:
    """Each of the mechanisms with one error, as many different errors as possible."""
    left = [fault for fault in chance.shuffled(FAULTS) if queries[0].version in fault.versions]
    for query in queries:
        files = {DESCRIPTION: query.files.description.decode(), URDF: query.files.urdf.decode()}
        for fault in left:
            faulty = with_fault(fault, files[fault.file], chance)
            if faulty is not None:
                break
        else:
            raise AssertionError("any URDF can have a second root")
        left = [*(other for other in left if other is not fault), fault]  # it is the last to be used again
        yield Drawn(
            version=query.version,
            valid=False,
            files={**files, fault.file: faulty.text},
            error=fault.name,
            code=fault.code,
            place=CasePlace(file=fault.file, line=faulty.line, column=faulty.column),
            fix=fault.fix,
        )


if __name__ == "__main__":
    values = [each.model_dump(mode="json", exclude_defaults=True) for each in draw(json.load(sys.stdin))]
    sys.stdout.write(json.dumps(values, ensure_ascii=False))
