"""What the actuators allow at passive joints, one joint at a time."""

from __future__ import annotations

import math
from types import MappingProxyType

import numpy as np
import pytest

import eurdf
from eurdf.mechanism.mechanism import Motor
from eurdf.transmissions.passive_limits import PassiveLimit, passive_limits
from support.transmissions import DRIVEN, posed, slider_crank, with_properties


def test_limits_of_one_joint_are_those_of_the_polytopes() -> None:
    """The fastest joint is at a vertex of the velocities, and the torque at one joint is on an axis of the torques."""
    whole, q = posed("unitree_g1_ankle")
    motors = MappingProxyType({"motor_a": Motor("a", (-10.0, 4.0))})
    robot = with_properties(whole, {}, version="2.1", motors=motors)
    found = {each.name: each for each in passive_limits(robot, q)}
    limits = eurdf.transmissions.serial_limits(robot, DRIVEN["unitree_g1_ankle"], q)
    assert isinstance(limits, eurdf.transmissions.SerialLimits)
    for index, joint in enumerate(limits.joints):
        assert found[joint].velocity == pytest.approx(limits.velocity.vertices[:, index].max(), rel=1e-9)
        assert found[joint].torque == pytest.approx(limits.torque_axes[index], rel=1e-9)


def test_limits_of_a_slider_crank_have_a_closed_form() -> None:
    """The slider moves at b = dx/dθ times the velocity of the crank, and feels 1/b times its torque."""
    crank, rod, angle = 0.3, 0.8, 0.7
    robot, q = slider_crank(crank, rod, angle)
    tilt = math.asin(crank * math.sin(angle) / rod)
    b = crank * (math.sin(angle) + math.cos(angle) * math.tan(tilt))
    slide = next(each for each in passive_limits(robot, q) if each.name == "slide")
    assert slide == PassiveLimit("slide", "m", pytest.approx(3.0 * b), pytest.approx((-10.0 / b, 10.0 / b)))

    without = with_properties(robot, {"motor": {"velocity": (), "effort": ()}})
    unlimited = next(each for each in passive_limits(without, q) if each.name == "slide")
    assert (unlimited.velocity, unlimited.torque) == (np.inf, (-np.inf, np.inf))
    both = with_properties(robot, {}, actuators=("motor", "slide"))
    with pytest.raises(eurdf.errors.NoTransmission, match="only 1 of 2 actuator velocities are independent"):
        passive_limits(both, q)
