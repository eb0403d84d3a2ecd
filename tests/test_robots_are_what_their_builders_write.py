"""The robots of the collection that are built: their files are what their builders write, and nobody edits them."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml
from lxml import etree

ROOT = Path(__file__).parent.parent
FOLDERS = sorted(builder.parent for builder in ROOT.glob("robots/*/build.py"))
FILES = {"robot.urdf", "robot.yaml", "robot.v1.yaml"}


def named(folder):
    return folder.name


def test_there_are_robots_that_are_built():
    assert {"four_bar", "digit_leg"} <= {folder.name for folder in FOLDERS}


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_a_robot_is_byte_for_byte_what_its_builder_writes(folder, tmp_path):
    subprocess.run([sys.executable, "-m", f"robots.{folder.name}.build", str(tmp_path)], cwd=ROOT, check=True)
    assert {path.name for path in tmp_path.iterdir()} == FILES
    for name in FILES:
        assert (folder / name).read_bytes() == (tmp_path / name).read_bytes(), name


def origins_at_zero(urdf):
    """World position of every link's frame when every joint is at zero; builders turn no joint frame."""
    joints = {joint.find("child").get("link"): joint for joint in urdf.iterfind("joint")}

    def position(link):
        if link not in joints:
            return np.zeros(3)
        origin = joints[link].find("origin")
        if origin is None:
            offset = np.zeros(3)
        else:
            assert origin.get("rpy") is None
            offset = np.array(origin.get("xyz").split(), dtype=float)
        return position(joints[link].find("parent").get("link")) + offset

    return {link.get("name"): position(link.get("name")) for link in urdf.iterfind("link")}


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_every_loop_is_closed_when_every_joint_is_at_zero(folder):
    at = origins_at_zero(etree.parse(folder / "robot.urdf").getroot())
    closures = yaml.safe_load((folder / "robot.yaml").read_text())["closures"]
    assert closures
    for closure in closures:
        a, b = closure["frames"]
        assert a != b
        assert np.abs(at[a] - at[b]).max() < 1e-12, closure["name"]


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_the_assembled_configuration_is_the_neutral_one(folder):
    description = yaml.safe_load((folder / "robot.yaml").read_text())
    assert description["configurations"] == {"assembled": {}}


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_both_versions_say_the_same_mechanism(folder):
    new = yaml.safe_load((folder / "robot.yaml").read_text())
    old = yaml.safe_load((folder / "robot.v1.yaml").read_text())
    assert old["closed_loop"] == [closure["frames"] for closure in new["closures"]]
    assert old["type"] == [closure["type"] for closure in new["closures"]]
    assert old["name_mot"] == new["actuators"]
    kinds = zip(old.get("joint_name", []), old.get("joint_type", []), strict=True)
    assert {name: kind.lower() for name, kind in kinds} == new.get("joints", {})


@pytest.mark.parametrize("folder", FOLDERS, ids=named)
def test_what_moves_has_mass_and_zero_is_within_the_stops(folder):
    urdf = etree.parse(folder / "robot.urdf").getroot()
    links = {link.get("name"): link for link in urdf.iterfind("link")}
    for joint in urdf.iterfind("joint"):
        if joint.get("type") == "fixed":
            continue
        inertial = links[joint.find("child").get("link")].find("inertial")
        assert float(inertial.find("mass").get("value")) > 0.0
        get = inertial.find("inertia").get
        matrix = [[float(get("i" + "".join(sorted(row + column)))) for column in "xyz"] for row in "xyz"]
        least, middle, most = np.linalg.eigvalsh(matrix)
        assert least > 0.0
        assert most <= least + middle
        if joint.get("type") == "revolute":
            limit = joint.find("limit")
            assert float(limit.get("lower")) < 0.0 < float(limit.get("upper"))


def test_the_crank_of_the_four_bar_turns_all_the_way_round_within_the_stops_of_the_rocker():
    urdf = etree.parse(ROOT / "robots" / "four_bar" / "robot.urdf").getroot()
    at = {
        name: complex(x, -z) for name, (x, _, z) in origins_at_zero(urdf).items()
    }  # turning about +y is anticlockwise
    pin, rocker = at["coupler"], at["rocker"]
    coupler_length, rocker_length = abs(at["rocker_pin_a"] - pin), abs(at["rocker_pin_b"] - rocker)
    turns = []
    for degree in range(360):
        to_pin = pin * np.exp(1j * np.radians(degree)) - rocker
        cosine = (rocker_length**2 + abs(to_pin) ** 2 - coupler_length**2) / (2.0 * rocker_length * abs(to_pin))
        assert abs(cosine) < 1.0
        drawn = at["rocker_pin_b"] - rocker
        branch = np.sign((drawn / (pin - rocker)).imag)
        turned = to_pin / abs(to_pin) * np.exp(1j * branch * np.arccos(cosine)) / drawn
        turns.append(np.angle(turned))
    assert turns[0] == pytest.approx(0.0, abs=1e-12)
    limit = urdf.find("joint[@name='free_rocker']/limit")
    assert float(limit.get("lower")) < min(turns) < -0.7
    assert 0.03 < max(turns) < float(limit.get("upper"))
