"""Couplings of descriptions: in every function of the kinematics, and against the same robot with a mimic joint."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.mechanism.constraint import Coupling
from support.described import body
from support.plain_urdf import joint_element
from support.plain_urdf import robot as urdf

HEAD = 'extended_urdf: "2.1"\n'
BELT = HEAD + "couplings: [{name: belt, joints: {j1: 2, j0: -1}, offset: 0.4}]\nactuators: [j0]\n"


def arm(content: str = "", kind: str = "continuous") -> str:
    """Two links in a row; j1 may have more content."""
    limit = '<limit lower="-9" upper="9" effort="9" velocity="9"/>' if kind == "revolute" else ""
    first = joint_element("j0", kind, "base", "upper", f'<axis xyz="0 0.6 0.8"/>{limit}')
    second = joint_element(
        "j1", kind, "upper", "lower", f'<axis xyz="0 1 0"/>{limit}{content}', '<origin xyz="0.5 0 0.1" rpy="0 0 0"/>'
    )
    return urdf(body("base"), body("upper"), body("lower"), first, second)


def written(folder: Path, yaml: str = BELT, text: str | None = None) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "robot.urdf").write_text(text or arm(), encoding="utf-8")
    (folder / "robot.yaml").write_text(yaml, encoding="utf-8")
    return folder


def at(robot: eurdf.Robot, angle: float) -> Any:
    return eurdf.forward_kinematics(robot, {"j0": angle})


@pytest.fixture
def belt(tmp_path: Path) -> eurdf.Robot:
    return eurdf.load(written(tmp_path))


@pytest.mark.parametrize("angle", [0.3, 9.0, -20.0])
def test_whole_turns_of_a_coupled_joint_count(belt: eurdf.Robot, angle: float) -> None:
    q = at(belt, angle)
    np.testing.assert_allclose(q, [angle, 0.5 * angle + 0.2], atol=1e-9)
    assert np.abs(eurdf.residual(belt, q)).max() < 1e-9


def test_locked_joint_moves_into_the_offset(belt: eurdf.Robot) -> None:
    locked = eurdf.lock(belt, ["j0"], at(belt, 0.7))
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
    folder = written(
        tmp_path, HEAD + "couplings: [{name: rack, joints: {b: 10, motor: -1}}]\nactuators: [motor]\n", text
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
    (found,) = eurdf.check(written(tmp_path, f"{HEAD}couplings:\n{items}actuators: [j0]\n")).diagnostics
    assert found.code == "closure-cannot-close"
    assert found.hint is not None
    assert "check the coefficients and offsets of the couplings" in found.hint


def test_check_reports_a_coupling_that_is_open_when_assembled(tmp_path: Path) -> None:
    yaml = BELT + "configurations: {assembled: {j0: 0.4, j1: 0.39}}\n"
    (found,) = eurdf.check(written(tmp_path, yaml)).diagnostics
    assert (found.code, found.line) == ("assembled-open", 4)
    assert "'belt' by 0.573 degrees" in found.message


def test_check_reports_dependent_actuators_of_a_coupling(tmp_path: Path) -> None:
    found = eurdf.check(written(tmp_path, BELT.replace("[j0]", "[j0, j1]"))).diagnostics
    assert [each.code for each in found] == ["x-dependent-actuators"]
    assert "coupled by coupling 'belt'" in found[0].message


def test_check_reports_a_coupling_without_actuator(tmp_path: Path) -> None:
    found = eurdf.check(written(tmp_path, BELT.replace("actuators: [j0]\n", ""))).diagnostics
    assert [(each.code, each.line) for each in found] == [("x-no-actuator", 2)]
    assert "1 coupling and no actuator" in found[0].message


def test_info_shows_couplings_as_equations(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(written(tmp_path))
    assert main(["info", path, "--json"]) == 0
    info = json.loads(capsys.readouterr().out)
    (coupling,) = info["coupling_list"]
    assert (info["couplings"], info["nc"], coupling["joints"], coupling["offset"]) == (
        1,
        1,
        {"j1": 2.0, "j0": -1.0},
        0.4,
    )
    assert main(["info", path]) == 0
    assert "2 j1 - j0 = 0.4" in capsys.readouterr().out


def test_assemble_writes_a_configuration_that_satisfies_the_coupling(tmp_path: Path) -> None:
    folder = written(tmp_path)
    assert main(["assemble", str(folder), "--write"]) == 0
    assert eurdf.check(folder).diagnostics == ()
    q = eurdf.load(folder).configurations["assembled"]
    assert abs(2.0 * q[1] - q[0] - 0.4) < 1e-12


def test_schema_of_a_robot_completes_coupled_joints(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = written(tmp_path)
    assert main(["schema", "--version", "2.1", "--for", str(folder / "robot.urdf")]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert list(schema["$defs"]["Coupling"]["properties"]["joints"]["properties"]) == ["j0", "j1"]
