"""Robots exported to plain URDF: the same tree, as far as URDF can say it."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import eurdf
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.robot import Robot
from eurdf.writing.xml_text import rpy_of
from support.places import ROBOTS
from support.plain_urdf import pinocchios_own, trees

NAMES = eurdf.collection_names()


def read_back(export: eurdf.convert.Export, robot: Robot) -> Robot:
    return eurdf.load(export.main.decode(), root=robot.mechanism.root, geometry=False)


@pytest.mark.parametrize("name", NAMES)
def test_tree_of_a_plain_urdf_is_equal(name: str) -> None:
    path = ROBOTS / name / "robot.urdf"
    robot = eurdf.load(path, geometry=False)
    there = read_back(eurdf.export(path, "urdf"), robot)
    assert there.model.names.tolist() == robot.model.names.tolist()
    assert there.model == robot.model


# Of a version with quaternions they are written as roll, pitch and yaw, and rounded; in 1.2, limits that are left out
# are written as the largest double.
@given(text=trees(st.just("")), root=st.sampled_from(["fixed", "floating"]))
def test_tree_of_a_random_urdf_is_equal(text: str, root: Any) -> None:
    assume(not re.search(r'lower="-?0\.0" upper="-?0\.0"', text))  # which is no range
    export = eurdf.export(text, "urdf", root=root)
    assert pinocchios_own(export.main.decode(), root) == pinocchios_own(text, root)


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
