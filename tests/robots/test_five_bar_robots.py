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


def test_dextar_has_its_tip_at_one_point_in_four_working_modes() -> None:
    robot = eurdf.load("dextar", geometry=False)
    found = {}
    for name in ("assembled", "elbows_in", "elbows_left", "elbows_right"):
        q = robot.configurations[name]
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        pin.framesForwardKinematics(robot.model, robot.data, q)
        tip = robot.data.oMf[robot.model.getFrameId("tool_tip")].translation
        np.testing.assert_allclose(tip, (0.0, 0.12, 0.05), atol=1e-12)
        links = (robot.data.oMf[robot.model.getFrameId(f"distal_{leg}")].rotation for leg in (1, 2))
        found[name] = tuple(round(float(np.arctan2(R[1, 0], R[0, 0])), 6) for R in links)
    assert found["elbows_left"] == (found["assembled"][0], found["elbows_in"][1])
    assert found["elbows_right"] == (found["elbows_in"][0], found["assembled"][1])
    assert len(set(found.values())) == 4
