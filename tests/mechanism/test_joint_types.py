"""The pose that coordinates give a joint is the one that Pinocchio's joint model gives it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.pinocchio.frames import placement_of
from eurdf.pinocchio.joint_model import joint_models
from support import by_hand

Z = (0.0, 0.0, 1.0)


@pytest.mark.parametrize("kind", by_hand.MOVING)
@given(seed=st.integers(0, 2**32 - 1))
@settings(deadline=None, max_examples=50)
def test_transform_matches_pinocchio_joint_model(kind: JointType, seed: int) -> None:
    random = np.random.default_rng(seed)
    joint = by_hand.some_joint(kind, random)
    if random.random() < 0.5:  # along coordinate axes, for which Pinocchio has models of their own
        axes = [tuple(np.roll(Z, turn).tolist()) for turn in random.permutation(3)]
        joint = replace(joint, axes=tuple(axes[: len(joint.axes)]))
    c = by_hand.some_coordinates(kind, random)
    model, last = pin.Model(), 0
    for part in joint_models(joint):
        last = model.addJoint(last, part, pin.SE3.Identity(), f"part {last}")
    angle_at_end = model.nq > len(c)
    data = model.createData()
    pin.forwardKinematics(model, data, np.array([*c[:-1], math.cos(c[-1]), math.sin(c[-1])] if angle_at_end else c))
    np.testing.assert_allclose(placement_of(joint.transform(c)).homogeneous, data.oMi[last].homogeneous, atol=1e-12)


@pytest.mark.parametrize("kind", JointType)
def test_neutral_transform_is_identity(kind: JointType) -> None:
    joint = by_hand.some_joint(kind, np.random.default_rng(0))
    assert joint.transform(joint.type.neutral) is IDENTITY


def test_axis_length_does_not_matter() -> None:
    for length in (1e-200, 1e-3, 1e200, 1.5e308):
        slider = Joint("slider", JointType.PRISMATIC, "base", "tip", axes=((0.0, 0.6 * length, -0.8 * length),))
        np.testing.assert_allclose(slider.transform((2.0,)).xyz, (0.0, 1.2, -1.6), rtol=1e-12)


def test_quaternion_is_normalized() -> None:
    ball = Joint("ball", JointType.SPHERICAL, "base", "tip")
    assert ball.transform((0.0, 3.0, 0.0, 4.0)) == Pose(quaternion=(0.0, 0.6, 0.0, 0.8))
    with pytest.raises(ValueError, match="quaternion of joint 'ball' has length 0"):
        ball.transform((0.0, 0.0, 0.0, 0.0))


def test_wrong_number_of_coordinates_is_refused_with_names() -> None:
    with pytest.raises(ValueError, match="joint 'ball' is given 3 coordinates; it has 4: x, y, z, w"):
        Joint("ball", JointType.SPHERICAL, "base", "tip").transform((0.0, 0.0, 0.0))
    with pytest.raises(ValueError, match="joint 'weld' is given 1 coordinates; it has 0: none"):
        Joint("weld", JointType.FIXED, "base", "tip").transform((0.0,))
