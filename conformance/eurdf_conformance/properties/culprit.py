"""Finds, among the robots of a failed property, the one that the parser gets wrong."""

from __future__ import annotations

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.level import Level
from eurdf_conformance.level_spec import LEVELS, Compared
from eurdf_conformance.properties.harness import Harness, NotAnswered
from eurdf_conformance.properties.query import Query
from eurdf_conformance.properties.shape import WrongShape
from eurdf_conformance.properties.truth import truth


def culprit(harness: Harness, level: Level) -> Query:
    """The first robot on which the parser differs from the oracle, at a level; the last robot if there is none."""
    queries = [each for each, _ in harness.queries]
    return next((each for each in queries if is_wrong(harness, each, level)), queries[-1])


def is_wrong(harness: Harness, query: Query, level: Level) -> bool:
    """Whether the parser differs from the oracle on a robot."""
    robot = truth(query.mechanism, query.version)
    try:
        read = harness.read(query)
        if LEVELS[level].compared is Compared.ROBOT:
            return read is None or bool(canonical_differences(robot.canonical(), read, robot.bodies))
        quantities = LEVELS[level].quantities
        given = harness.evaluate(query, quantities) if quantities else []
    except (NotAnswered, WrongShape):
        return True
    return any(
        values_differences(robot.evaluate(q, query.frames, quantities), values, robot.size(q))
        for q, values in zip(query.configurations, given, strict=False)
    )
