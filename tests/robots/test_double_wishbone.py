"""The corner of a car: what its springs decide, and how the wheel moves."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import eurdf


def test_wheel_leans_and_steers_as_the_page_says() -> None:
    robot = eurdf.load("double_wishbone", geometry=False)
    wheel, drawn = robot.model.getFrameId("wheel_center"), 0.31
    for name, up, lean, turn in (("bump", 105, 4.1, -1.0), ("droop", -106, -1.9, 0.4), ("left_turn", -4, -2.7, 31.8)):
        q = robot.configurations[name]
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        pin.framesForwardKinematics(robot.model, robot.data, q)
        pose = robot.data.oMf[wheel]
        R = pose.rotation
        assert (pose.translation[2] - drawn) * 1e3 == pytest.approx(up, abs=0.6)
        angles = np.degrees((np.arcsin(R[2, 1]), np.arctan2(R[1, 0], R[0, 0])))
        np.testing.assert_allclose(angles, (lean, turn), atol=0.06)


def test_hanging_wheel_drops_until_the_spring_is_at_rest() -> None:
    robot = eurdf.load("double_wishbone", geometry=False)
    q = eurdf.forward_kinematics(robot, {"motor_rack": 0.0})
    assert robot.joint_positions(q)["spring_strut"] == pytest.approx((0.075,))
    assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
