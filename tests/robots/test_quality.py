"""The quality rules: good robots pass, and each error is reported by its own rule only."""

from __future__ import annotations

import json
import shutil

import pytest
from lxml import etree

import eurdf
from robots.builder import Cylinder, Drawing, Motor, ball, prismatic, revolute, universal, write
from robots.quality.__main__ import main
from robots.quality.candidate import Candidate
from robots.quality.files import is_the_same_in_version_1
from robots.quality.mirror import is_mirrored
from robots.quality.readme import dimension_table
from robots.quality.verdict import RULES, judge
from support.places import ROOT

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


def errors(folder):
    """What is wrong, by rule, where something is."""
    return {rule: found for rule, found in judge(Candidate.find(folder)).errors.items() if found}


def only_error(folder, rule):
    """The one thing that is wrong, by the one rule that it breaks."""
    found = errors(folder)
    assert list(found) == [rule]
    (error,) = found[rule]
    return error


@pytest.mark.parametrize("name", ["four_bar", "digit_leg"])
def test_good_robot_passes_anywhere(name, tmp_path):
    folder = tmp_path / "good"
    shutil.copytree(ROOT / "robots" / name, folder)
    verdict = judge(Candidate.find(folder))
    assert not any(verdict.errors.values())
    assert verdict.passes
    assert verdict.errors["mirrored"] is None  # it has one side only


def test_limit_beyond_linkage_is_a_dead_point(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    replace(folder / "robot.yaml", "[motor_crank]", "[free_rocker]")
    edit(folder, "joint[@name='free_rocker']/limit", lower="-2", upper="2", effort="1")
    found = errors(folder)
    assert list(found) == ["sound", "motion"]  # the motor is not actuated
    below, above = found["motion"]
    assert below.startswith("'free_rocker' has a dead point at -45.7°")
    assert below.endswith("before its limit at -114.6°")
    assert "'free_rocker' has a dead point at 1.8°" in above


def test_unlimited_actuator_must_make_full_turn(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    edit(folder, "joint[@name='free_rocker']/limit", upper="0.01")
    found = errors(folder)
    assert list(found) == ["motion"]
    assert all("'motor_crank' has no limits, but 'free_rocker' reaches its own" in error for error in found["motion"])


def test_loop_open_by_a_nanometre_is_open(copy):
    folder = copy("four_bar")
    edit(folder, "joint[@name='weld_rocker_pin_b']/origin", xyz="-0.070000001 0 0.24")
    assert "open by 1.0e-09" in only_error(folder, "assembled")


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
def test_readme_must_state_computed_dimensions(copy, old, new):
    folder = copy("four_bar")
    replace(folder / "README.md", old, new)
    found = errors(folder)
    assert list(found) == ["documented"]
    assert all("README.md" in error for error in found["documented"])
    if old.startswith("| 3"):
        assert old in found["documented"][0]


def test_readme_and_description_are_required(copy):
    folder = copy("four_bar", "README.md")
    assert only_error(folder, "documented") == "README.md is missing"
    folder = copy("digit_leg")
    replace(folder / "robot.yaml", "description: ", "title: ")
    assert "no description" in only_error(folder, "documented")


def test_picture_must_be_a_png(copy):
    folder = copy("four_bar", "picture.png")
    assert only_error(folder, "pictured").startswith("picture.png is missing")
    (folder / "picture.png").write_bytes(b"")
    assert only_error(folder, "pictured") == "picture.png is not a PNG file"


def test_massless_inner_body_is_reported(copy):
    folder = copy("digit_leg")
    file = folder / "robot.urdf"
    tree = etree.parse(file)
    (inertial,) = tree.xpath("link[@name='ankle']/inertial")
    inertial.getparent().remove(inertial)
    tree.write(file)
    restate(folder)
    assert only_error(folder, "mass") == "the body of joint 'free_foot1' has no mass"


def test_indefinite_mass_matrix_is_reported_with_place(copy):
    folder = copy("four_bar")
    edit(folder, "link[@name='rocker']/inertial/inertia", ixx="0", ixy="0", ixz="0", iyy="0", iyz="0", izz="0")
    edit(folder, "link[@name='rocker']/inertial/origin", xyz="0 0 0")
    found = errors(folder)
    assert found["mass"] == ["the mass matrix is not positive definite at 'assembled'"]


@pytest.mark.parametrize(
    ("old", "new", "error"),
    [
        ("type: [3d]", "type: [6d]", "closure 'rocker_pin' differs"),
        ("[motor_crank]", "[free_rocker]", "the actuators or their order differ"),
        ("[rocker_pin_a, rocker_pin_b]", "[rocker_pin_b, rocker_pin_a]", "closure 'rocker_pin' differs"),
        ("[motor_crank]", "[motor_crank]\njoint_name: [free_rocker]\njoint_type: [SPHERICAL]", "joint 'free_rocker'"),
    ],
)
def test_different_version_1_is_reported(copy, old, new, error):
    folder = copy("four_bar")
    replace(folder / "robot.v1.yaml", old, new)
    assert error in only_error(folder, "version 1")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("type: 3d", "type: hinge\n    axis: [0, 1, 0]"),
        ("type: 3d", "type: distance\n    length: 0.1"),
        ("type: 3d", "type: 3d\n    compliance: {linear: 1.0e-6}"),
        ("actuators:", "couplings:\n  - {name: gear, joints: {motor_crank: 1, free_rocker: 1}}\nactuators:"),
        ("actuators:", "joints: {free_rocker: {stiffness: 2.0, damping: 0.1}}\nactuators:"),
        ("[motor_crank]", "[{joint: motor_crank, gear_ratio: 9, rotor_inertia: 1e-6, name: m, control: [-1, 1]}]"),
        ("actuators:", "frames: [{name: imu, link: rocker, xyz: [0, 0, 0.1]}]\nactuators:"),
    ],
)
def test_what_version_1_cannot_say_is_not_compared(copy, old, new):
    folder = copy("four_bar")
    replace(folder / "robot.yaml", '"2.0"', '"2.1"')
    replace(folder / "robot.yaml", old, new)
    assert is_the_same_in_version_1(Candidate.find(folder)) == []


