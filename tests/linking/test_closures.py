"""Couplings, distances, hinges and compliances of descriptions: what commands and checks say of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.mechanism.constraint import Compliance, Coupling
from support.described import body, revolute
from support.places import ROBOTS
from support.plain_urdf import joint_element
from support.plain_urdf import robot as urdf

LATER = 'extended_urdf: "2.1"\n'
BELT = LATER + "couplings: [{name: belt, joints: {j1: 2, j0: -1}, offset: 0.4}]\nactuators: [j0]\n"


def arm() -> str:
    """Two links in a row."""
    first = joint_element("j0", "continuous", "base", "upper", '<axis xyz="0 0.6 0.8"/>')
    second = joint_element("j1", "continuous", "upper", "lower", '<axis xyz="0 1 0"/>', '<origin xyz="0.5 0 0.1"/>')
    return urdf(body("base"), body("upper"), body("lower"), first, second)


def coupled_robot(folder: Path, yaml: str = BELT, text: str | None = None) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "robot.urdf").write_text(text or arm(), encoding="utf-8")
    (folder / "robot.yaml").write_text(yaml, encoding="utf-8")
    return folder


def turned(robot: eurdf.Robot, angle: float) -> Any:
    return eurdf.forward_kinematics(robot, {"j0": angle})


@pytest.fixture
def belt(tmp_path: Path) -> eurdf.Robot:
    return eurdf.load(coupled_robot(tmp_path))


@pytest.mark.parametrize("angle", [0.3, 9.0, -20.0])
def test_whole_turns_of_a_coupled_joint_count(belt: eurdf.Robot, angle: float) -> None:
    q = turned(belt, angle)
    np.testing.assert_allclose(q, [angle, 0.5 * angle + 0.2], atol=1e-9)
    assert np.abs(eurdf.residual(belt, q)).max() < 1e-9


def test_locked_joint_moves_into_the_offset(belt: eurdf.Robot) -> None:
    locked = eurdf.lock(belt, ["j0"], turned(belt, 0.7))
    assert (locked.dropped_closures, locked.model.nv) == ((), 1)
    assert locked.constraints == (Coupling("belt", (("j1", 2.0),), 1.1),)


def test_leader_of_an_earlier_mimic_joint_can_be_coupled(tmp_path: Path) -> None:
    """Its coordinate is a joint of the model without a link, of which the checks take no notice."""
    prismatic = '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="9" velocity="9"/>'
    joints = [
        joint_element("a", "prismatic", "base", "thumb", f'{prismatic}<mimic joint="b" multiplier="-1"/>'),
        joint_element("b", "prismatic", "base", "finger", prismatic),
        joint_element("motor", "continuous", "base", "rotor", '<axis xyz="1 0 0"/>'),
    ]
    text = urdf(body("base"), body("thumb"), body("finger"), body("rotor"), *joints)
    folder = coupled_robot(
        tmp_path, LATER + "couplings: [{name: rack, joints: {b: 10, motor: -1}}]\nactuators: [motor]\n", text
    )
    assert eurdf.check(folder).diagnostics == ()
    robot = eurdf.load(folder)
    q = eurdf.forward_kinematics(robot, {"motor": 2.0})
    pin.framesForwardKinematics(robot.model, robot.data, q)
    heights = [robot.data.oMf[robot.model.getFrameId(name)].translation[2] for name in ("finger", "thumb")]
    np.testing.assert_allclose(heights, [0.2, -0.2], atol=1e-9)


def test_check_reports_contradicting_couplings(tmp_path: Path) -> None:
    joints = ["{j0: 1, j1: 1}", "{j0: 1, j1: -1}", "{j0: 3, j1: 1}, offset: 0.5"]
    items = "".join(f"  - {{name: c{index}, joints: {each}}}\n" for index, each in enumerate(joints))
    (found,) = eurdf.check(coupled_robot(tmp_path, f"{LATER}couplings:\n{items}actuators: [j0]\n")).diagnostics
    assert found.code == "closure-cannot-close"
    assert "the offset of 'c2' is 0, not 0.5" in (found.hint or "")


def test_check_reports_a_coupling_that_is_open_when_assembled(tmp_path: Path) -> None:
    yaml = BELT + "configurations: {assembled: {j0: 0.4, j1: 0.39}}\n"
    (found,) = eurdf.check(coupled_robot(tmp_path, yaml)).diagnostics
    assert (found.code, found.line) == ("assembled-open", 4)
    assert "'belt' by 0.573 degrees" in found.message


@pytest.mark.parametrize(
    ("right", "wrong"), [("offset: 0.4", "offset: -0.4"), ("j1: 2", "j1: -2"), ("j1: 2", "j1: 21")]
)
def test_wrong_number_of_a_coupling_is_named(tmp_path: Path, right: str, wrong: str) -> None:
    yaml = BELT + "configurations: {assembled: {j0: 0.4, j1: 0.4}}\n"
    assert eurdf.check(coupled_robot(tmp_path / "right", yaml)).diagnostics == ()
    (found,) = eurdf.check(coupled_robot(tmp_path / "wrong", yaml.replace(right, wrong, 1))).diagnostics
    assert found.code == "assembled-open"
    good, bad = right.split()[1], wrong.split()[1]
    assert any(text in (found.hint or "") for text in (f"{good}, not {bad}", f"write {good} in place of {bad}"))


def test_check_reports_dependent_actuators_of_a_coupling(tmp_path: Path) -> None:
    found = eurdf.check(coupled_robot(tmp_path, BELT.replace("[j0]", "[j0, j1]"))).diagnostics
    assert [each.code for each in found] == ["x-dependent-actuators"]
    assert "coupled by coupling 'belt'" in found[0].message


def test_check_reports_a_coupling_without_actuator(tmp_path: Path) -> None:
    found = eurdf.check(coupled_robot(tmp_path, BELT.replace("actuators: [j0]\n", ""))).diagnostics
    assert [(each.code, each.line) for each in found] == [("x-no-actuator", 2)]
    assert "1 coupling and no actuator" in found[0].message


def test_assemble_writes_a_configuration_that_satisfies_the_coupling(tmp_path: Path) -> None:
    folder = coupled_robot(tmp_path)
    assert main(["assemble", str(folder), "--write"]) == 0
    assert eurdf.check(folder).diagnostics == ()
    q = eurdf.load(folder).configurations["assembled"]
    assert abs(2.0 * q[1] - q[0] - 0.4) < 1e-12


CRANK = [body("base"), body("crank"), revolute("j0", "base", "crank", (0, 0.1, 1))]
ROCKER = [
    body("rocker"),
    revolute("j2", "base", "rocker", (0.3, 0.1, 1), '<origin xyz="1 0 0.1" rpy="0 0 0"/>'),
    body("tool"),
    revolute("wrist", "rocker", "tool", (1, 0, 0), '<origin xyz="0.8 0 0" rpy="0 0 0"/>'),
]
DISTANCE = """\
extended_urdf: "2.1"
closures:
  - {name: rod, type: distance, frames: [{link: crank, xyz: [0.4, 0, 0]}, {link: rocker, xyz: [0.8, 0, 0]}], length: 1}
