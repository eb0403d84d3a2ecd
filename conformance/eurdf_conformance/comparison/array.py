"""Numbers against numbers, within a distance, and names against names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from eurdf_conformance.comparison.difference import ABSENT, Difference, step
from eurdf_conformance.comparison.half_turn import Matrix

#: EU-PRO-008, EU-PRO-009: relative to the size of the robot, or to the largest entry.
TOLERANCE = 1e-8


def agree(expected: Matrix, given: Matrix, near: float) -> bool:
    """Whether two arrays of one shape are the same within a distance."""
    return bool(np.all(np.abs(expected - given) <= near))


def worst(expected: Matrix, given: Matrix) -> float:
    """The largest distance of two entries."""
    return float(np.abs(expected - given).max(initial=0.0))


def array_differences(expected: Any, given: Any, near: float, pointer: str, why: str) -> Iterator[Difference]:
    """One difference, where numbers are not the same within a distance ``near``, or not as many."""
    one, other = np.array(expected, dtype=float), np.array(given, dtype=float)
    if one.shape != other.shape:
        yield Difference(pointer, expected, given, f"{why}: how many numbers")
    elif not agree(one, other, near):
        yield Difference(pointer, expected, given, f"{why}, off by {worst(one, other):.3g}, allowed {near:.1e}")


def name_differences(
    expected: Mapping[str, Any], given: Mapping[str, Any], pointer: str, kind: str
) -> Iterator[Difference]:
    """The names that one of two mappings lacks."""
    for name in expected:
        if name not in given:
            yield Difference(pointer, expected[name], ABSENT, f"{kind} '{name}' is missing")
    for name in given:
        if name not in expected:
            yield Difference(pointer + step(name), ABSENT, given[name], f"no {kind} '{name}' was asked for")


def both(expected: Mapping[str, Any], given: Mapping[str, Any]) -> list[str]:
    """The names that both have, in the order of the first."""
    return [name for name in expected if name in given]
