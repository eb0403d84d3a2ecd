"""Open loops: one slip in a valid robot of the collection is named, and no fix makes another robot of it."""

from __future__ import annotations

import re
import shutil
from decimal import Decimal
from functools import cache
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from lxml import etree

import eurdf
from eurdf.advice.open_loops import causes_of_open_loops, proposed
from eurdf.advice.slip import Slip
from eurdf.advice.spelling import other_side, with_one_slip
from eurdf.advice.stated_pose import StatedPose
from eurdf.commands.main import main
from eurdf.kinematics.residual import closure_openings
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.mechanism import Mechanism
from support.places import ROBOTS

NAMES = sorted(path.parent.name for path in ROBOTS.glob("*/robot.yaml"))
KINDS = (
    *("sign", "millimetres", "exchanged coordinates", "digit", "decimal point", "root link"),
    *("frame", "exchanged frames", "parent"),
)


@cache
def posed(name: str) -> tuple[Mechanism, StatedPose]:
    robot = eurdf.load(ROBOTS / name, geometry=False)
    q = robot.configurations["assembled"]
    return robot.mechanism, StatedPose(robot.mechanism, robot.joint_positions(q, mimic=True))


def slipped(draw: st.DataObject, kind: str, pose: StatedPose, urdf: etree._Element, yaml_: dict) -> str:
    """Make a slip of a kind; return the name of what has it."""
    numbers = [k for k, closure in enumerate(pose.constraints) if closure.anchors]
    looped = sorted({name for k in numbers for names in pose.between(k) for name in names})
    joints = [joint for joint in urdf.iter("joint") if joint.get("name") in looped and joint.find("origin") is not None]
    links = [link.get("name") for link in urdf.iterchildren("link")]
    if kind in ("frame", "exchanged frames"):
        closures = yaml_["closures"]
        assume(kind == "frame" or len(closures) > 1)
        one = draw.draw(st.sampled_from(closures))
        of = draw.draw(st.integers(0, 1))
        if kind == "frame":
            one["frames"][of] = draw.draw(st.sampled_from(links))
        else:
            other = draw.draw(st.sampled_from([each for each in closures if each is not one]))
            one["frames"][of], other["frames"][of] = other["frames"][of], one["frames"][of]
        return f"'{one['name']}'"
    joint = draw.draw(st.sampled_from(joints))
    if kind == "parent":
        parent, child = joint.find("parent"), joint.find("child").get("link")
        parent.set(
            "link", draw.draw(st.sampled_from([link for link in links if link not in (child, parent.get("link"))]))
        )
    else:
        xyz = joint.find("origin").get("xyz", "0 0 0").split()
        k = draw.draw(st.integers(0, 2))
        other = (k + draw.draw(st.integers(1, 2))) % 3
        if kind == "sign":
            xyz[k] = xyz[k][1:] if xyz[k].startswith("-") else f"-{xyz[k]}"
        elif kind == "millimetres":
            xyz = [f"{1000.0 * float(each):.12g}" for each in xyz]
        elif kind == "exchanged coordinates":
            xyz[k], xyz[other] = xyz[other], xyz[k]
        elif kind == "digit":
            at = draw.draw(st.sampled_from([found.start() for found in re.finditer(r"\d", xyz[k])]))
            xyz[k] = xyz[k][:at] + draw.draw(st.sampled_from("123456789")) + xyz[k][at + 1 :]
            assume(len(xyz[k].replace(".", "").strip("-0")) > 1)
        elif kind == "decimal point":
            assume(float(xyz[k]))
            xyz[k] = format(Decimal(xyz[k]).scaleb(draw.draw(st.sampled_from((-2, -1, 1, 2)))), "f")
        else:
            place = pose.poses[joint.find("parent").get("link")].act(tuple(map(float, xyz)))
            xyz = [f"{value:.12f}" for value in place]
        joint.find("origin").set("xyz", " ".join(xyz))
    return f"'{joint.get('name')}'"


