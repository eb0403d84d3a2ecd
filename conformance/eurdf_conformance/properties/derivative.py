"""K against finite differences of the parser's own residuals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eurdf_conformance.comparison.array import TOLERANCE, array_differences
from eurdf_conformance.comparison.difference import Difference
from eurdf_conformance.json_pointer import step
from eurdf_conformance.level import VERSIONS, Level, Version
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.property import Property, closed
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.truth import truth

#: rad or m.
_STEP = 1e-2

#: Weights of r(q ⊕ k h v) in h dr/dt; what is left out is of the order h⁷.
_WEIGHTS = {-3: -1 / 60, -2: 9 / 60, -1: -45 / 60, 1: 45 / 60, 2: -9 / 60, 3: 1 / 60}


def derivative(harness: Harness, example: Example, version: Version, level: Level) -> list[Difference]:
    """EU-CLO-010: K v = d/dt r(q ⊕ t v) at t = 0, for each velocity, at each configuration."""
    query, robot = query_of(example.mechanism, version, frames=[]), truth(example.mechanism, version)
    found: list[Difference] = []
    for index, values in enumerate(harness.evaluate(query, ("jacobian",))):
        q = query.configurations[index]
        nv = len(robot.velocities)
        moved = [robot.moved(q, steps * _STEP * v) for v in np.eye(nv) for steps in _WEIGHTS]
        around = harness.evaluate(replace(query, configurations=moved), ("residuals",))
        size = max(1.0, robot.size(q))
        # The residuals may each be off by EU-PRO-008; the weights of all come to less than 2.
        near = size * (2.0 * TOLERANCE / _STEP + 1e-7)
        assert values.jacobian is not None
        for name, rows in values.jacobian.rows.items():
            r = np.array([each.residuals[name] for each in around if each.residuals is not None])
            r = r.reshape(nv, len(_WEIGHTS), len(rows))
            expected = np.einsum("vsr,s->rv", r, np.array(list(_WEIGHTS.values()))) / _STEP
            where = f"/values/{index}/jacobian/rows{step(name)}"
            why = f"rows of K of closure '{name}', and differences of its residual"
            found += array_differences(expected.tolist(), rows, near, where, why)
    return found


PROPERTIES = (
    Property(
        "derivative",
        "K is the derivative of the residuals along each velocity.",
        ("EU-CLO-010", "EU-JNT-026"),
        (Level.KINEMATICS,),
        derivative,
        versions=VERSIONS,
        applies=closed,
        closures=1,
    ),
)