@pytest.mark.parametrize(("number", "is_built"), [("1.57079632679488", True), ("1.5707964", False)])
def test_rounding_of_other_processors_is_accepted(number, is_built, tmp_path):
    folder = tmp_path / "four_bar"
    shutil.copytree(ROOT / "robots" / "four_bar", folder)
    replace(folder / "robot.urdf", "1.5707963267949", number)
    assert errors(folder).get("built") == (
        None if is_built else ["robot.urdf differs from what build.py writes; run build.py"]
    )


def test_outdated_file_is_reported(tmp_path):
    folder = tmp_path / "four_bar"
    shutil.copytree(ROOT / "robots" / "four_bar", folder)
    replace(folder / "robot.v1.yaml", "# Written by", "# Not written by")
    assert only_error(folder, "built") == "robot.v1.yaml differs from what build.py writes; run build.py"
    (folder / "build.py").write_text("raise SystemExit('no drawing')\n")
    assert only_error(folder, "built") == "build.py fails: no drawing"
    (folder / "build.py").write_text("")
    assert len(errors(folder)["built"]) == 3


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


def test_mirrored_legs_pass(walker):
    verdict = judge(Candidate.find(walker))
    assert not any(verdict.errors.values())
    assert verdict.errors["mirrored"] == []


def test_floating_robot_states_both_roots(walker):
    text = (walker / "README.md").read_text()
    assert text.count("| fixed | ") == text.count("| floating | ") == 1
    replace(walker / "README.md", "| fixed | ", "| planar | ")
    assert list(errors(walker)) == ["documented"]


def test_mirrored_angles_can_have_opposite_sign(walker):
    # The same leg, but that positive angles of its right hip are negative ones of a mirror image.
    (axis,) = etree.parse(walker / "robot.urdf").xpath("joint[@name='right_hip']/axis/@xyz")
    other_way = " ".join(str(-float(value)) for value in axis.split())
    edit(walker, "joint[@name='right_hip']/axis", xyz=other_way)
    assert only_error(walker, "mirrored") == "'left_hip' and 'right_hip' have different position limits"
    edit(walker, "joint[@name='right_hip']/limit", lower="-1.0472", upper="0.5236")
    assert not errors(walker)


@pytest.mark.parametrize(
    ("xpath", "attributes", "error"),
    [
        ("joint[@name='right_hip']/origin", {"xyz": "0 -0.2001 1"}, "'left_hip' does not move as the mirror image"),
        ("joint[@name='right_hip']/axis", {"xyz": "0 0 1"}, "'left_hip' does not move as the mirror image"),
        (
            "joint[@name='right_hip']/limit",
            {"lower": "-0.5"},
            "'left_hip' and 'right_hip' have different position limits",
        ),
        ("joint[@name='right_hip']/limit", {"effort": "2"}, "differ in velocity limit"),
        ("link[@name='right_shin']/inertial/mass", {"value": "0.6"}, "'right_knee' differ"),
        ("link[@name='right_shin']/inertial/origin", {"xyz": "0 0 0"}, "centres of mass"),
        ("link[@name='right_shin']/inertial/inertia", {"iyz": "0"}, "inertias"),
        ("link[@name='right_shin']", {"name": "right_calf"}, "'left_shin' has no counterpart"),
    ],
)
def test_unmirrored_legs_are_reported_by_difference(walker, xpath, attributes, error):
    if "name" in attributes:
        for end in ("child", "parent"):
            edit(walker, f"joint/{end}[@link='right_shin']", link=attributes["name"])
    edit(walker, xpath, **attributes)
    restate(walker)
    found = errors(walker)
    assert list(found) == ["mirrored"]
    assert error in found["mirrored"][0]


