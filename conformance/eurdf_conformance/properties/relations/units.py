"""Another unit of length or of mass: each number is multiplied by a power of the factor that its unit gives."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.level import Level, Version
from eurdf_conformance.properties.conditioning import is_length
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.pair import Pair, related
from eurdf_conformance.properties.property import Property
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.relations.scaling import lengthened, weighted
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Jacobian, MassMatrix, Values


def length_unit(example: Example, version: Version) -> Pair:
    """A robot, and the same with all lengths multiplied by a factor."""
    mechanism, s = example.mechanism, example.chance.one_of([0.25, 0.7, 3.0])
    robot = truth(mechanism, version)
    # A column of what slides means as much more, in the unit of those that turn.
    D = np.array([1.0 if is_length(robot, column) else s for column in robot.velocities])

    def carry(values: Values, index: int) -> Values:
        changed: dict[str, object] = {}
        if values.poses is not None:
            changed["poses"] = {
                name: pose.model_copy(update={"translation": [s * x for x in pose.translation]})
                for name, pose in values.poses.items()
            }
        if values.residuals is not None:
            changed["residuals"] = {
                name: [s * x if i < 3 else x for i, x in enumerate(r)] for name, r in values.residuals.items()
            }
        if (K := values.jacobian) is not None:
            rows = {
                name: [(np.array(row) * D * (1.0 if i < 3 else 1.0 / s)).tolist() for i, row in enumerate(rows)]
                for name, rows in K.rows.items()
            }
            changed["jacobian"] = Jacobian(columns=K.columns, rows=rows)
        if (M := values.mass_matrix) is not None:
            matrix = np.array(M.matrix).reshape(len(D), len(D)) * D[:, None] * D
            changed["mass_matrix"] = MassMatrix(columns=M.columns, matrix=matrix.tolist())
        if values.center_of_mass is not None:
            changed["center_of_mass"] = [s * x for x in values.center_of_mass]
        return values.model_copy(update=changed)

    return Pair(query_of(mechanism, version), query_of(lengthened(mechanism, s), version), carry)


def mass_unit(example: Example, version: Version) -> Pair:
    """A robot, and the same with all masses multiplied by a factor."""
    mechanism, s = example.mechanism, example.chance.one_of([0.25, 0.7, 1.9])

    def carry(values: Values, index: int) -> Values:
        changed: dict[str, object] = {}
        if values.mass is not None:
            changed["mass"] = s * values.mass
        if (M := values.mass_matrix) is not None:
            matrix = [[s * x for x in row] for row in M.matrix]
            changed["mass_matrix"] = MassMatrix(columns=M.columns, matrix=matrix)
        return values.model_copy(update=changed)

    return Pair(query_of(mechanism, version), query_of(weighted(mechanism, s), version), carry)


PROPERTIES = (
    Property(
        "length-unit",
        "Another unit of length scales every number as its unit requires.",
        ("EU-JNT-018", "EU-JNT-025", "EU-CLO-008", "EU-CLO-009", "EU-CLO-010", "EU-INR-006", "EU-JNT-026"),
        (Level.KINEMATICS, Level.DYNAMICS),
        related(length_unit),
    ),
    Property(
        "mass-unit",
        "Another unit of mass scales only M and the mass.",
        ("EU-INR-006", "EU-INR-005", "EU-ACT-006"),
        (Level.DYNAMICS,),
        related(mass_unit),
    ),
)
