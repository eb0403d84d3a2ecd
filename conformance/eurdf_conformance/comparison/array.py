"""Compares numbers within a tolerance, and names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.comparison.half_turn import Matrix
from eurdf_conformance.json_pointer import step

#: EU-PRO-008, EU-PRO-009: of lengths relative to the size of the robot, of M to its largest entry.
TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True)
class Near:
    """EU-PRO-008: tolerances of numbers.

    Attributes:
        length: Positions, and the rows of residuals and K that are of a position, m.
        angle: Rotations, and the rows that are of one, rad.
    """

    length: float
    angle: float

    @classmethod
    def of(cls, size: float, tolerance: float = TOLERANCE) -> Near:
        """The tolerances for a robot whose frames are at most ``size`` apart, m."""
        return cls(tolerance * max(1.0, size), tolerance)

    def rows(self, count: int) -> Matrix:
        """The tolerance of each row of a closure: three position rows, then the rotation rows."""
        return np.array([self.length] * min(count, 3) + [self.angle] * max(count - 3, 0))


def agree(expected: Matrix, given: Matrix, near: float | Matrix) -> bool:
    """Whether two arrays of one shape agree within a tolerance, which is one number or one per entry."""
    return bool((np.abs(expected - given) <= near).all())


def worst(expected: Matrix, given: Matrix, near: float | Matrix) -> tuple[int, str]:
    """Flat index and excess of the entry that is farthest beyond the tolerance."""
    off = np.abs(expected - given)
    allowed = np.broadcast_to(np.asarray(near, dtype=float), off.shape)
    index = int(np.argmax(off - allowed))
    return index, f"off by {off.flat[index]:.3g}, allowed {allowed.flat[index]:.1e}"


def array_differences(expected: Any, given: Any, near: float | Matrix, pointer: str, why: str) -> Iterator[Difference]:
    """One difference if arrays do not agree within ``near``, or differ in shape."""
    one, other = np.array(expected, dtype=float), np.array(given, dtype=float)
    if one.shape != other.shape:
        yield Difference(pointer, expected, given, f"{why}: number of entries")
    elif not agree(one, other, near):
        yield Difference(pointer, expected, given, f"{why}, {worst(one, other, near)[1]}")


def name_differences(
    expected: Mapping[str, Any], given: Mapping[str, Any], pointer: str, kind: str
) -> Iterator[Difference]:
    """The names that only one of two mappings has."""
    for name in expected:
        if name not in given:
            yield Difference(pointer, expected[name], ABSENT, f"{kind} '{name}' is missing")
    for name in given:
        if name not in expected:
            yield Difference(pointer + step(name), ABSENT, given[name], f"{kind} '{name}' was not requested")


def both(expected: Mapping[str, Any], given: Mapping[str, Any]) -> list[str]:
    """The names that both mappings have, in the order of the first."""
    return [name for name in expected if name in given]
