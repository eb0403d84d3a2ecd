"""The robots of the collection: complete, passing all quality rules, with the requested dimensions."""

from __future__ import annotations

import os
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest
import yaml
from lxml import etree

import eurdf
from robots.builder.version_1 import can_be_version_1
from robots.quality.candidate import Candidate
from robots.quality.verdict import judge
from support.places import ROOT
from support.warm import run_module

FOLDERS = sorted(file.parent for file in ROOT.glob("robots/*/robot.yaml"))

#: With the base fixed: nv, closures by type, nc, rank, mobility, actuated, uncontrolled; None where that is the robot's
#: own affair. Those of digit_leg and kangaroo_leg are the paper's.
DIMENSIONS = {
    "battobot": (48, {"6d": 6}, 36, 36, 12, 12, 0),
    "bennett": (None, None, None, None, 1, 1, 0),
    "cassie_2legs": (38, {"6d": 4}, 24, 24, 14, 10, 4),
    "cassie_leg": (21, {"6d": 2}, 12, 12, 9, 5, 4),
    "delta": (None, None, None, None, None, 3, None),
    "dextar": (5, {"3d": 1}, 3, 2, 3, 3, 0),
    "digit_2legs": (52, {"6d": 6}, 36, 36, 16, 12, 4),
    "digit_leg": (27, {"6d": 3}, 18, 18, 9, 6, 3),
    "digit_leg_3d": (18, {"3d": 3}, 9, 9, 9, 6, 3),
    "disney_2legs": (54, {"6d": 6}, 36, 36, 18, 12, 6),
    "disney_leg": (27, {"6d": 3}, 18, 18, 9, 6, 3),
    "doggo_leg": (4, {"hinge": 1}, 5, 2, 2, 2, 0),
    "double_wishbone": (12, {"hinge": 1, "distance": 1, "3d": 1}, 9, 9, 3, 1, 2),
    "excavator": (12, {"3d": 4}, 12, 8, 4, 4, 0),
    "five_bar": (5, {"6d": 1}, 6, 3, 2, 2, 0),
    "five_bar_3d": (5, {"3d": 1}, 3, 3, 2, 2, 0),
    "five_bar_6d": (8, {"6d": 1}, 6, 6, 2, 2, 0),
    "four_bar": (None, None, None, None, 1, 1, 0),
    "kangaroo_2legs": (126, {"6d": 6, "3d": 18}, 90, 90, 36, 12, 24),
    "kangaroo_leg": (63, {"6d": 3, "3d": 9}, 45, 45, 18, 6, 12),
    "planar_3rrr": (None, None, None, None, 3, 3, 0),
    "reachy_mini": (24, {"3d": 5}, 15, 15, 9, 9, 0),
    "robotiq_2f85": (9, {"3d": 2}, 8, 6, 3, 1, 2),
    "sarrus": (None, None, None, None, 1, 1, 0),
    "screw_press": (11, {"hinge": 2, "6d": 1}, 16, 9, 2, 2, 0),
    "slider_crank": (None, None, None, None, 1, 1, 0),
    "spherical_four_bar": (None, None, None, None, 1, 1, 0),
    "stewart_platform": (None, None, None, None, None, 6, None),
    "talos_2legs": (52, {"3d": 2}, 6, 6, 46, 44, 2),
    "talos_2legs_6d": (56, {"6d": 2}, 12, 12, 44, 44, 0),
    "talos_leg": (13, {"6d": 1}, 6, 6, 7, 6, 1),
    "tello": (20, {"distance": 6}, 10, 10, 10, 10, 0),
    "tesla_optimus_ankle": (None, None, None, None, None, 2, None),
    "toddlerbot_2legs": (30, {"hinge": 6}, 35, 14, 16, 16, 0),
    "unitree_g1": (47, {"3d": 6}, 18, 18, 29, 29, 0),
    "unitree_g1_ankle": (None, None, None, None, None, 2, None),
    "wl16_leg": (42, {"6d": 5}, 30, 30, 12, 6, 6),
}

#: Those without a build.py: they show what a URDF from CAD needs.
WRITTEN_BY_HAND = {"screw_press"}

#: Of those whose dimensions are their own affair, the motions that the actuators decide.
CONTROLLED = {"delta": 3, "stewart_platform": 6, "tesla_optimus_ankle": 2, "unitree_g1_ankle": 2}

TWO_LEGGED = {
    "battobot",
    "cassie_2legs",
    "digit_2legs",
    "disney_2legs",
    "kangaroo_2legs",
    "talos_2legs",
    "talos_2legs_6d",
    "tello",
    "toddlerbot_2legs",
    "unitree_g1",
}


def named(folder):
    return folder.name


