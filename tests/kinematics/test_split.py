"""Configurations and velocities in two parts: what the motors move, and the rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.kinematics.split import merge_configuration, merge_velocity, split_configuration, split_velocity
from support.actuated import actuated, robot_called
from support.linkage import Linkage


def mixed() -> Any:
    """A chain of all widths of coordinates, whose motors are not in the model's order."""
    model, parent = pin.Model(), 0
    for name, joint in {
        "hinge": pin.JointModelRZ(),
        "ball": pin.JointModelSpherical(),
        "wheel": pin.JointModelRUBX(),
        "slide": pin.JointModelPX(),
        "table": pin.JointModelPlanar(),
    }.items():
        parent = model.addJoint(parent, joint, pin.SE3.Identity(), name)
    return actuated(Linkage(model), ["slide", "ball", "hinge"])


BUILD = {"digit_leg": lambda: robot_called("digit_leg"), "four_bar": lambda: robot_called("four_bar"), "mixed": mixed}


@pytest.mark.parametrize("name", BUILD)
@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=10, deadline=None)
def test_merge_inverts_split(name: str, seed: int) -> None:
    robot, random = BUILD[name](), np.random.default_rng(seed)
    q, v = random.normal(size=robot.model.nq), random.normal(size=robot.model.nv)
    np.testing.assert_array_equal(merge_configuration(robot, *split_configuration(robot, q)), q)
    np.testing.assert_array_equal(merge_velocity(robot, *split_velocity(robot, v)), v)
    v_actuated, v_free = split_velocity(robot, v)
    np.testing.assert_array_equal(v_actuated, robot.actuation.selection.T @ v)
    again_actuated, again_free = split_velocity(robot, merge_velocity(robot, v_actuated, v_free))
    np.testing.assert_array_equal(again_actuated, v_actuated)
    np.testing.assert_array_equal(again_free, v_free)


def test_motors_are_in_file_order_others_in_model_order() -> None:
    robot = mixed()
    # In q: hinge 0, ball 1-4, wheel 5-6, slide 7, table 8-11; in v: hinge 0, ball 1-3, wheel 4, slide 5, table 6-8.
    q_actuated, q_free = split_configuration(robot, np.arange(12.0))
    np.testing.assert_array_equal(q_actuated, [7, 1, 2, 3, 4, 0])
    np.testing.assert_array_equal(q_free, [5, 6, 8, 9, 10, 11])
    v_actuated, v_free = split_velocity(robot, np.arange(9.0))
    np.testing.assert_array_equal(v_actuated, [5, 1, 2, 3, 0])
    np.testing.assert_array_equal(v_free, [4, 6, 7, 8])


def test_split_returns_copies() -> None:
    robot, q = robot_called("four_bar"), np.arange(5.0)
    q_actuated, q_free = split_configuration(robot, q)
    q_actuated[:], q_free[:] = -1.0, -1.0
    np.testing.assert_array_equal(q, np.arange(5.0))


def test_robot_without_motors_is_all_free() -> None:
    robot = actuated(Linkage(mixed().model), [])
    q_actuated, q_free = split_configuration(robot, np.arange(12.0))
    assert q_actuated.shape == (0,)
    np.testing.assert_array_equal(q_free, np.arange(12.0))
