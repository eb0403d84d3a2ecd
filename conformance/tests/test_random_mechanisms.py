"""The reference and the oracle, which share no code, on a thousand random mechanisms."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings

from eurdf_conformance.adapters.reference import PARSER
from eurdf_conformance.comparison.canonical import canonical_differences
from eurdf_conformance.level import Level, Version
from eurdf_conformance.level_spec import LEVELS
from eurdf_conformance.properties.harness import Harness
from eurdf_conformance.properties.mechanism import Mechanism
from eurdf_conformance.properties.query import query_of
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from eurdf_conformance.properties.truth import truth
from eurdf_conformance.protocol.message import Values
from eurdf_conformance.runner.in_process import InProcess

#: Relative to the size of the robot; of M, of the mass and of its centre, to the largest there is.
NEAR = 1e-9


@pytest.mark.parametrize(
    ("version", "closures", "count"),
    [
        ("1", 1, 25),
        ("2", 1, 25),
        pytest.param("1", 1, 50, marks=pytest.mark.slow),
        pytest.param("2", 0, 60, marks=pytest.mark.slow),
        pytest.param("2", 1, 75, marks=pytest.mark.slow),
    ],
)
def test_mechanisms_agree_within_a_billionth_of_their_size(
    version: Version, closures: int, count: int, tmp_path: Path
) -> None:
    harness = Harness(InProcess(PARSER), tmp_path)
    tried = []

    @settings(
        max_examples=count,
        derandomize=True,
        database=None,
        deadline=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(mechanisms(version, closures))
    def agree(mechanism: Mechanism) -> None:
        tried.append(mechanism)
        asked, robot = query_of(mechanism, version), truth(mechanism, version)
        harness.begin()
        read = harness.read(asked)
        assert read is not None
        assert canonical_differences(robot.canonical(), read, robot.bodies) == []
        quantities = (*LEVELS[Level.KINEMATICS].quantities, *LEVELS[Level.DYNAMICS].quantities)
        for q, given_values in zip(asked.configurations, harness.evaluate(asked, quantities), strict=True):
            expected = robot.evaluate(q, asked.frames, quantities)
            assert_close(expected, given_values, max(1.0, robot.size(q)))

    agree()
    assert len(tried) == count


def assert_close(expected: Values, given: Values, size: float) -> None:
    one, other = expected.model_dump(exclude_none=True), given.model_dump(exclude_none=True)
    for quantity in ("poses", "residuals", "jacobian", "center_of_mass"):
        assert worst(one.get(quantity), other.get(quantity)) <= NEAR * size, quantity
    M = np.array(one["mass_matrix"]["matrix"])
    assert worst(one["mass_matrix"], other["mass_matrix"]) <= NEAR * np.abs(M).max(initial=0.0)
    assert one["mass"] == pytest.approx(other["mass"], rel=NEAR)


def worst(one: Any, other: Any) -> float:
    """The largest distance of two numbers at the same place; what is no number has to be the same."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        return max((worst(value, other[key]) for key, value in one.items()), default=0.0)
    if isinstance(one, list | tuple) and one and not isinstance(one[0], float):
        assert len(one) == len(other)
        return max(map(worst, one, other))
    if isinstance(one, list):
        assert len(one) == len(other)
        return float(np.abs(np.subtract(one, other)).max(initial=0.0))
    assert one == other
    return 0.0
