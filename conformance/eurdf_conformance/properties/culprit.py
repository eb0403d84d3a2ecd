"""Of the robots that a reader was asked about, the one that it is wrong about."""

from __future__ import annotations

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.level import Level
from eurdf_conformance.properties.asked import Asked
from eurdf_conformance.properties.bench import QUANTITIES, Bench, NotAnswered
from eurdf_conformance.properties.shape import WrongShape
from eurdf_conformance.properties.truth import truth


def culprit(bench: Bench, level: Level) -> Asked:
    """The first of which the reader does not say what the oracle says, at a level; if there is none, the last."""
    asked = [each for each, _ in bench.asked]
    return next((each for each in asked if is_wrong(bench, each, level)), asked[-1])


def is_wrong(bench: Bench, asked: Asked, level: Level) -> bool:
    """Whether a reader does not say of a robot what the oracle says."""
    robot = truth(asked.mechanism, asked.version)
    try:
        read = bench.read(asked)
        if level is Level.STRUCTURE:
            return read is None or bool(canonical_differences(robot.canonical(), read, robot.bodies))
        quantities = QUANTITIES.get(level, ())
        given = bench.evaluate(asked, quantities) if quantities else []
    except (NotAnswered, WrongShape):
        return True
    return any(
        values_differences(robot.evaluate(q, asked.frames, quantities), values, robot.size(q))
        for q, values in zip(asked.configurations, given, strict=False)
    )
