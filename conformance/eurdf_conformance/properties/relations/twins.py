"""A mechanism that both versions can express, in either version."""

from __future__ import annotations

from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.level import Level, Version
from eurdf_conformance.level_spec import LEVELS, Compared
from eurdf_conformance.properties.document import names1
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.harness import Harness, NotAnswered
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import Query, query_of
from eurdf_conformance.properties.same_values import same_values
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import CanonicalRobot, Jacobian, MassMatrix, Values


def twins(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """The answers on a description of version 2 equal those on a description of version 1.

    Who does not read version 2 is compared with the oracle's reading of it.
    """
    mechanism = example.mechanism
    one, other = query_of(mechanism, "2"), query_of(mechanism, "1")
    robot = truth(mechanism, "2")
    if LEVELS[level].compared is Compared.ROBOT:
        expected, given = read2(harness, one), harness.read(other)
        if given is None:
            return [Difference("/robot", "a canonical description", ABSENT, "level structure requires it")]
        differences = canonical_differences(robot_of_version1(expected), given, robot.bodies)
        return [each.within("/robot") for each in differences]
    before, after = evaluate2(harness, one, level), harness.evaluate(other, LEVELS[level].quantities)
    found = []
    for index, (values, given_values, q) in enumerate(zip(before, after, one.configurations, strict=True)):
        carried = values_of_version1(values, mechanism)
        found += same_values(carried, given_values, robot.size(q), f"/values/{index}")
    return found


def read2(harness: Harness, query: Query) -> CanonicalRobot:
    """The parser's canonical description of version 2."""
    try:
        read = harness.read(query)
    except NotAnswered:
        read = None
    return read or truth(query.mechanism, "2").canonical()


def evaluate2(harness: Harness, query: Query, level: Level) -> list[Values]:
    """The parser's values for version 2."""
    try:
        return harness.evaluate(query, LEVELS[level].quantities)
    except NotAnswered:
        robot = truth(query.mechanism, "2")
        return [robot.evaluate(q, query.frames, LEVELS[level].quantities) for q in query.configurations]


def robot_of_version1(robot: CanonicalRobot) -> CanonicalRobot:
    """The same canonical description in version 1, whose files have no configurations."""
    return robot.model_copy(update={"version": "1", "configurations": {}})


def values_of_version1(values: Values, mechanism: Mechanism) -> Values:
    """The same values with two joints for each universal joint, as in version 1."""

    def column(name: str, i: int) -> tuple[str, int]:
        names = names1(mechanism, name)
        return (names[i], 0) if len(names) == 2 else (name, i)

    changed: dict[str, object] = {}
    if (K := values.jacobian) is not None:
        changed["jacobian"] = Jacobian(columns=[column(*each) for each in K.columns], rows=K.rows)
    if (M := values.mass_matrix) is not None:
        changed["mass_matrix"] = MassMatrix(columns=[column(*each) for each in M.columns], matrix=M.matrix)
    return values.model_copy(update=changed)


PROPERTIES = (
    Property(
        "versions",
        "A mechanism that both versions can express is the same in both.",
        ("EU-ONE-001", "EU-ONE-004", "EU-ONE-005", "EU-ONE-006", "EU-ONE-007", "EU-VER-002"),
        (Level.STRUCTURE, Level.KINEMATICS, Level.DYNAMICS),
        twins,
        versions=("1",),
    ),
)
