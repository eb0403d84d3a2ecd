"""What says when a robot is good enough: good ones pass, and what is wrong with one is told by its rule alone."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path

import pytest
from lxml import etree

sys.path.insert(0, str(Path(__file__).parents[2]))

import eurdf
from robots.builder import Cylinder, Drawing, Motor, ball, prismatic, revolute, universal, write
from robots.quality.__main__ import main
from robots.quality.candidate import Candidate
from robots.quality.readme import dimension_table
from robots.quality.verdict import RULES, judge

ROOT = Path(__file__).parents[2]
PICTURE = ROOT / "robots" / "four_bar" / "picture.png"


@pytest.fixture
def copy(tmp_path):
    """Copies a robot of the collection to another place, without what builds it."""

    def copied(name, *left_out):
        folder = tmp_path / name
        shutil.copytree(
            ROOT / "robots" / name, folder, ignore=shutil.ignore_patterns("__pycache__", "build.py", *left_out)
        )
        return folder

    return copied


def replace(file, old, new):
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


def edit(folder, xpath, **attributes):
    """Sets attributes of one element of the URDF."""
    file = folder / "robot.urdf"
    tree = etree.parse(file)
    (element,) = tree.xpath(xpath)
    element.attrib.update(attributes)
    tree.write(file)


def restate(folder):
    """Lets the README state the dimensions as they are."""
    rows = [f"| {' | '.join(row)} |" for row in dimension_table(Candidate.find(folder))]
    rows.insert(1, "| --- " * rows[0].count(" | ") + "| --- |")
    (folder / "README.md").write_text("\n".join(["# Robot", "![](picture.png)", "", *rows, ""]))


def faults(folder):
    """What is wrong, by rule, where something is."""
    return {rule: found for rule, found in judge(Candidate.find(folder)).faults.items() if found}


def only_fault(folder, rule):
    """The one thing that is wrong, by the one rule that it breaks."""
    found = faults(folder)
    assert list(found) == [rule]
    (fault,) = found[rule]
    return fault


@pytest.mark.parametrize("name", ["four_bar", "digit_leg"])
def test_a_good_robot_passes_wherever_it_is(name, tmp_path):
    folder = tmp_path / "good"
    shutil.copytree(ROOT / "robots" / name, folder)
    verdict = judge(Candidate.find(folder))
    assert not any(verdict.faults.values())
    assert verdict.passes
    assert verdict.faults["mirrored"] is None  # it has one side only


def test_what_need_not_be_there_is_not_looked_at(copy):
    verdict = judge(Candidate.find(copy("four_bar", "robot.v1.yaml")))
    assert verdict.passes
    assert [rule for rule, found in verdict.faults.items() if found is None] == ["built", "version 1", "mirrored"]


def test_a_robot_that_cannot_be_built_is_told_why_and_nothing_else(copy):
    folder = copy("four_bar")
    replace(folder / "robot.yaml", "[motor_crank]", "[motor_krank]")
    assert "did you mean 'motor_crank'" in eurdf.check(folder).diagnostics[0].hint
    assert "motor_krank" in only_fault(folder, "sound")


def test_a_warning_is_a_fault(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    edit(folder, "link[@name='rocker_pin_b']", name="rocker_pin_a")
    assert list(faults(folder)) == ["sound"]


def test_a_stop_beyond_what_the_linkage_allows_is_a_dead_point(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    replace(folder / "robot.yaml", "[motor_crank]", "[free_rocker]")
    edit(folder, "joint[@name='free_rocker']/limit", lower="-2", upper="2", effort="1")
    found = faults(folder)
    assert list(found) == ["moves"]
    below, above = found["moves"]
    assert below.startswith("'free_rocker' has a dead point at -45.7°")
    assert below.endswith("before its stop at -114.6°")
    assert "'free_rocker' has a dead point at 1.8°" in above


def test_an_actuator_without_stops_must_come_round(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    edit(folder, "joint[@name='free_rocker']/limit", upper="0.01")
    found = faults(folder)
    assert list(found) == ["moves"]
    assert all("'motor_crank' has no stops, but 'free_rocker' comes to its own" in fault for fault in found["moves"])


def test_a_loop_open_by_a_nanometre_is_not_closed(copy):
    folder = copy("four_bar")
    edit(folder, "joint[@name='weld_rocker_pin_b']/origin", xyz="-0.070000001 0 0.24")
    assert "open by 1.0e-09" in only_fault(folder, "assembled")


def test_a_robot_needs_an_assembled_configuration(copy):
    folder = copy("four_bar")
    replace(folder / "robot.yaml", "configurations:\n  assembled: {}\n", "")
    assert only_fault(folder, "assembled") == "there is no configuration 'assembled'"


def test_loops_that_do_not_close_are_told_once(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    edit(folder, "joint[@name='weld_rocker_pin_b']/origin", xyz="9 0 0")
    found = faults(folder)
    assert list(found) == ["sound", "assembled"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("| 3 | 1 (3d) | 3 | 2 | 1 | 1 | 1 | 0 | 0.40 kg |", "| 3 | 1 (3d) | 3 | 2 | 1 | 1 | 1 | 1 | 0.40 kg |"),
        ("| 3 | 1 (3d) | 3 | 2 | 1 | 1 | 1 | 0 | 0.40 kg |", "| 3 | 1 (6d) | 3 | 2 | 1 | 1 | 1 | 0 | 0.40 kg |"),
        ("| 3 | 1 (3d) | 3 | 2 | 1 | 1 | 1 | 0 | 0.40 kg |", "| 3 | 1 (3d) | 3 | 2 | 1 | 1 | 1 | 0 | 0.41 kg |"),
        ("| 3 | 1 (3d) | 3 | 2 | 1 | 1 | 1 | 0 | 0.40 kg |", ""),
        ("| nv | closures |", "| nq | closures |"),
        ("| redundant |", "| spare |"),
        ("](picture.png)", "](other.png)"),
    ],
)
def test_a_readme_that_does_not_say_what_is_measured_is_at_fault(copy, old, new):
    folder = copy("four_bar")
    replace(folder / "README.md", old, new)
    found = faults(folder)
    assert list(found) == ["documented"]
    assert all("README.md" in fault for fault in found["documented"])
    if old.startswith("| 3"):
        assert old in found["documented"][0]


def test_a_readme_and_a_description_are_missed(copy):
    folder = copy("four_bar", "README.md")
    assert only_fault(folder, "documented") == "there is no README.md"
    folder = copy("digit_leg")
    replace(folder / "robot.yaml", "description: ", "title: ")
    assert "no description" in only_fault(folder, "documented")


def test_a_missing_picture_is_missed_and_so_is_one_that_is_none(copy):
    folder = copy("four_bar", "picture.png")
    assert only_fault(folder, "pictured").startswith("there is no picture.png")
    (folder / "picture.png").write_bytes(b"")
    assert only_fault(folder, "pictured") == "picture.png is no PNG"


def test_a_body_without_mass_between_others_is_missed(copy):
    folder = copy("digit_leg")
    file = folder / "robot.urdf"
    tree = etree.parse(file)
    (inertial,) = tree.xpath("link[@name='ankle']/inertial")
    inertial.getparent().remove(inertial)
    tree.write(file)
    restate(folder)
    assert only_fault(folder, "weighs") == "what joint 'free_foot1' carries has no mass"


def test_a_mass_matrix_that_is_not_positive_definite_is_named_with_its_place(copy):
    folder = copy("four_bar")
    edit(folder, "link[@name='rocker']/inertial/inertia", ixx="0", ixy="0", ixz="0", iyy="0", iyz="0", izz="0")
    edit(folder, "link[@name='rocker']/inertial/origin", xyz="0 0 0")
    found = faults(folder)
    assert found["weighs"] == ["the mass matrix is not positive definite where it is assembled"]


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("type: [3d]", "type: [6d]", "closure 'rocker_pin' is another"),
        ("[motor_crank]", "[free_rocker]", "the actuators are others"),
        ("[rocker_pin_a, rocker_pin_b]", "[rocker_pin_b, rocker_pin_a]", "closure 'rocker_pin' is another"),
        ("[motor_crank]", "[motor_crank]\njoint_name: [free_rocker]\njoint_type: [SPHERICAL]", "joint 'free_rocker'"),
    ],
)
def test_a_version_1_that_says_something_else_is_named(copy, old, new, fault):
    folder = copy("four_bar")
    replace(folder / "robot.v1.yaml", old, new)
    assert fault in only_fault(folder, "version 1")


def test_a_version_1_with_a_fault_of_its_own_is_named(copy):
    folder = copy("four_bar")
    replace(folder / "robot.v1.yaml", "[motor_crank]", "[motor_krank]")
    assert "motor_krank" in only_fault(folder, "version 1")


@pytest.mark.parametrize(("number", "is_built"), [("1.57079632679488", True), ("1.5707964", False)])
def test_the_last_digits_of_a_built_file_may_be_those_of_another_processor(number, is_built, tmp_path):
    folder = tmp_path / "four_bar"
    shutil.copytree(ROOT / "robots" / "four_bar", folder)
    replace(folder / "robot.urdf", "1.5707963267949", number)
    assert faults(folder).get("built") == (None if is_built else ["robot.urdf is not what build.py writes"])


def test_a_file_that_its_builder_does_not_write_is_named(tmp_path):
    folder = tmp_path / "four_bar"
    shutil.copytree(ROOT / "robots" / "four_bar", folder)
    replace(folder / "robot.v1.yaml", "# Written by", "# Not written by")
    assert only_fault(folder, "built") == "robot.v1.yaml is not what build.py writes"
    (folder / "build.py").write_text("raise SystemExit('no drawing')\n")
    assert only_fault(folder, "built") == "build.py fails: no drawing"
    (folder / "build.py").write_text("")
    assert len(faults(folder)["built"]) == 3


# --- mirrored legs ---------------------------------------------------------------------------------------------------


@pytest.fixture
def walker(tmp_path):
    """A torso with two legs, mirrored, of every kind of joint that can be drawn."""
    robot = Drawing(
        "walker", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={"description": "A walker"}, root="floating"
    )
    robot.body("torso", None, Cylinder((0, 0, 1), (0, 0, 1.5), 0.1, mass=1.0), material="steel")
    motor = Motor(effort=1.0, velocity=1.0)
    hip, knee, ankle, heel, toe = (0.0, 0.2, 1.0), (0.1, 0.3, 0.7), (0.0, 0.25, 0.3), (-0.1, 0.3, 0.1), (0.2, 0.2, 0.0)
    for name, joint, end in (
        ("left_thigh", revolute("left_hip", "torso", hip, (1, 2, 3), degrees=(-30, 60), motor=motor), knee),
        ("left_shin", prismatic("left_knee", "left_thigh", knee, (1, -1, 2), metres=(-0.1, 0.2), motor=motor), ankle),
        ("left_foot", universal("left_ankle", "left_shin", ankle, (1, 1, 0), (-1, 1, 3)), heel),
        ("left_toe", ball("left_heel", "left_foot", heel), toe),
    ):
        robot.body(name, joint, Cylinder(joint.at, end, 0.2, mass=0.5), material="steel")
    robot.mirror("left", "right")
    write(robot, tmp_path)
    shutil.copy(PICTURE, tmp_path)
    restate(tmp_path)
    return tmp_path


def test_drawn_and_mirrored_legs_pass(walker):
    verdict = judge(Candidate.find(walker))
    assert not any(verdict.faults.values())
    assert verdict.faults["mirrored"] == []


def test_a_floating_robot_states_its_dimensions_with_either_root(walker):
    text = (walker / "README.md").read_text()
    assert text.count("| fixed | ") == text.count("| floating | ") == 1
    replace(walker / "README.md", "| fixed | ", "| planar | ")
    assert list(faults(walker)) == ["documented"]


def test_a_leg_may_count_its_angles_the_other_way(walker):
    # The same leg, but that positive angles of its right hip are negative ones of a mirror image.
    (axis,) = etree.parse(walker / "robot.urdf").xpath("joint[@name='right_hip']/axis/@xyz")
    other_way = " ".join(str(-float(value)) for value in axis.split())
    edit(walker, "joint[@name='right_hip']/axis", xyz=other_way)
    assert only_fault(walker, "mirrored") == "'left_hip' and 'right_hip' have other stops"
    edit(walker, "joint[@name='right_hip']/limit", lower="-1.0472", upper="0.5236")
    assert not faults(walker)


@pytest.mark.parametrize(
    ("xpath", "attributes", "fault"),
    [
        ("joint[@name='right_hip']/origin", {"xyz": "0 -0.2001 1"}, "'left_hip' does not move as the mirror image"),
        ("joint[@name='right_hip']/axis", {"xyz": "0 0 1"}, "'left_hip' does not move as the mirror image"),
        ("joint[@name='right_hip']/limit", {"lower": "-0.5"}, "'left_hip' and 'right_hip' have other stops"),
        ("joint[@name='right_hip']/limit", {"effort": "2"}, "have other limits of velocity or effort"),
        ("link[@name='right_shin']/inertial/mass", {"value": "0.6"}, "'right_knee' carry differs in mass"),
        ("link[@name='right_shin']/inertial/origin", {"xyz": "0 0 0"}, "centres of mass"),
        ("link[@name='right_shin']/inertial/inertia", {"iyz": "0"}, "inertias"),
        ("link[@name='right_shin']", {"name": "right_calf"}, "'left_shin' has no mirror image of its name"),
    ],
)
def test_legs_that_are_not_mirrored_are_told_by_what_is_other(walker, xpath, attributes, fault):
    if "name" in attributes:
        for end in ("child", "parent"):
            edit(walker, f"joint/{end}[@link='right_shin']", link=attributes["name"])
    edit(walker, xpath, **attributes)
    restate(walker)
    found = faults(walker)
    assert list(found) == ["mirrored"]
    assert fault in found["mirrored"][0]


# --- the command -----------------------------------------------------------------------------------------------------


def test_the_command_tells_by_rule_and_exits_with_0_1_or_2(copy, capsys):
    good, bad = copy("four_bar"), copy("digit_leg", "picture.png")
    assert main([str(good)]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].split()[:3] == ["robot", "sound", "assembled"]
    assert "motor_crank  none" in "\n".join(out)
    assert main([str(good), str(bad)]) == 1
    assert "digit_leg: pictured: there is no picture.png" in capsys.readouterr().out
    assert main([str(good), "no_such_robot"]) == 2
    assert "no_such_robot" in capsys.readouterr().err


def test_the_command_writes_the_same_as_json(copy, capsys):
    assert main([str(copy("four_bar", "picture.png")), "--json"]) == 1
    (robot,) = json.loads(capsys.readouterr().out)["robots"]
    assert (robot["name"], robot["passes"]) == ("four_bar", False)
    assert list(robot["rules"]) == list(RULES)
    assert [rule for rule, found in robot["rules"].items() if found] == ["pictured"]
    (sweep,) = robot["sweeps"]
    assert (sweep["actuator"], sweep["periodic"], sweep["lower"]["end"]) == ("motor_crank", True, "half turn")
