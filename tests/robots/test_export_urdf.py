"""Robots exported to plain URDF: the same tree, as far as URDF can say it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.writing.angles import rpy_of
from support import by_hand
from support.exported import random_robot

NAMES = eurdf.collection_names()
ROBOTS = Path(__file__).parents[2] / "robots"


def read_back(export: eurdf.Export, robot: Robot) -> Robot:
    return eurdf.load(export.main.decode(), root=robot.mechanism.root, geometry=False)


def matched(export: eurdf.Export, there: Robot, robot: Robot, q: Any) -> tuple[Any, Any]:
    """The configuration of the robot that was read back, and dv'/dv."""
    map_ = export.coordinates
    values, T = map_.to_q(q), map_.rates(q)
    coordinates: dict[str, Any] = {}
    rates = np.zeros((there.model.nv, robot.model.nv))
    at_q = at_v = 0
    for name in map_.names:
        slot = there.slots.get(name)
        n, nv, start = (7, 6, 0) if slot is None else (len(slot.joint.coordinates.names), slot.nv, slot.idx_v)
        coordinates[name] = values[at_q : at_q + n]
        rates[start : start + nv] = T[at_v : at_v + nv]
        at_q, at_v = at_q + n, at_v + nv
    return there.configuration(coordinates), rates


def assert_same_tree(robot: Robot, q: Any) -> None:
    """Poses, M and bias, at matched configurations; without armature, which URDF does not have."""
    joints = tuple(
        replace(joint, properties=replace(joint.properties, armature=())) for joint in robot.mechanism.joints
    )
    robot = build_robot(replace(robot.mechanism, joints=joints), geometry=False)
    export = eurdf.export(robot, "urdf")
    there = read_back(export, robot)
    q2, T = matched(export, there, robot, q)
    for each, at in ((robot, q), (there, q2)):
        pin.framesForwardKinematics(each.model, each.data, at)
    for body in robot.mechanism.bodies:
        one, other = (each.data.oMf[each.model.getFrameId(body.name, pin.FrameType.BODY)] for each in (robot, there))
        np.testing.assert_allclose(other.homogeneous, one.homogeneous, atol=1e-9)
    M = eurdf.mass_matrix(robot, q)
    np.testing.assert_allclose(T.T @ eurdf.mass_matrix(there, q2) @ T, M, atol=1e-9 * max(1.0, np.abs(M).max()))


@pytest.mark.parametrize("name", NAMES)
def test_tree_of_a_plain_urdf_is_equal(name: str) -> None:
    path = ROBOTS / name / "robot.urdf"
    robot = eurdf.load(path, geometry=False)
    there = read_back(eurdf.export(path, "urdf"), robot)
    assert there.model.names.tolist() == robot.model.names.tolist()
    assert there.model == robot.model


@pytest.mark.parametrize("name", NAMES)
def test_robot_of_the_collection_is_the_same_tree(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    v = np.random.default_rng(0).uniform(-0.3, 0.3, robot.model.nv)
    assert_same_tree(robot, pin.integrate(robot.model, robot.configurations["assembled"], v))


@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=15)
def test_random_robot_is_the_same_tree(seed: int, root: Any) -> None:
    robot, q = random_robot(seed, root)
    random = np.random.default_rng(seed)
    joints = tuple(
        replace(joint, offset=by_hand.some_pose(random)) if joint.type is JointType.SPHERICAL else joint
        for joint in robot.mechanism.joints
    )
    assert_same_tree(build_robot(replace(robot.mechanism, joints=joints), geometry=False), q)


def test_every_closure_is_a_loss() -> None:
    robot, _ = random_robot(3)
    lost = {loss.name for loss in eurdf.export(robot, "urdf").losses if loss.effect == "dropped"}
    assert {constraint.name for constraint in robot.constraints} <= lost


@pytest.mark.parametrize(
    "rpy", [(0.0, 0.0, 1.57), (0.1, -0.25, 3.0), (0.3, 1.5707963267948966, 0.0), (0.0, -1.57, 0.4)]
)
def test_angles_give_the_same_orientation(rpy: Any) -> None:
    pose = Pose.from_xyz_rpy((0.0, 0.0, 0.0), rpy)
    found = Pose.from_xyz_rpy((0.0, 0.0, 0.0), rpy_of(pose)).quaternion
    assert abs(float(np.dot(found, pose.quaternion))) == pytest.approx(1.0, abs=1e-15)
    assert found == pytest.approx(pose.quaternion, abs=1e-15) or found == pytest.approx([-x for x in pose.quaternion])


@pytest.mark.parametrize("rpy", [(0.3, 1.5707963267949, 0.0), (0.0, 2.5, 0.0), (1.5707963267949, 0.0, 0.0)])
def test_orientation_without_yaw_is_written_without(rpy: Any) -> None:
    assert rpy_of(Pose.from_xyz_rpy((0.0, 0.0, 0.0), rpy)) == rpy