def is_same(one: Mechanism, other: Mechanism | None) -> bool:
    """Whether joints and closures are the same, to 2e-6 m; frames of two closures may be exchanged in pairs."""

    def places(mechanism: Mechanism) -> tuple[list[object], np.ndarray]:
        anchors = sorted((tuple((each.body, each.pose) for each in c.anchors) for c in mechanism.closures), key=repr)
        names = [(joint.name, joint.parent, joint.type, joint.axes) for joint in mechanism.joints]
        poses = [joint.placement for joint in mechanism.joints] + [pose for pair in anchors for _, pose in pair]
        bodies = [body for pair in anchors for body, _ in pair]
        return [names, bodies, [c.type for c in mechanism.closures]], np.array([(*p.xyz, *p.quaternion) for p in poses])

    if other is None:
        return False
    (names, poses), (other_names, other_poses) = places(one), places(other)
    return names == other_names and bool(np.abs(poses - other_poses).max(initial=0.0) <= 2e-6)


@pytest.mark.parametrize("kind", KINDS)
@given(draw=st.data(), name=st.sampled_from(NAMES))
@settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck))
def test_single_slip_is_named(
    kind: str, name: str, draw: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    mechanism, pose = posed(name)
    urdf = etree.parse(ROBOTS / name / "robot.urdf").getroot()
    yaml_ = yaml.safe_load((ROBOTS / name / "robot.yaml").read_text(encoding="utf-8"))
    what = slipped(draw, kind, pose, urdf, yaml_)
    folder = tmp_path_factory.mktemp("slip")
    (folder / "robot.urdf").write_bytes(etree.tostring(urdf))
    (folder / "robot.yaml").write_text(yaml.safe_dump(yaml_, default_flow_style=None), encoding="utf-8")
    read = read_robot(folder)
    assume(read.linked is not None)
    changed = StatedPose(read.mechanism, pose.coordinates)
    widths = [changed.opening(k) for k in range(len(changed.constraints))]
    assume(max(widths) > 1e-3)
    causes = causes_of_open_loops(read, changed, "assembled")
    mine = [cause for cause in causes if what in cause.question and restores(folder, cause, mechanism)]
    assert mine, (what, [cause.question for cause in causes])
    first = proposed(causes, sum(width > 1e-6 for width in widths))[0]
    if first.edits and first.edits != mine[0].fix.edits:  # sure, and yet another one: the trial is to refuse it
        (found,) = (each for each in eurdf.check(folder).diagnostics if each.code == "assembled-open")
        assert found.fix is None or is_same(mechanism, read_robot(folder, texts=found.fix.texts()).linked)


def restores(folder: Path, cause: Slip, mechanism: Mechanism) -> bool:
    """Whether the edits of a cause, if it has some, give a mechanism."""
    return not cause.fix.edits or is_same(mechanism, read_robot(folder, texts=cause.fix.texts()).linked)


@pytest.mark.parametrize("name", NAMES)
def test_openings_are_those_of_the_evaluator(name: str) -> None:
    robot = eurdf.load(ROBOTS / name, geometry=False)
    q = pin.integrate(robot.model, robot.configurations["assembled"], np.linspace(-0.3, 0.4, robot.model.nv))
    pose = StatedPose(robot.mechanism, robot.joint_positions(q, mimic=True))
    for index, expected in enumerate(closure_openings(robot, q)):
        assert abs(pose.opening(index) - expected.width) <= 1e-9


def edited(folder: Path, name: str, yaml_: str = "robot.yaml", *edits: tuple[str, str]) -> Path:
    """A copy of a robot of the collection in which texts of its files are replaced."""
    for file in ("robot.urdf", yaml_):
        text = (ROBOTS / name / file).read_text(encoding="utf-8")
        for old, new in edits:
            text = text.replace(old, new, 1)
        (folder / file.replace("v1.", "")).write_text(text, encoding="utf-8")
    return folder


def test_gap_across_a_planar_loop_is_called_unclosable(tmp_path: Path) -> None:
    folder = edited(tmp_path, "four_bar", "robot.yaml", ('<origin xyz="0.43 0 0"/>', '<origin xyz="0.43 0.0217 0"/>'))
    (found,) = eurdf.check(folder).diagnostics
    assert "by 21.7 mm along [0 1 0] of the root link, in which no joint moves it" in found.message
    assert "eurdf assemble" not in (found.hint or "")
    assert abs(eurdf.assemble(folder).open[0].position - 0.0217) < 1e-6


def test_assemble_keeps_what_is_stated(tmp_path: Path) -> None:
    folder = edited(tmp_path, "four_bar", "robot.yaml", ("assembled: {}", "assembled: {motor_crank: 0.2}"))
    assert main(["assemble", str(folder), "--write", "--force"]) == 0
    assert eurdf.check(folder).diagnostics == ()
    assert eurdf.load(folder).mechanism.configurations["assembled"]["motor_crank"] == (0.2,)


def test_axis_is_found_away_from_neutral(tmp_path: Path) -> None:
    folder = edited(tmp_path, "four_bar", "robot.yaml", ("assembled: {}", "assembled: {motor_crank: 0.2}"))
    assert main(["assemble", str(folder), "--write", "--force"]) == 0
    urdf = folder / "robot.urdf"
    before, joint, after = urdf.read_text(encoding="utf-8").partition('<joint name="free_rocker"')
    urdf.write_text(before + joint + after.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/>', 1), encoding="utf-8")
    (found,) = eurdf.check(folder).diagnostics
    assert "0 1 0 in place of 0 0 1 as the axis of joint 'free_rocker'" in (found.hint or "")
    assert found.fix is not None


def test_stated_root_is_no_cause(tmp_path: Path) -> None:
    shutil.copytree(ROBOTS / "four_bar", tmp_path / "four_bar")
    file = tmp_path / "four_bar" / "robot.yaml"
    text = yaml.safe_load(file.read_text(encoding="utf-8"))
    text |= {
        "root": "floating",
        "configurations": {"assembled": {"motor_crank": 0.3, "root_joint": [0, 0, 1, 0.6, 0, 0, 0.8]}},
    }
    file.write_text(yaml.safe_dump(text), encoding="utf-8")
    (found,) = eurdf.check(file).errors
    assert found.code == "assembled-open"
    assert "root_joint" not in str(found.hint)


def test_exchanged_frames_are_asked_about_without_assembled(tmp_path: Path) -> None:
    folder = edited(tmp_path, "digit_leg", "robot.v1.yaml")
    assert eurdf.check(folder).diagnostics == ()
    text = (folder / "robot.yaml").read_text(encoding="utf-8")
    pairs = yaml.safe_load(text)["closed_loop"]
    swapped = text.replace(pairs[1][1], "XX").replace(pairs[2][1], pairs[1][1]).replace("XX", pairs[2][1])
    (folder / "robot.yaml").write_text(swapped, encoding="utf-8")
    (found,) = eurdf.check(folder).diagnostics
    assert (found.code, found.fix) == ("x-open-at-neutral", None)
    assert "frame B of 'closure_2' and frame B of 'closure_3' are exchanged" in (found.hint or "")


def test_frame_is_found_by_name_where_no_pose_is_stated(tmp_path: Path) -> None:
    turned = ('<origin xyz="0.06 0 0.08"/>', '<origin xyz="0.06 0 0.08" rpy="0 0.3 0"/>')  # neutral is open
    folder = edited(tmp_path, "four_bar", "robot.v1.yaml", turned)
    assert eurdf.check(folder).diagnostics == ()
    edited(tmp_path, "four_bar", "robot.v1.yaml", turned, ("pin_a, rocker_pin_b", "pin_a, crank"))
    (found,) = eurdf.check(folder).diagnostics
    assert (found.code, found.fix is not None) == ("closure-cannot-close", True)
    assert "write 'rocker_pin_b' in place of 'crank'" in (found.hint or "")


@pytest.mark.parametrize(
    ("written", "value", "meant"),
    [
        ("-0.72", -0.27, "-0.27"),
        ("0.0314", 0.314, "0.314"),
        ("0.25", 0.2, "0.2"),
        ("0.15", 0.1735, None),
        ("0.3", 0.4, None),
        ("12.5", 0.125, "0.125"),
        ("-0.02", -0.2, "-0.2"),
        ("12.5", 0.0125, None),
        ("-0.08425679893", -0.08425673893, "-0.08425673893"),
    ],
)
def test_number_with_one_wrong_character_is_recognised(written: str, value: float, meant: str | None) -> None:
    assert with_one_slip(written, value, 1e-9) == meant


@pytest.mark.parametrize(
    ("name", "other"), [("left_knee", "right_knee"), ("foot_R", "foot_L"), ("leg.l.2", "leg.r.2"), ("lever", None)]
)
def test_names_of_both_sides_pair(name: str, other: str | None) -> None:
    assert other_side(name) == other
