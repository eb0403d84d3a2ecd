"""Compares JSON values; numbers may differ by rounding."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from eurdf_conformance.comparison.difference import ABSENT, Difference, plain
from eurdf_conformance.json_pointer import step

#: EU-CAN-005: numbers are the same within this, relative to the expected one where that is above 1.
TOLERANCE = 1e-9


def same_number(expected: float, given: float) -> bool:
    """EU-CAN-005: whether |given − expected| ≤ 1e-9 · max(1, |expected|)."""
    if expected == given:
        return True
    try:
        return abs(given - expected) <= TOLERANCE * max(1.0, abs(expected))
    except OverflowError:  # an integer beyond the range of a double
        return False


def value_differences(expected: Any, given: Any, pointer: str, why: str) -> Iterator[Difference]:
    """Differences between two JSON values, or parts of messages.

    Args:
        expected: What it should be.
        given: What it is.
        pointer: Where ``given`` is in the answer.
        why: What it is, in words.
    """
    yield from _differences(plain(expected), plain(given), pointer, why)


def _differences(expected: Any, given: Any, pointer: str, why: str) -> Iterator[Difference]:
    if isinstance(expected, dict) and isinstance(given, dict):
        for key in dict.fromkeys((*expected, *given)):
            one, other = expected.get(key, ABSENT), given.get(key, ABSENT)
            yield from _differences(one, other, pointer + step(key), f"{why}, {key}")
    elif isinstance(expected, list) and isinstance(given, list) and len(expected) == len(given):
        for index, (one, other) in enumerate(zip(expected, given, strict=True)):
            yield from _differences(one, other, pointer + step(index), why)
    elif not _same_scalar(expected, given):
        yield Difference(pointer, expected, given, why)


def _same_scalar(expected: Any, given: Any) -> bool:
    if _is_number(expected) and _is_number(given):
        return same_number(expected, given)
    return type(expected) is type(given) and bool(expected == given)


def _is_number(value: Any) -> bool:
    # In JSON, 1 and 1.0 are one number, and true is none.
    if isinstance(value, float):
        return not math.isnan(value)
    return isinstance(value, int) and not isinstance(value, bool)
