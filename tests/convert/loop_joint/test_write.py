"""Robots exported to URDF with loop joints: the tree of the plain URDF, and every loop where it is."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.pose import Pose, turn_from_x
from eurdf.pinocchio.robot import Robot
from support.exported import random_robot

TYPES = {"3d": "spherical", "6d": "fixed", "hinge": "revolute"}


def ends(loop: ET.Element, robot: Robot) -> list[Any]:
    """Poses (4, 4) of a loop joint in the world, from both of its links, at the configuration of the robot's data."""
    found = []
    for tag in ("link1", "link2"):
        end = loop.find(tag)
        rpy, xyz = (np.array(end.get(each).split(), float) for each in ("rpy", "xyz"))
        placement = pin.SE3(pin.rpy.rpyToMatrix(rpy), xyz)
        oMf = robot.data.oMf[robot.model.getFrameId(end.get("link"), pin.FrameType.BODY)]
        found.append((oMf * placement).homogeneous)
    return found


def assert_same_loops(robot: Robot, q: Any) -> None:
    export, plain = eurdf.export(robot, "loop-joint"), eurdf.export(robot, "urdf")
    tree = ET.fromstring(export.main)
    loops = tree.findall("loop_joint")
    closures = [closure for closure in robot.mechanism.closures if closure.type in TYPES]
    assert [(loop.get("name"), loop.get("type")) for loop in loops] == [
        (each.name, TYPES[each.type]) for each in closures
    ]
    for loop in loops:
        tree.remove(loop)
    assert ET.canonicalize(ET.tostring(tree), strip_text=True) == ET.canonicalize(plain.main, strip_text=True)
    pin.framesForwardKinematics(robot.model, robot.data, q)
    for loop, closure in zip(loops, closures, strict=True):
        one, other = ends(loop, robot)
        np.testing.assert_allclose(one[:3, 3], other[:3, 3], atol=1e-6)
        if closure.type == "6d":
            np.testing.assert_allclose(one, other, atol=1e-6)
        if closure.type == "hinge":
            np.testing.assert_allclose(one[:3, 0], other[:3, 0], atol=1e-6)
            assert loop.find("axis").get("xyz") == "1 0 0"
        site, placement = robot.tree.site(closure.a)
        np.testing.assert_allclose(one[:3, 3], robot.data.oMi[site].act(placement.translation), atol=1e-9)


def test_robots_of_the_collection_have_their_loops() -> None:
    for name in ("four_bar", "digit_leg", "kangaroo_leg", "unitree_g1_ankle"):
        robot = eurdf.load(name, geometry=False)
        assert_same_loops(robot, robot.configurations["assembled"])


@given(seed=st.integers(0, 2**32 - 1), root=st.sampled_from(["fixed", "floating"]))
@settings(max_examples=10)
def test_random_robot_has_its_loops(seed: int, root: Any) -> None:
    assert_same_loops(*random_robot(seed, root))


@pytest.mark.parametrize("axis", [(1, 0, 0), (-1, 0, 0), (0, 2, 0), (-1, 1e-9, 1e-12), (-0.3, 0.4, -5.0)])
def test_rotation_from_x_takes_x_to_the_axis(axis: Any) -> None:
    found = Pose(quaternion=turn_from_x(axis)).rotate((1.0, 0.0, 0.0))
    assert found == pytest.approx(np.divide(axis, np.linalg.norm(axis)), abs=1e-15)
