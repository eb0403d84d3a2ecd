"""Five-bar robots: their named configurations against plane geometry."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import eurdf


@pytest.mark.parametrize(
    ("name", "length", "swing"),
    [
        ("assembled", 0.17, 0.0),
        ("retracted", 0.08, 0.0),
        ("extended", 0.25, 0.0),
        ("step", 0.17, 0.4),
        ("upside_down", 0.17, np.pi),
    ],
)
def test_foot_of_doggo_is_where_its_page_says(name: str, length: float, swing: float) -> None:
    robot = eurdf.load("doggo_leg", geometry=False)
    q = robot.configurations[name]
    assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
    pin.framesForwardKinematics(robot.model, robot.data, q)
    foot = robot.data.oMf[robot.model.getFrameId("foot")].translation
    np.testing.assert_allclose(foot, length * np.array([np.sin(swing), 0.0, -np.cos(swing)]), atol=1e-12)