def test_all_requested_robots_exist():
    assert {folder.name for folder in FOLDERS} == set(DIMENSIONS) == set(eurdf.collection_names())


def built_in_warm_process(folder):
    run_module("build", [], cwd=folder, environment=os.environ | {"PYTHONPATH": str(ROOT)}).check_returncode()


@pytest.mark.parametrize(
    "folder",
    [pytest.param(folder, marks=[pytest.mark.slow] * (folder.name in TWO_LEGGED)) for folder in FOLDERS],
    ids=named,
)
def test_robot_passes_all_quality_rules(folder, monkeypatch):
    # The command starts Python for each robot (test_quality.py), which takes longer than most builds.
    monkeypatch.setattr("robots.quality.files._build", built_in_warm_process)
    candidate = Candidate.find(folder)
    errors = judge(candidate).errors
    assert {rule: found for rule, found in errors.items() if found} == {}
    left_out = {rule for rule, found in errors.items() if found is None}
    inapplicable = {"mirrored"} if errors["mirrored"] is None else set()
    if not can_be_version_1(candidate.robot.mechanism):
        inapplicable.add("version 1")
    if folder.name in WRITTEN_BY_HAND:
        inapplicable.add("built")
    assert left_out == inapplicable
    assert folder.name not in TWO_LEGGED or errors["mirrored"] == []


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_robot_has_requested_dimensions(folder):
    found = eurdf.analyze(eurdf.load(folder, root="fixed", geometry=False))
    robot = eurdf.load(folder, geometry=False)
    types = Counter(closure.type for closure in robot.mechanism.closures)
    measured = (found.nv, types, found.nc, found.rank, found.mobility, found.actuated, found.uncontrolled)
    asked = DIMENSIONS[folder.name]
    assert asked == tuple(value if wish is not None else None for value, wish in zip(measured, asked, strict=True))
    assert found.controlled == CONTROLLED.get(folder.name, found.controlled)
    assert found.dependent == 0
    assert robot.mechanism.root == ("floating" if folder.name in TWO_LEGGED else "fixed")


def placed(frame, at):
    """Pose (4, 4) of a frame of a closure: a link, or a point of one."""
    if isinstance(frame, str):
        return at[frame]
    shift = np.eye(4)
    shift[:3, 3] = frame["xyz"]
    return at[frame["link"]] @ shift


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_drawn_pose_is_assembled_with_zero_coordinates(folder):
    description = yaml.safe_load((folder / "robot.yaml").read_text())
    assert description["configurations"]["assembled"] == {}
    at = poses_at_zero(etree.parse(folder / "robot.urdf").getroot())
    for closure in description["closures"]:
        a, b = (placed(frame, at) for frame in closure["frames"])
        assert closure["frames"][0] != closure["frames"][1]
        apart = np.abs(a - b)
        assert abs(np.linalg.norm(apart[:3, 3]) - closure.get("length", 0.0)) < 1e-12, closure["name"]
        assert closure["type"] in ("3d", "distance") or apart.max() < 1e-12, closure["name"]


def test_builder_writes_into_given_folder(tmp_path):
    subprocess.run([sys.executable, "-m", "robots.four_bar.build", str(tmp_path)], cwd=ROOT, check=True)
    assert {file.name for file in tmp_path.iterdir()} == {"robot.urdf", "robot.yaml", "robot.v1.yaml"}
    assert (tmp_path / "robot.urdf").read_bytes() == (ROOT / "robots" / "four_bar" / "robot.urdf").read_bytes()


def poses_at_zero(urdf):
    """World pose (4, 4) of every link when every joint is at zero, by arithmetic of our own."""
    joints = {joint.find("child").get("link"): joint for joint in urdf.iterfind("joint")}

    def pose(link):
        if link not in joints:
            return np.eye(4)
        origin = joints[link].find("origin")
        local = np.eye(4)
        if origin is not None:
            roll, pitch, yaw = map(float, origin.get("rpy", "0 0 0").split())
            local[:3, :3] = turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
            local[:3, 3] = [float(value) for value in origin.get("xyz", "0 0 0").split()]
        return pose(joints[link].find("parent").get("link")) @ local

    return {link.get("name"): pose(link.get("name")) for link in urdf.iterfind("link")}


def turn(axis, angle):
    """Rotation (3, 3) about a coordinate axis."""
    first, second = [index for index in range(3) if index != axis]
    sign = -1.0 if axis == 1 else 1.0
    rotation = np.eye(3)
    rotation[first, first] = rotation[second, second] = np.cos(angle)
    rotation[second, first] = sign * np.sin(angle)
    rotation[first, second] = -rotation[second, first]
    return rotation
