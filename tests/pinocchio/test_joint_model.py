"""Each joint type moves as its definition says, at every configuration, and its Jacobian is the derivative."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.configuration import configuration_vector, joint_coordinates
from eurdf.pinocchio.model import build_model
from support import by_hand

SEEDS = st.integers(0, 2**32 - 1)
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def one_joint(joint: Joint, root: str = "fixed") -> Mechanism:
    return Mechanism("one", "", root, (Body(joint.parent), Body(joint.child)), (joint,))  # type: ignore[arg-type]


def pose_of(model: pin.Model, q: np.ndarray, body: str) -> np.ndarray:
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[model.getFrameId(body, pin.FrameType.BODY)].homogeneous


def jacobian_of(model: pin.Model, q: np.ndarray, body: str) -> np.ndarray:
    frame = model.getFrameId(body, pin.FrameType.BODY)
    J = pin.computeFrameJacobian(model, model.createData(), q, frame, pin.ReferenceFrame.LOCAL)
    return np.asarray(J).reshape(6, model.nv)  # with one velocity it comes as a vector


@pytest.mark.parametrize("kind", by_hand.MOVING)
@given(seed=SEEDS)
@settings(deadline=None)
def test_joint_bias_acceleration_is_derivative_of_twist(kind: JointType, seed: int) -> None:
    random = np.random.default_rng(seed)
    joint = by_hand.some_joint(kind, random)
    mechanism = one_joint(joint)
    model = build_model(mechanism)
    q = configuration_vector(mechanism, model, {joint.name: by_hand.some_coordinates(kind, random)})
    v, h = random.uniform(-1, 1, model.nv), 1e-5
    data = model.createData()
    pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
    acceleration = pin.getFrameAcceleration(model, data, model.getFrameId("tip", pin.FrameType.BODY))
    ahead = jacobian_of(model, pin.integrate(model, q, h * v), "tip") @ v
    behind = jacobian_of(model, pin.integrate(model, q, -h * v), "tip") @ v
    np.testing.assert_allclose(acceleration.vector, (ahead - behind) / (2 * h), atol=1e-8)


@given(seed=SEEDS)
@settings(deadline=None)
def test_bodies_of_all_joint_types_have_expected_poses(seed: int) -> None:
    random = np.random.default_rng(seed)
    mechanism = by_hand.tree_of_all_types(random)
    model = build_model(mechanism)
    coordinates = {joint.name: by_hand.some_coordinates(joint.type, random) for joint in mechanism.joints}
    del coordinates[next(joint.name for joint in mechanism.joints if joint.type is JointType.FIXED)]
    q = configuration_vector(mechanism, model, coordinates)
    expected = by_hand.poses(mechanism, coordinates)
    J = by_hand.jacobians(mechanism, coordinates)
    for body in mechanism.bodies:
        np.testing.assert_allclose(pose_of(model, q, body.name), expected[body.name], atol=1e-12)
        np.testing.assert_allclose(jacobian_of(model, q, body.name), J[body.name], atol=1e-12)


@given(seed=SEEDS, root=st.sampled_from(["fixed", "floating"]))
@settings(deadline=None)
def test_coordinates_survive_round_trip_through_pinocchio(seed: int, root: str) -> None:
    random = np.random.default_rng(seed)
    mechanism = replace(by_hand.tree_of_all_types(random), root=root)  # type: ignore[arg-type]
    model = build_model(mechanism)
    given_ = {
        joint.name: by_hand.some_coordinates(joint.type, random)
        for joint in mechanism.joints
        if joint.type is not JointType.FIXED
    }
    if root == "floating":
        given_ = {"root_joint": by_hand.some_coordinates(JointType.FLOATING, random)} | given_
    back = joint_coordinates(mechanism, model, configuration_vector(mechanism, model, given_))
    assert list(back) == list(given_)
    for name, values in given_.items():
        assert back[name] == pytest.approx(values, abs=1e-12)


def test_missing_joint_is_at_neutral() -> None:
    mechanism = by_hand.tree_of_all_types(np.random.default_rng(1))
    model = build_model(mechanism)
    q = configuration_vector(mechanism, model, {})
    np.testing.assert_array_equal(q, pin.neutral(model))
    for name, values in joint_coordinates(mechanism, model, q).items():
        joint = next(joint for joint in mechanism.joints if joint.name == name)
        assert values == joint.type.neutral


def test_unknown_joint_or_wrong_length_is_refused() -> None:
    mechanism = one_joint(Joint("ball", JointType.SPHERICAL, "base", "tip"))
    model = build_model(mechanism)
    with pytest.raises(ValueError, match="'knee' is not a joint with coordinates"):
        configuration_vector(mechanism, model, {"knee": (0.0,)})
    with pytest.raises(ValueError, match="joint 'ball' is given 3 coordinates; it has 4: x, y, z, w"):
        configuration_vector(mechanism, model, {"ball": (0.0, 0.0, 0.0)})
    with pytest.raises(ValueError, match="quaternion of joint 'ball' has length 0"):
        configuration_vector(mechanism, model, {"ball": (0.0, 0.0, 0.0, 0.0)})
