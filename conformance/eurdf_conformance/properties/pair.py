"""A metamorphic relation: the parser's answers on one robot determine its answers on another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.level import Level, Version
from eurdf_conformance.level_spec import LEVELS, Compared
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.property import Check
from eurdf_conformance.properties.query import Query
from eurdf_conformance.properties.same_values import same_values
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import CanonicalRobot, Values


def unchanged(values: Values, index: int) -> Values:
    """The values of both robots are equal."""
    return values


def unchanged_robot(robot: CanonicalRobot) -> CanonicalRobot:
    """The canonical descriptions of both robots are equal."""
    return robot


@dataclass(frozen=True)
class Pair:
    """Two robots of a relation.

    Attributes:
        one: The first.
        other: The second, evaluated at as many configurations.
        carry: From the values of the first, at a configuration of some index, to what follows for the second.
        seen: From the values of the second, at that configuration, to the part of them that follows.
        carry_robot: From what was read of the first to what is to be read of the second.
    """

    one: Query
    other: Query
    carry: Callable[[Values, int], Values] = unchanged
    seen: Callable[[Values, int], Values] = unchanged
    carry_robot: Callable[[CanonicalRobot], CanonicalRobot] = unchanged_robot


def related(pair_of: Callable[[Example, Version], Pair]) -> Check:
    """The check of a relation."""

    def check(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
        pair = pair_of(example, version)
        if LEVELS[level].compared is Compared.ROBOT:
            return _read_differences(harness, pair)
        return _value_differences(harness, pair, level)

    return check


def _read_differences(harness: Harness, pair: Pair) -> list[Difference]:
    one, other = harness.read(pair.one), harness.read(pair.other)
    if one is None or other is None:
        return [Difference("/robot", "a canonical description", ABSENT, "level structure requires it")]
    bodies = truth(pair.other.mechanism, pair.other.version).bodies
    return [each.within("/robot") for each in canonical_differences(pair.carry_robot(one), other, bodies)]


def _value_differences(harness: Harness, pair: Pair, level: Level) -> list[Difference]:
    before = harness.evaluate(pair.one, LEVELS[level].quantities)
    after = harness.evaluate(pair.other, LEVELS[level].quantities)
    robot = truth(pair.one.mechanism, pair.one.version)
    found = []
    for index, (one, other, q) in enumerate(zip(before, after, pair.one.configurations, strict=True)):
        found += same_values(pair.carry(one, index), pair.seen(other, index), robot.size(q), f"/values/{index}")
    return found