@pytest.mark.parametrize(
    ("right", "are_mirrored"),
    [("stiffness: 3, rest: 0.2", True), ("stiffness: 3, rest: -0.2", False), ("stiffness: 2, rest: 0.2", False)],
)
def test_springs_are_mirrored(walker, right, are_mirrored):
    path = walker / "robot.yaml"
    text = path.read_text().replace('"2.0"', '"2.1"')
    springs = f"  left_hip: {{stiffness: 3, rest: 0.2}}\n  right_hip: {{{right}}}\n"
    assert text.count("\njoints:\n") == 1
    path.write_text(text.replace("\njoints:\n", "\njoints:\n" + springs))
    restate(walker)
    expected = [] if are_mirrored else ["'left_hip' and 'right_hip' have different springs"]
    assert errors(walker).get("mirrored", []) == expected


def test_constraints_of_version_2_1_are_mirrored(tmp_path):
    robot = Drawing("walker", materials={"steel": (0.5, 0.5, 0.5, 1.0)}, metadata={"description": "A walker"})
    robot.body("torso", None, Cylinder((0, 0, 0), (0, 0, 1), 0.1, mass=1.0), material="steel")
    at, end = (0.0, 0.3, 0.5), (0.0, 0.4, 0.1)
    for name, joint in (
        ("left_crank", revolute("left_turn", "torso", at, (1, 0, 0))),
        ("left_bar", revolute("left_bend", "left_crank", at, (1, 0, 0.5))),
    ):
        robot.body(name, joint, Cylinder(at, end, 0.02, mass=0.1), material="steel")
    robot.hinge("left_pin", "left_bar", "torso", end, (0, 1, 0.5))
    robot.distance("left_tie", ("left_bar", end), ("torso", (0.0, 0.2, 0.0)))
    robot.couple("left_gear", left_turn=1.0, left_bend=-2.0)
    robot.mirror("left", "right")
    write(robot, tmp_path)
    assert is_mirrored(Candidate.find(tmp_path)) == []
    path = tmp_path / "robot.yaml"
    text = path.read_text()
    pin, tie, gear = (
        f"closures '{one}' and '{other}' are not mirror images, with every joint at zero"
        for one, other in (("left_pin", "right_pin"), ("left_tie", "right_tie"), ("left_gear", "right_gear"))
    )
    gear = gear.replace("closures", "couplings").removesuffix(", with every joint at zero")
    for old, new, expected in (
        ("axis: [0, -1, 0.5]", "axis: [0, 2, -1]", []),  # the same hinge
        ("axis: [0, -1, 0.5]", "axis: [0, 1, 0.5]", [pin]),
        ("right_bend: -2", "right_bend: 2", [gear]),
        ("length: 0.2236", "length: 0.2237", [tie]),
    ):
        before, found, after = text.rpartition(old)
        assert found
        path.write_text(before + new + after)
        assert is_mirrored(Candidate.find(tmp_path)) == expected


# --- the command -----------------------------------------------------------------------------------------------------


def test_command_reports_by_rule_and_exits_0_1_2(copy, capsys):
    good, bad = copy("four_bar"), copy("digit_leg", "picture.png")
    assert main([str(good)]) == 0
    out = capsys.readouterr().out.splitlines()
    assert out[0].split()[:3] == ["robot", "sound", "assembled"]
    assert "motor_crank  none" in "\n".join(out)
    assert main([str(good), str(bad)]) == 1
    assert "digit_leg: pictured: picture.png is missing" in capsys.readouterr().out
    assert main([str(good), "no_such_robot"]) == 2
    assert "no_such_robot" in capsys.readouterr().err


def test_assembled_configuration_is_required(copy):
    folder = copy("four_bar")
    replace(folder / "robot.yaml", "configurations:\n  assembled: {}\n", "")
    assert only_error(folder, "assembled") == "the configuration 'assembled' is missing"


def test_open_loops_are_reported_once(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    edit(folder, "joint[@name='weld_rocker_pin_b']/origin", xyz="9 0 0")
    found = errors(folder)
    assert list(found) == ["sound", "assembled"]


def test_command_writes_same_as_json(copy, capsys):
    assert main([str(copy("four_bar", "picture.png")), "--json"]) == 1
    (robot,) = json.loads(capsys.readouterr().out)["robots"]
    assert (robot["name"], robot["passes"]) == ("four_bar", False)
    assert list(robot["rules"]) == list(RULES)
    assert [rule for rule, found in robot["rules"].items() if found] == ["pictured"]
    (sweep,) = robot["sweeps"]
    assert (sweep["actuator"], sweep["periodic"], sweep["lower"]["end"]) == ("motor_crank", True, "half turn")


def test_unbuildable_robot_reports_only_its_reason(copy):
    folder = copy("four_bar")
    replace(folder / "robot.yaml", "[motor_crank]", "[motor_krank]")
    assert "write 'motor_crank'" in eurdf.check(folder).diagnostics[0].hint
    assert "motor_krank" in only_error(folder, "sound")


def test_warning_is_an_error(copy):
    folder = copy("four_bar", "robot.v1.yaml")
    edit(folder, "link[@name='rocker_pin_b']", name="rocker_pin_a")
    assert list(errors(folder)) == ["sound"]


def test_invalid_version_1_is_reported(copy):
    folder = copy("four_bar")
    replace(folder / "robot.v1.yaml", "[motor_crank]", "[motor_krank]")
    assert "motor_krank" in only_error(folder, "version 1")
