"""URDFs with loops of another dialect: the description that JavaScript writes, and what `eurdf import` reads."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

import eurdf
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.robot import build_robot
from support.open_four_bar import robot
from support.processes import JAVASCRIPT, why_not_installed
from support.same_mechanism import unlike

MISSING = why_not_installed("yaml", "saxes")
pytestmark = pytest.mark.skipif(bool(MISSING), reason=MISSING)

PROGRAM = """
import { readFileSync } from "node:fs";
import { closuresOfDialects } from "extended-urdf";
process.stdout.write(JSON.stringify(closuresOfDialects(readFileSync(0, "utf8"))));
"""

DRAKE = ' xmlns:drake="http://drake.mit.edu"'


def described(folder: Path, urdf: str) -> tuple[eurdf.Robot, list[str]]:
    """The robot of a URDF and the description that JavaScript writes for it, and the losses."""
    node = ["node", "--input-type=module", "-e", PROGRAM]
    done = subprocess.run(node, cwd=JAVASCRIPT, input=urdf.encode(), capture_output=True, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    (folder / "robot.urdf").write_text(urdf, encoding="utf-8")
    (folder / "robot.yaml").write_text(found["description"], encoding="utf-8")
    return eurdf.load(folder, geometry=False), found["losses"]


def parts(mechanism: Mechanism) -> list[Any]:
    return [mechanism.root, mechanism.joints, mechanism.closures, mechanism.couplings, mechanism.frames]


@pytest.mark.parametrize("name", ["digit_leg", "double_wishbone", "four_bar", "toddlerbot_2legs"])
def test_loop_joints_are_those_that_the_import_reads(name: str, tmp_path: Path) -> None:
    found, losses = described(tmp_path, eurdf.export(name, "loop-joint").main.decode())
    assert unlike(parts(found.mechanism), parts(eurdf.import_robot(tmp_path / "robot.urdf").mechanism), 1e-9) == []
    assert losses == []


PLUS = (
    '<loop name="pin" type="revolute"><predecessor link="top"><origin xyz="1 0 0" rpy="0 0 1"/></predecessor>'
    '<successor link="right"><origin xyz="0 0 1"/></successor><axis xyz="0 2 0"/></loop>'
    '<coupling name="belt"><predecessor link="top"/><successor link="right"/><ratio value="6"/></coupling>'
    '<loop_constraint name="older"><parent link="top"/><parent_origin xyz="1 0 0"/>'
    '<child link="right"/></loop_constraint>'
)
BALL = (
    '<drake:ball_constraint><drake:ball_constraint_body_A name="top"/><drake:ball_constraint_body_B name="right"/>'
    '<drake:ball_constraint_p_AP value="1 0 0"/><drake:ball_constraint_p_BQ value="0 0 1"/></drake:ball_constraint>'
    '<drake:frame name="tool" link="top" xyz="0 0 2" rpy="0 1 0"/>'
    '<transmission><joint name="a"/><actuator name="a"><drake:gear_ratio value="9"/>'
    '<drake:rotor_inertia value="0.1"/></actuator></transmission>'
)


@pytest.mark.parametrize("urdf", [robot(PLUS), robot(BALL, DRAKE)], ids=["urdf-plus", "drake"])
def test_other_loops_are_those_that_the_import_reads(urdf: str, tmp_path: Path) -> None:
    found, losses = described(tmp_path, urdf)
    expected = eurdf.import_robot(tmp_path / "robot.urdf").mechanism
    assert unlike(parts(found.mechanism), parts(expected), 1e-9) == []
    assert found.mechanism.actuators == expected.actuators
    assert losses == []


@pytest.mark.parametrize("name", ["five_bar", "tello"])  # several points of two links, tendons
def test_constraints_of_drake_leave_the_same_mobility(name: str, tmp_path: Path) -> None:
    found, _ = described(tmp_path, eurdf.export(name, "drake").main.decode())
    expected = build_robot(eurdf.import_robot(tmp_path / "robot.urdf").mechanism, geometry=False)
    assert eurdf.analyze(found).mobility == eurdf.analyze(expected).mobility


@pytest.mark.parametrize(
    ("content", "loss"),
    [
        ('<loop_joint name="l" type="prismatic"><link1 link="top"/><link2 link="right"/></loop_joint>', "'prismatic'"),
        ('<loop_joint name="l" type="fixed"><link1 link="top"/></loop_joint>', "two elements"),
        ('<loop_joint name="l" type="fixed"><link1 link="top" xyz="1 x 0"/><link2 link="c"/></loop_joint>', "'1 x 0'"),
        ('<constraint name="l"/>', "no import reads it"),
        ('<coupling name="l"><predecessor link="top"/><successor link="right"/></coupling>', "no <ratio>"),
    ],
)
def test_what_is_not_read_is_a_loss(content: str, loss: str, tmp_path: Path) -> None:
    found, (said,) = described(tmp_path, robot(content))
    assert said.startswith(f"<{content[1:].split()[0]}> 'l' is left out: ")
    assert loss in said
    assert not found.mechanism.constraints


def test_a_pin_without_an_axis_is_a_ball(tmp_path: Path) -> None:
    pin = '<loop_joint name="l" type="revolute"><link1 link="top" xyz="1 0 0"/><link2 link="right"/></loop_joint>'
    found, (loss,) = described(tmp_path, robot(pin))
    assert [closure.type for closure in found.mechanism.closures] == ["3d"]
    assert "states no axis" in loss
