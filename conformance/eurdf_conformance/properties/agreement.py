"""Agreement with the oracle, and what follows from the files alone."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.comparison.array import TOLERANCE, array_differences
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.comparison.difference import ABSENT, Difference
from eurdf_conformance.comparison.values import values_differences
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.level_spec import LEVELS, Compared
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Quantity


def accepted(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """EU-CNF-002, EU-CLO-011: the parser accepts valid files, with or without redundant rows."""
    harness.load(query_of(example.mechanism, version))
    return []


def agreement(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """The parser's answers agree with the oracle's."""
    query, robot = query_of(example.mechanism, version), truth(example.mechanism, version)
    if LEVELS[level].compared is Compared.ROBOT:
        read = harness.read(query)
        if read is None:
            return [Difference("/robot", "a canonical description", ABSENT, "level structure requires it")]
        return [each.within("/robot") for each in canonical_differences(robot.canonical(), read, robot.bodies)]
    quantities, found = LEVELS[level].quantities, []
    for index, (q, given) in enumerate(zip(query.configurations, harness.evaluate(query, quantities), strict=True)):
        expected = robot.evaluate(q, query.frames, quantities)
        found += [each.within(f"/values/{index}") for each in values_differences(expected, given, robot.size(q))]
    return found


def columns(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """EU-PRO-007. Reading the answer checks that each velocity is named once."""
    quantity: Quantity = "jacobian" if level is Level.KINEMATICS else "mass_matrix"
    harness.evaluate(query_of(example.mechanism, version), (quantity,))
    return []


def inertia(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """EU-INR-005, EU-INR-006: the mass is that of all links, and each motion has kinetic energy.

    The examples are such that rounding cannot decide.
    """
    query = query_of(example.mechanism, version)
    found: list[Difference] = []
    mass = sum(link.inertia.mass for link in example.mechanism.links if link.inertia)
    for index, values in enumerate(harness.evaluate(query, ("mass_matrix", "mass"))):
        pointer = f"/values/{index}"
        why = "mass of all links of the file, kg"
        found += array_differences(mass, values.mass, TOLERANCE * mass, f"{pointer}/mass", why)
        assert values.mass_matrix is not None
        M = np.array(values.mass_matrix.matrix)
        if not M.size:
            continue
        where, largest = f"{pointer}/mass_matrix/matrix", float(np.abs(M).max())
        found += array_differences(M.T.tolist(), M.tolist(), 2.0 * TOLERANCE * largest, where, "M and its transpose")
        least = float(np.linalg.eigvalsh((M + M.T) / 2.0)[0])
        if least <= 0.0:
            found.append(Difference(where, "more than 0", least, "the smallest eigenvalue of M"))
    return found


PROPERTIES = (
    Property(
        "accepted",
        "A valid mechanism is accepted.",
        ("EU-CNF-002", "EU-PRO-004"),
        (Level.ACCEPT,),
        accepted,
        versions=VERSIONS,
    ),
    Property(
        "structure-agreement",
        "The canonical description is that of the mechanism from which the files were written.",
        (
            *("EU-CAN-001", "EU-CAN-002", "EU-ACT-006"),
            *("EU-JNT-020", "EU-JNT-021", "EU-JNT-024", "EU-JNT-027", "EU-JNT-029"),
            *("EU-CLO-021", "EU-JNT-031", "EU-JNT-034", "EU-ACT-010"),
            *("EU-ACT-007", "EU-CFG-005", "EU-EXT-002", "EU-VER-004"),
            *("EU-ONE-004", "EU-ONE-005", "EU-ONE-006", "EU-ONE-007"),
        ),
        (Level.STRUCTURE,),
        agreement,
        versions=VERSIONS,
    ),
    Property(
        "agreement",
        "Poses, residuals and K agree with a second implementation of the specification.",
        (
            *("EU-PRO-008", "EU-JNT-025", "EU-JNT-026", "EU-FRM-004", "EU-FRM-005", "EU-FRM-006"),
            *("EU-CLO-014", "EU-CLO-015", "EU-CPL-005"),
            *("EU-CLO-008", "EU-CLO-009", "EU-CLO-010", "EU-URD-032", "EU-URD-035", "EU-JNT-015"),
            *("EU-JNT-016", "EU-JNT-017", "EU-JNT-018", "EU-JNT-019", "EU-JNT-022", "EU-JNT-023"),
        ),
        (Level.KINEMATICS,),
        agreement,
        versions=VERSIONS,
    ),
    Property(
        "inertia-agreement",
        "M, mass and centre of mass agree with a second implementation of the specification.",
        ("EU-INR-006", "EU-INR-005", "EU-PRO-009", "EU-JNT-026", "EU-JNT-032"),
        (Level.DYNAMICS,),
        agreement,
        versions=VERSIONS,
    ),
    Property(
        "columns",
        "Every velocity of the mechanism is exactly one column.",
        ("EU-PRO-007",),
        (Level.KINEMATICS, Level.DYNAMICS),
        columns,
        versions=VERSIONS,
    ),
    Property(
        "inertia",
        "The mass is the sum over all links, and M is symmetric and positive definite.",
        ("EU-INR-005", "EU-INR-006"),
        (Level.DYNAMICS,),
        inertia,
        versions=VERSIONS,
    ),
)
