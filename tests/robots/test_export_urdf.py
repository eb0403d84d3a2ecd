"""Robots exported to plain URDF: the same tree, as far as URDF can say it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.writing.xml_text import rpy_of
from support import by_hand
from support.exported import random_robot
from support.plain_urdf import inertial, joint_element, link_element, pinocchios_own, trees
from support.plain_urdf import robot as robot_element

NAMES = eurdf.collection_names()
ROBOTS = Path(__file__).parents[2] / "robots"


def read_back(export: eurdf.Export, robot: Robot) -> Robot:
    return eurdf.load(export.main.decode(), root=robot.mechanism.root, geometry=False)


def assert_same_tree(robot: Robot, q: Any, to: str = "urdf") -> None:
    """Poses and M in Pinocchio's model of the file, where coordinates match; without armature, which URDF lacks."""
    joints = tuple(
        replace(joint, properties=replace(joint.properties, armature=())) for joint in robot.mechanism.joints
    )
    robot = build_robot(replace(robot.mechanism, joints=joints), geometry=False)
    export = eurdf.export(robot, to)
    model, map_ = pinocchios_own(export.main.decode(), robot.mechanism.root), export.coordinates
    joints_there = list(zip(model.names, model.joints, strict=True))[1:]
    assert [name for name, joint in joints_there if joint.nv] == list(map_.names)
    assert (model.nq, model.nv) == (map_.nq, map_.nv)
    data, there, T = model.createData(), map_.to_q(q), map_.rates(q)
    pin.framesForwardKinematics(robot.model, robot.data, q)
    pin.framesForwardKinematics(model, data, there)
    for name in [body.name for body in robot.mechanism.bodies] + [frame.name for frame in robot.mechanism.frames]:
        one = robot.data.oMf[robot.model.getFrameId(name)]
        other = data.oMf[model.getFrameId(name, pin.FrameType.BODY)]
        np.testing.assert_allclose(other.homogeneous, one.homogeneous, atol=1e-9)
    M = eurdf.mass_matrix(robot, q)
    # Pinocchio's crba has wrong entries where a mimic joint carries several branches.
    still = np.zeros(model.nv)
    gravity = pin.rnea(model, data, there, still, still)
    MT = np.array([pin.rnea(model, data, there, still, column) - gravity for column in T.T]).T
    np.testing.assert_allclose(T.T @ MT, M, atol=1e-9 * max(1.0, np.abs(M).max()))
    v = np.linspace(-1.0, 1.0, robot.model.nv)
    np.testing.assert_allclose(pin.difference(robot.model, map_.from_q(there), q), 0.0, atol=1e-12)
    np.testing.assert_allclose(map_.from_v(there, map_.to_v(q, v)), v, atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_tree_of_a_plain_urdf_is_equal(name: str) -> None:
    path = ROBOTS / name / "robot.urdf"
    robot = eurdf.load(path, geometry=False)
    there = read_back(eurdf.export(path, "urdf"), robot)
    assert there.model.names.tolist() == robot.model.names.tolist()
    assert there.model == robot.model


@given(text=trees(), root=st.sampled_from(["fixed", "floating"]))
def test_tree_of_a_random_urdf_is_equal(text: str, root: Any) -> None:
    assume(not re.search(r'lower="-?0\.0" upper="-?0\.0"', text))  # which is no range
    assume("quat_xyzw" not in text)  # which is written as roll, pitch and yaw, and rounded
    assume('version="1.2"' not in text)  # where limits that are left out are written as the largest double
    export = eurdf.export(text, "urdf", root=root)
    assert pinocchios_own(export.main.decode(), root) == pinocchios_own(text, root)


@pytest.mark.parametrize("name", NAMES)
def test_robot_of_the_collection_is_the_same_tree(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    v = np.random.default_rng(0).uniform(-0.3, 0.3, robot.model.nv)
    assert_same_tree(robot, pin.integrate(robot.model, robot.configurations["assembled"], v))


@given(
    seed=st.integers(0, 2**32 - 1),
    root=st.sampled_from(["fixed", "floating"]),
    to=st.sampled_from(["urdf", "loop-joint"]),
)
@settings(max_examples=15)
def test_random_robot_is_the_same_tree(seed: int, root: Any, to: str) -> None:
    robot, q = random_robot(seed, root)
    random = np.random.default_rng(seed)
    joints = tuple(
        replace(joint, offset=by_hand.some_pose(random)) if joint.type is JointType.SPHERICAL else joint
        for joint in robot.mechanism.joints
    )
    assert_same_tree(build_robot(replace(robot.mechanism, joints=joints), geometry=False), q, to)


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
    assert_same_tree(
        robot, pin.integrate(robot.model, pin.neutral(robot.model), np.linspace(-2.0, 2.5, robot.model.nv))
    )


def test_every_closure_is_a_loss() -> None:
    robot, _ = random_robot(3)
    lost = {loss.name for loss in eurdf.export(robot, "urdf").losses if loss.effect == "dropped"}
    assert {constraint.name for constraint in robot.constraints} <= lost


@pytest.mark.parametrize(
    "rpy", [(0.0, 0.0, 1.57), (0.1, -0.25, 3.0), (0.3, 1.5707963267948966, 0.0), (0.0, -1.57, 0.4)]
)
def test_angles_give_the_same_orientation(rpy: Any) -> None:
    pose = Pose.from_xyz_rpy((0.0, 0.0, 0.0), rpy)
    found = Pose.from_xyz_rpy((0.0, 0.0, 0.0), rpy_of(Pose(quaternion=pose.quaternion))).quaternion
    assert abs(float(np.dot(found, pose.quaternion))) == pytest.approx(1.0, abs=1e-15)
    assert found == pytest.approx(pose.quaternion, abs=1e-15) or found == pytest.approx([-x for x in pose.quaternion])


@pytest.mark.parametrize("rpy", [(0.3, 1.5707963267949, 0.0), (0.0, 2.5, 0.0), (1.5707963267949, 0.0, 0.0)])
def test_orientation_without_yaw_is_written_without(rpy: Any) -> None:
    assert rpy_of(Pose(quaternion=Pose.from_xyz_rpy((0.0, 0.0, 0.0), rpy).quaternion)) == rpy
