"""Robots exported to formats with a simulator, or another reader: it finds the poses and the dynamics that we find."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.convert.coordinates import rotation_matrix
from eurdf.convert.formats import EXPORTS
from eurdf.convert.verification.read_model import without_armature
from eurdf.mechanism.joint_types import JointType
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.exported import near, random_robot, witness
from support.plain_urdf import inertial, joint_element, link_element
from support.plain_urdf import robot as robot_element

#: Formats whose reader moves a robot. That of USD has no dynamics: its tests are in `usd/test_write`.
MOVED = [to for to in EXPORTS if to != "usd"]
#: Largest error of M, relative: in SDFormat, links between the joints that a joint becomes have 1e-9 kg and kg·m².
MASS = {"sdf": 1e-6}


def assert_same_robot(robot: Robot, to: str, q: Any, v: Any, **options: Any) -> None:
    """Names, poses, M, and M a + h for some a; and coordinates and velocities, there and back."""
    if to != "mjcf":
        robot = without_armature(robot)
    export = eurdf.export(robot, to, **options)
    there, map_ = witness(robot, export), export.coordinates
    root = int(robot.mechanism.root == "floating" and to in ("drake", "sdf"))  # which have no such joint
    assert there.names[root:] == list(map_.names)[root:]
    T = there.at(q, v)
    pin.framesForwardKinematics(robot.model, robot.data, q)
    for name in [body.name for body in robot.mechanism.bodies] + [frame.name for frame in robot.mechanism.frames]:
        expected = robot.data.oMf[robot.model.getFrameId(name)].homogeneous
        np.testing.assert_allclose(there.pose(name), expected, atol=1e-9, err_msg=name)
    M, atol = eurdf.mass_matrix(robot, q), MASS.get(to, 1e-9)
    scale = max(1.0, np.abs(M).max())
    np.testing.assert_allclose(T.T @ there.inertia_matrix @ T, M, atol=atol * scale)
    if there.bias is not None:
        h = pin.rnea(robot.model, robot.data, q, v, np.zeros(robot.model.nv))
        drift = there.inertia_matrix @ map_.to_a(q, v, np.zeros(robot.model.nv))
        np.testing.assert_allclose(T.T @ (drift + there.bias), h, rtol=1e-9, atol=1e-9 * scale)
    assert map_.to_q(q).shape == (map_.nq,)
    np.testing.assert_allclose(pin.difference(robot.model, map_.from_q(map_.to_q(q)), q), 0.0, atol=1e-12)
    np.testing.assert_allclose(map_.from_v(map_.to_q(q), map_.to_v(q, v)), v, atol=1e-12)


@pytest.mark.parametrize(
    "to", [to if to in ("mjcf", "urdf") else pytest.param(to, marks=pytest.mark.slow) for to in MOVED]
)
@pytest.mark.parametrize("name", eurdf.collection_names())
def test_robot_of_the_collection_is_the_same(name: str, to: str) -> None:
    robot = eurdf.load(name, geometry=False)
    assert_same_robot(robot, to, *near(robot, robot.configurations["assembled"]))


def with_offsets(robot: Robot, random: np.random.Generator, moved: Callable[[JointType], bool]) -> Robot:
    """The robot with child frames away from some joints, and its loops open."""
    joints = tuple(
        replace(joint, offset=by_hand.some_pose(random)) if moved(joint.type) else joint
        for joint in robot.mechanism.joints
    )
    return build_robot(replace(robot.mechanism, joints=joints), geometry=False)


@pytest.mark.parametrize("to", MOVED)
@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=10)
def test_random_robot_is_the_same(to: str, seed: int, root: Any) -> None:
    robot, q = random_robot(seed, root)
    assert_same_robot(robot, to, *near(robot, q, seed))


@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=10)
def test_random_robot_with_hinges_for_balls_is_the_same(seed: int, root: Any) -> None:
    robot, q = random_robot(seed, root)
    joints = [joint for joint in robot.mechanism.joints if joint.type.quaternion is not None]
    balls = [joint.name for joint in joints]
    robot = with_offsets(
        without_armature(robot, balls), np.random.default_rng(seed), lambda kind: kind.quaternion is not None
    )
    q, v = near(robot, q, seed)
    for each in (robot.joint_positions(q), robot.mechanism.configurations["assembled"]):
        assume(all(abs(rotation_matrix(each[name][-4:])[0, 2]) < 0.95 for name in balls))  # sine of the second angle
    assert {joint.type for joint in joints} == {JointType.SPHERICAL, JointType.FLOATING}
    assert_same_robot(robot, "mjcf", q, v, joints="hinge")


@pytest.mark.parametrize("to", MOVED)
@pytest.mark.parametrize("every", [False, True])
def test_child_frame_away_from_the_joint_is_exported(to: str, every: bool) -> None:
    robot, q = random_robot(3, kinds=())
    moved = with_offsets(robot, np.random.default_rng(0), lambda kind: every or kind is JointType.SPHERICAL)
    assert_same_robot(moved, to, *near(robot, q))


@pytest.mark.parametrize("to", ["mjcf", "urdf", "drake"])
def test_acceleration_is_the_rate_of_the_velocity(to: str) -> None:
    robot, q = random_robot(5, "floating")
    map_ = eurdf.export(robot, to).coordinates
    q, v = near(robot, q)
    a, h = np.linspace(-1.0, 1.0, robot.model.nv), 1e-6
    after, before = (map_.to_v(pin.integrate(robot.model, q, t * v), v + t * a) for t in (h, -h))
    np.testing.assert_allclose(map_.to_a(q, v, a), (after - before) / (2 * h), atol=1e-7)


def test_split_joints_are_in_the_order_of_pinocchio() -> None:
    body = inertial(1.0, '<origin xyz="0.1 0.2 0.3"/>')
    joints = (("a", "continuous"), ("a_w", "continuous"), ("b", "planar"), ("c", "revolute"), ("c_a", "continuous"))
    limit = '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    urdf = robot_element(
        link_element("base"),
        *(link_element(f"{name}_body", body) for name, _ in joints),
        *(joint_element(name, kind, "base", f"{name}_body", limit) for name, kind in joints),
    )
    description = 'extended_urdf: "2.1"\njoints: {a: {type: spherical}, c: {type: helical, pitch: 0.1}}\n'
    robot = eurdf.load(description, urdf=urdf)
    assert_same_robot(robot, "urdf", *near(robot, pin.neutral(robot.model)))


def test_skew_universal_joint_of_sdf_is_two_joints() -> None:
    robot, q = random_robot(2)  # of which one is skew
    assert "export-universal-joint" in {loss.code for loss in eurdf.export(robot, "sdf").losses}
    assert_same_robot(robot, "sdf", *near(robot, q))
