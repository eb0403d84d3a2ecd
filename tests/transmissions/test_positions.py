"""Positions of motors for positions of joints, and back."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import eurdf
from support.transmissions import DRIVEN, four_bar, posed, slider_crank


@pytest.mark.parametrize("name", DRIVEN)
def test_positions_go_both_ways(name: str) -> None:
    robot, q = posed(name, 3)
    at = robot.joint_positions(q)
    wanted = {joint: at[joint][0] for joint in DRIVEN[name]}
    found = eurdf.transmissions.actuator_values(robot, wanted)
    for motor, value in found.values.items():
        assert value == pytest.approx(at[motor][0], abs=1e-8)
    back = eurdf.transmissions.joint_values(robot, found.values, joints=DRIVEN[name])
    assert back.values == pytest.approx(wanted, abs=1e-8)
    assert back.beyond == found.beyond == ()
    # What the actuators decide is returned by default; other actuators stay where they are.
    every = eurdf.transmissions.joint_values(robot, found.values)
    assert every.values.keys() >= {joint for joint in DRIVEN[name] if joint not in robot.actuation.joints}
    first = robot.joint_positions(robot.configurations["assembled"])
    for other in set(robot.actuation.joints) - found.values.keys():
        assert robot.joint_positions(every.q)[other] == pytest.approx(first[other], abs=1e-12)


def test_positions_stay_on_the_branch() -> None:
    crank, rod = 0.05, 0.13
    for angle in (0.8, -0.8):
        robot, q = slider_crank(crank, rod, angle)
        x = 0.12
        found = eurdf.transmissions.actuator_values(robot, {"slide": x}, q)
        expected = math.copysign(math.acos((x * x + crank**2 - rod**2) / (2.0 * crank * x)), angle)
        assert found.values == {"motor": pytest.approx(expected, abs=1e-9)}


def test_values_out_of_reach_name_the_farthest() -> None:
    robot, q = slider_crank(0.05, 0.13, 0.8)
    with pytest.raises(eurdf.errors.OutOfReach, match=r"slide 0\.2: not reachable") as raised:
        eurdf.transmissions.actuator_values(robot, {"slide": 0.2}, q)
    assert raised.value.reached["slide"] == pytest.approx(0.18, abs=1e-3)  # crank and rod stretched
    assert raised.value.reached["slide"] <= 0.18 + 1e-9
    assert 0.0 < raised.value.part < 1.0
    robot, q = four_bar(0.4, 0.1, 0.35, 0.25, (1.0, 0.4, 1.7))
    with pytest.raises(eurdf.errors.OutOfReach, match="closures stay open"):
        eurdf.transmissions.actuator_values(robot, {"output": 3.1}, q)


def test_joints_beyond_their_limits_are_named() -> None:
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    found = eurdf.transmissions.actuator_values(robot, {"free_pitch": 0.53, "free_roll": 0.0})
    assert set(found.beyond) == {"free_pitch", "motor_b"}


@pytest.mark.parametrize(
    ("function", "values", "message"),
    [
        (
            eurdf.transmissions.actuator_values,
            {"free_pitch": np.nan, "free_roll": 0.0},
            "the value of 'free_pitch' is nan, not finite",
        ),
        (eurdf.transmissions.actuator_values, {"free_pitch": 0.1}, "add 'free_roll' to the joints"),
        (eurdf.transmissions.actuator_values, {"universal_rod_a": 0.1}, "has 2 coordinates"),
        (eurdf.transmissions.actuator_values, [-0.3, 0.1], "joints has no names; it must be a mapping of names"),
        (
            eurdf.transmissions.joint_values,
            {"free_pitch": 0.1},
            "'free_pitch' is not an actuated joint; these are: motor_a, motor_b",
        ),
    ],
)
def test_wrong_values_are_refused(function: Any, values: Any, message: str) -> None:
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    with pytest.raises(ValueError, match=message):
        function(robot, values)


def test_undecided_joint_is_refused() -> None:
    robot = eurdf.load("kangaroo_leg", geometry=False)
    assert (
        "free_hip_yaw_piston" not in eurdf.transmissions.joint_values(robot, {"motor_hip_yaw": 0.0}).values
    )  # the piston spins
    with pytest.raises(eurdf.errors.NoTransmission, match="'free_hip_yaw_piston' can move while the motors are still"):
        eurdf.transmissions.joint_values(robot, {"motor_hip_yaw": 0.0}, joints="free_hip_yaw_piston")
