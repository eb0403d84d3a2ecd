"""ToddlerBot's gears, differential and parallelograms."""

from __future__ import annotations

import numpy as np
import pytest

import eurdf


def test_motors_turn_joints_by_the_published_ratios() -> None:
    robot = eurdf.load("toddlerbot_2legs", root="fixed", geometry=False)
    random = np.random.default_rng(7)
    for _ in range(3):
        motors = {name: random.uniform(-0.5, 0.5) for name in robot.actuation.joints}
        motors |= {f"{side}_knee_act": random.uniform(-1.9, -0.1) for side in ("left", "right")}
        q = eurdf.forward_kinematics(robot, motors)
        at = {name: values[0] for name, values in robot.joint_positions(q).items()}
        # Ratios of config.json and toddlerbot.xml of hshi74/toddlerbot 62cee1b.
        one, two = motors["waist_act_1"], motors["waist_act_2"]
        expected = {
            "neck_yaw_driven": -0.909091 * motors["neck_yaw_drive"],
            "neck_pitch": motors["neck_pitch_act"],
            "waist_roll": -0.29166667 * (one - two),
            "waist_yaw": 0.20833333 * (one + two),
        }
        for side in ("left", "right"):
            expected[f"{side}_hip_yaw_driven"] = -0.857143 * motors[f"{side}_hip_yaw_drive"]
            expected[f"{side}_knee"] = motors[f"{side}_knee_act"]
        assert {name: at[name] for name in expected} == pytest.approx(expected, abs=1e-6)


def test_home_is_closed() -> None:
    robot = eurdf.load("toddlerbot_2legs", geometry=False)
    assert eurdf.analyze(robot, robot.configurations["home"]).residual < 1e-9