actuators: [j0]
"""


def tied_robot(folder: Path, yaml: str = DISTANCE, *more: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "robot.urdf").write_text(urdf(*CRANK, *more, *ROCKER), encoding="utf-8")
    (folder / "robot.yaml").write_text(yaml, encoding="utf-8")
    return folder


def test_check_reports_a_distance_that_is_out_of_reach(tmp_path: Path) -> None:
    report = eurdf.check(tied_robot(tmp_path, DISTANCE.replace("length: 1}", "length: 10}")))
    found = next(each for each in report.diagnostics if each.code == "closure-cannot-close")
    assert "'rod' by" in found.message
    assert found.line == 3


def hinged(folder: Path, name: str, closure: str) -> Path:
    """A robot of the collection, with its 3d closure as a hinge."""
    source = ROBOTS / name
    text = (source / "robot.yaml").read_text(encoding="utf-8")
    assert text.count(f"type: {closure}") == 1
    text = text.replace('"2.0"', '"2.1"')
    path = folder / "robot.yaml"
    path.write_text(text.replace(f"type: {closure}", "type: hinge\n    axis: [0, 1, 0]"), encoding="utf-8")
    (folder / "robot.urdf").write_bytes((source / "robot.urdf").read_bytes())
    return path


def test_gains_of_both_constraint_models_of_hinge_must_agree(tmp_path: Path) -> None:
    robot = eurdf.load(hinged(tmp_path, "four_bar", "3d"), geometry=False)
    q, v = eurdf.assemble(robot).q, np.zeros(3)
    _, (origin, on_axis), *_ = robot
    name = robot.constraints[0].name
    assert (origin.name, on_axis.name) == (name, f"{name}/axis")
    origin.m_baumgarte_parameters.Kp = 400.0
    with pytest.raises(ValueError, match=rf"'{name}' have different gains .*400.*set the same gains"):
        eurdf.forward_dynamics(robot, q, v)
    on_axis.m_baumgarte_parameters.Kp = 400.0
    moved = pin.integrate(robot.model, q, 1e-6 * np.arange(3))
    found, expected = (eurdf.forward_dynamics(robot, moved, v, gains=gains).a for gains in (None, (400.0, 0.0)))
    np.testing.assert_allclose(found, expected, atol=1e-12)


FOUR_BAR = ROBOTS / "four_bar"


def compliant(folder: Path, compliance: str) -> Path:
    """The four-bar, with a compliance of its 3d closure."""
    text = (FOUR_BAR / "robot.yaml").read_text(encoding="utf-8").replace('"2.0"', '"2.1"')
    text = text.replace("    type: 3d\n", f"    type: 3d\n    compliance: {{{compliance}}}\n")
    (folder / "robot.urdf").write_bytes((FOUR_BAR / "robot.urdf").read_bytes())
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    return folder


def test_compliance_is_kept_where_joints_are_locked(tmp_path: Path) -> None:
    robot = eurdf.load(compliant(tmp_path, "linear: 1.0e-6"), geometry=False)
    locked = eurdf.lock(robot, ["motor_crank"])
    assert [closure.compliance for closure in locked.mechanism.closures] == [Compliance(1e-6, 0.0)]


@pytest.mark.parametrize(
    ("make", "known", "shown"),
    [
        (coupled_robot, {"couplings": 1, "nc": 1}, "2 j1 - j0 = 0.4"),
        (tied_robot, {"nc": 1}, "1 of distance"),
        (lambda folder: hinged(folder, "four_bar", "3d"), {"version": "2.1", "nc": 5}, "1 of hinge"),
        (lambda folder: compliant(folder, "linear: 2.5e-6, angular: 0"), {"nc": 3}, "compliance 2.5e-06 m/N"),
    ],
    ids=["coupling", "distance", "hinge", "compliance"],
)
def test_info_shows_what_version_2_1_adds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], make: Any, known: dict[str, Any], shown: str
) -> None:
    path = str(make(tmp_path))
    assert main(["info", path, "--json"]) == 0
    info = json.loads(capsys.readouterr().out)
    assert {name: info[name] for name in known} == known
    for each in info["coupling_list"]:
        assert (each["joints"], each["offset"]) == ({"j1": 2.0, "j0": -1.0}, 0.4)
    for each, closure in zip(info["closure_list"], eurdf.load(path, geometry=False).mechanism.closures, strict=True):
        assert (each["type"], each["rows"]) == (closure.type, closure.rows)
        assert each["bodies"] == [closure.a.body, closure.b.body]
        assert each["compliance"] == [closure.compliance.linear, closure.compliance.angular]
    assert main(["info", path]) == 0
    assert shown in capsys.readouterr().out


def test_copied_closure_gets_the_frames_that_no_closure_uses() -> None:
    text = (ROBOTS / "robotiq_2f85" / "robot.yaml").read_text(encoding="utf-8")
    frames = "[left_tip_a, left_tip_b]", "[right_tip_a, right_tip_b]"
    copied = text.replace(frames[1], frames[0])
    assert copied.count(frames[0]) == 2
    (found,) = eurdf.check(copied, urdf=ROBOTS / "robotiq_2f85" / "robot.urdf").diagnostics
    assert found.code == "closure-duplicate"
    assert found.fix is not None
    assert [*found.fix.texts().values()] == [text]


def test_doubled_closure_is_removed_where_all_frames_are_used() -> None:
    text = (ROBOTS / "four_bar" / "robot.yaml").read_text(encoding="utf-8")
    doubled = text.replace(
        "closures:\n", "closures:\n  - {name: again, type: 3d, frames: [rocker_pin_a, rocker_pin_b]}\n"
    )
    (found,) = eurdf.check(doubled, urdf=ROBOTS / "four_bar" / "robot.urdf").diagnostics
    assert found.code == "closure-duplicate"
    assert found.fix is not None
    assert found.fix.summary == "remove closure 'rocker_pin'"


def test_closure_of_one_body_gets_the_frame_of_the_other_side() -> None:
    text = (ROBOTS / "four_bar" / "robot.yaml").read_text(encoding="utf-8")
    wrong = text.replace("[rocker_pin_a, rocker_pin_b]", "[rocker_pin_a, coupler]")
    (found,) = eurdf.check(wrong, urdf=ROBOTS / "four_bar" / "robot.urdf").diagnostics
    assert found.code == "closure-same-body"
    assert found.fix is not None
    assert [*found.fix.texts().values()] == [text]
