"""The robot on a page without a server: its scripts, run by node, give what the reference gives."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.viewing.live_robot import SCRIPTS, live_robot, live_view
from eurdf.viewing.scene import Scene
from eurdf.viewing.session import Session
from support.described import load, strut
from support.linkage import described, n_bar
from support.mechanisms import closed_tree
from support.places import ROOT
from support.stl import TETRAHEDRON

NODE = shutil.which("node")
PROGRAM = ROOT / "tests" / "support/live_robot.js"

needs_node = pytest.mark.skipif(NODE is None, reason="node is not installed")

Move = tuple[int, float]


def run(cases: Sequence[tuple[dict[str, Any], Sequence[Move]]]) -> list[list[dict[str, Any]]]:
    """What the scripts answer for each robot: its state at first, and after each move."""
    assert NODE is not None
    text = json.dumps([{"robot": data, "moves": moves} for data, moves in cases])
    command = [NODE, str(PROGRAM), str(SCRIPTS[0].parent)]
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr
    answers: list[list[dict[str, Any]]] = json.loads(done.stdout)
    return answers


def configuration(robot: eurdf.Robot, data: dict[str, Any], q: Sequence[Sequence[float]]) -> Any:
    """The configuration (nq,) with these coordinates of the joints."""
    return robot.configuration({joint["name"]: tuple(own) for joint, own in zip(data["joints"], q, strict=True) if own})


def poses(robot: eurdf.Robot, q: Any) -> Any:
    """Rotation and origin of each body in the world (n, 12)."""
    scene = Scene(robot, q)
    placed = [scene.at(q).pose(body) for body in range(len(scene.bodies))]
    return np.array([np.r_[pose.rotation.ravel(), pose.translation] for pose in placed])


def assert_same_kinematics(robot: eurdf.Robot, data: dict[str, Any], state: dict[str, Any]) -> None:
    """Poses, residual and, where the loops are closed, K of the scripts are those of the reference."""
    q = configuration(robot, data, state["q"])
    np.testing.assert_allclose(state["poses"], poses(robot, q), atol=1e-11)
    r, K = eurdf.residual_and_jacobian(robot, q)
    np.testing.assert_allclose(state["residual"], r, atol=1e-11)
    if np.abs(r).max(initial=0.0) > 1e-9:
        return
    found, row = np.zeros(K.shape), 0
    for constraint, columns in zip(robot.constraints, state["jacobian"], strict=True):
        for velocity, rows in columns:
            found[row : row + constraint.rows, velocity] = rows
        row += constraint.rows
    np.testing.assert_allclose(found, K, atol=1e-8)


@needs_node
def test_every_joint_and_constraint_has_the_kinematics_of_the_reference() -> None:
    robots = []
    for seed in range(4):
        robot, q = closed_tree(np.random.default_rng(seed), root="floating" if seed % 2 else "fixed")
        robot = robot.with_contacts({robot.mechanism.bodies[-1].name: "hinge"}, at=q)
        robots.append((robot, live_robot(robot, q)))
    for (robot, data), (state,) in zip(robots, run([(data, ()) for _, data in robots]), strict=True):
        assert state["largest"] < 1e-9
        assert_same_kinematics(robot, data, state)


@needs_node
def test_sliders_move_robots_as_the_viewer_does() -> None:
    cases, sessions = [], []
    for name, seed in (("digit_leg", 3), ("delta", 0), ("tello", 0), ("robotiq_2f85", 0)):
        robot = eurdf.load(name)
        session, random = Session(robot), np.random.default_rng(seed)
        moves: list[Move] = []
        for index in random.integers(len(session.sliders), size=4).tolist():
            slider = session.sliders[index]
            moves.append((index, slider.lower + float(random.uniform(-0.05, 1.05)) * (slider.upper - slider.lower)))
        cases.append((live_robot(robot), moves))
        sessions.append(session)
    ended = set()
    for session, (data, moves), (_, *states) in zip(sessions, cases, run(cases), strict=True):
        for (index, value), state in zip(moves, states, strict=True):
            expected = session.move(index, value)
            stop = state["stop"]
            if expected is None:
                assert stop is None
            else:
                ended.add(expected.reason)
                assert (stop["reason"], stop["joint"]) == (expected.reason, expected.joint)
                assert stop["value"] == pytest.approx(expected.value, abs=1e-6)
            assert state["largest"] < 1e-9
            assert_same_kinematics(session.robot, data, state)
            # The same branch; rods may spin about their lines, which no actuator controls.
            origins = poses(session.robot, session.q)[:, 9:]
            np.testing.assert_allclose(np.array(state["poses"])[:, 9:], origins, atol=1e-6)
    assert {"limit", "passive limit"} <= ended


@needs_node
@pytest.mark.slow
def test_every_robot_of_the_collection_moves_closed() -> None:
    robots = [eurdf.load(name, geometry=False) for name in eurdf.collection_names()]
    cases: list[tuple[dict[str, Any], list[Move]]] = []
    for robot in robots:
        data = live_robot(robot)
        slider = data["sliders"][-1]
        cases.append((data, [(len(data["sliders"]) - 1, 0.6 * slider["upper"] + 0.4 * slider["lower"])]))
    for robot, (data, _), (_, state) in zip(robots, cases, run(cases), strict=True):
        assert state["largest"] < 1e-9, robot.mechanism.name
        assert_same_kinematics(robot, data, state)


@needs_node
def test_springs_decide_the_motion_that_no_actuator_controls() -> None:
    urdf, yaml = described(n_bar(5, "3d"))
    robots = [
        load(urdf, f'extended_urdf: "2.1"\n{yaml}joints:\n{springs}')
        for springs in (
            "  j2: {stiffness: 7, rest: 0.2}\n",
            "  j1: {stiffness: 3, rest: 0.4}\n  j2: {stiffness: 7, rest: 0.2}\n",
        )
    ]
    answers = run([(live_robot(robot), [(0, 0.3)]) for robot in robots])
    for robot, (_, state) in zip(robots, answers, strict=True):
        q = configuration(robot, live_robot(robot), state["q"])
        np.testing.assert_allclose(q, eurdf.forward_kinematics(robot, [0.3]), atol=1e-6)
        assert state["largest"] < 1e-9


@needs_node
def test_actuator_with_a_pose_has_no_slider() -> None:
    robot = strut("spherical")
    data = live_robot(robot)
    assert data["sliders"] == []
    ((state,),) = run([(data, ())])
    assert state["largest"] < 1e-9
    assert_same_kinematics(robot, data, state)


def test_no_name_ends_the_data_of_the_page() -> None:
    attack = "</script><img src=x onerror=alert(1)><!--"
    quoted = attack.replace("<", "&lt;").replace(">", "&gt;")
    robot = load(f'<robot name="{quoted}"><link name="{quoted}"/></robot>')
    page = live_view(robot)
    assert page.count("<") == 4
    start, end = page.index('json">') + 6, page.index("</script>")
    assert json.loads(page[start:end])["bodies"] == [attack]


def test_command_writes_a_page_that_needs_nothing_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "page.html"
    assert main(["view", "four_bar", "-o", str(file)]) == 0
    assert capsys.readouterr().err == f"wrote '{file}'\n"
    page = file.read_text(encoding="utf-8")
    assert '"sliders":[{"joint":"motor_crank"' in page
    assert page.count("<script>") == len(SCRIPTS)
    assert not re.search(r"src=|href=|@import|url\(", page)
    assert main(["view", "four_bar", "-o", str(file), "--force", "--trajectory", "walk.csv"]) == 2
    assert "leave out --trajectory or --output" in capsys.readouterr().err


def test_data_of_a_mesh_are_its_triangles(tmp_path: Path) -> None:
    (tmp_path / "corner.stl").write_bytes(TETRAHEDRON)
    (tmp_path / "robot.urdf").write_text(
        '<robot name="a"><link name="a"><visual><geometry><mesh filename="corner.stl" scale="2 2 2"/></geometry>'
        '</visual><visual><geometry><box size="1 2 3"/></geometry></visual></link></robot>'
    )
    mesh, box = live_robot(eurdf.load(tmp_path / "robot.urdf"))["shapes"]
    corners = np.array(mesh["vertices"]).reshape(-1, 3)[mesh["triangles"]]
    assert corners.shape == (12, 3)
    assert corners.max() == 2.0
    assert box["size"] == [1.0, 2.0, 3.0]
