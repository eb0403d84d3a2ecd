"""`Export.verify` and ``eurdf export --verify``: right files pass, wrong ones do not, and causes are named."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.commands.output import output_schemas
from eurdf.convert.formats import EXPORTS
from eurdf.convert.verification import verify as module
from eurdf.errors import MissingExtra
from eurdf.mechanism.body import Inertia
from eurdf.pinocchio.robot import Robot, build_robot
from support.exported import hanging, random_robot
from support.places import ROBOTS
from support.plain_urdf import inertial, joint_element, link_element
from support.plain_urdf import robot as robot_element
from support.processes import on_a_terminal

PACKAGES = {"mjcf": "mujoco", "drake": "pydrake", "sdf": "pydrake", "usd": "pxr"}


def installed(to: str) -> None:
    if to in PACKAGES:
        pytest.importorskip(PACKAGES[to], exc_type=ImportError)


def findings(export: eurdf.convert.Export, **options: Any) -> str:
    return "\n".join(map(str, export.verify(**options).findings))


@pytest.mark.parametrize("to", EXPORTS)
def test_file_of_every_joint_and_closure_is_read_back(to: str) -> None:
    installed(to)
    for seed, root in ((0, "fixed"), (1, "floating")):
        robot, _ = random_robot(seed, root)
        if root == "floating":
            robot = build_robot(replace(robot.mechanism, root="floating"), geometry=False)
        found = eurdf.export(robot, to).verify(seconds=0.0)
        assert found.findings == ()
        assert bool(found.openings) == (to != "urdf")
        assert found.mass[0] == pytest.approx(found.mass[1], rel=1e-5)


def assert_stays_closed(export: eurdf.convert.Export) -> None:
    """At the start, and in the fall if the reader simulates it."""
    found = export.verify()
    assert found.findings == ()
    openings = found.openings if found.fall is None else found.fall.openings
    assert max((max(each.position, each.angle) for each in openings), default=0.0) < 1e-3


@pytest.mark.parametrize("to", [pytest.param(to, marks=pytest.mark.slow) if to != "mjcf" else to for to in EXPORTS])
@pytest.mark.parametrize("name", eurdf.collection_names())
def test_robot_of_the_collection_stays_closed(name: str, to: str) -> None:
    installed(to)
    assert_stays_closed(eurdf.export(name, to))


@pytest.mark.parametrize("to", ["mjcf", "drake"])
@pytest.mark.parametrize(
    ("mimic", "massless", "description"),
    [
        ("", "", "joints: {screw: {type: helical, pitch: 0.05}}"),
        ('<mimic joint="j" multiplier="0.5" offset="0.1"/>', "", "root: fixed"),
        ('<mimic joint="j" multiplier="0.5"/>', "b", "root: fixed"),
        ("", "", "couplings: [{name: gear, joints: {j: 1, k: -2}, offset: 0.2}]"),
        (
            "",
            "",
            "closures: [{name: rod, type: distance, length: 0.3,"
            " frames: [{link: a, xyz: [0, 0, -0.5]}, {link: b, xyz: [0, 0, -0.5]}]}]",
        ),
    ],
    ids=["helical", "mimic", "without mass", "coupling", "distance"],
)
def test_soft_relations_hold_in_the_fall(to: str, mimic: str, massless: str, description: str) -> None:
    installed(to)
    text = f'extended_urdf: "2.1"\n{description}\n'
    assert_stays_closed(eurdf.export(text, to, urdf=hanging(mimic, massless)))


@pytest.mark.parametrize("to", ["mjcf", "drake", "sdf", "usd"])
def test_listed_loss_is_no_error_and_hides_none(to: str) -> None:
    installed(to)
    links = [link_element("base", inertial()), link_element("plate", inertial(1.0, "", (1, 0, 0, 1, 0, 3)))]
    dynamics = '<axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    export = eurdf.export(robot_element(*links, joint_element("turn", "revolute", "base", "plate", dynamics)), to)
    found = export.verify(seconds=0.0)
    assert (found.findings, found.mass_matrix_error) == ((), pytest.approx(0.5, rel=1e-6))
    assert "the inertia of 1 link is changed [export-inertia]" in found.listed[0]
    name, text = next(iter(export.files)), export.main.decode()
    changed = re.sub(r"1\.5\d*", "1.6", text)
    assert changed != text
    wrong = replace(export, files={**export.files, name: changed.encode()})
    assert "the mass matrix differs" in findings(wrong, seconds=0.0)


CHANGES = {
    ("mjcf", r'mass="0.18"', 'mass="0.36"'): "the mass is",
    ("mjcf", r'(?s)(<body name="coupler".*?<inertial pos=")\S+', r"\g<1>0.05"): "mass matrix differs",
    ("mjcf", r'(name="rocker_pin/a" pos=")\S+', r"\g<1>1"): "constraints are open at the start: 'rocker_pin'",
    (
        "mjcf",
        r'(name="motor_crank" type="hinge")',
        r'\1 range="2 3"',
    ): "'motor_crank' is at .* outside its limits, 2 to 3",
    ("mjcf", r"<worldbody>", "<worldbody><nothing/>"): "MuJoCo .* refuses the file",
    ("drake", r'<mass value="0.18"/>', '<mass value="0.36"/>'): "the mass is",
    ("drake", r'(ball_constraint_p_AP value=")\S+', r"\g<1>1"): "constraints are open at the start: 'rocker_pin'",
    ("drake", r"<robot", "<robot robot"): "Drake .* refuses the file",
    ("sdf", r"<mass>0.18</mass>", "<mass>0.36</mass>"): "the mass is",
    ("usd", r"physics:mass = 0.18", "physics:mass = 0.36"): "the mass is",
    ("usd", r"(physics:localPos0 = \()[^,]+", r"\g<1>1"): "constraints are open at the start: 'rocker_pin'",
    ("urdf", r'<mass value="0.18"/>', '<mass value="0.36"/>'): "the mass is",
    ("urdf", r'(<limit lower=")\S+" upper="[^"]+', r'\g<1>2" upper="3'): "outside its limits, 2 to 3",
    ("loop-joint", r'(<link1 link="[^"]*" xyz=")\S+', r"\g<1>1"): "constraints are open at the start: 'rocker_pin'",
}


@pytest.mark.parametrize(("change", "expected"), CHANGES.items())
def test_wrong_file_is_an_error(change: tuple[str, str, str], expected: str) -> None:
    to, old, new = change
    installed(to)
    export = eurdf.export("four_bar", to)
    name, text = next(iter(export.files)), export.main.decode()
    head, mark, tail = text.partition('def Scope "closures"') if "localPos" in old else ("", "", text)
    changed = head + mark + re.sub(old, new, tail, count=1)
    assert changed != text
    assert re.search(expected, findings(replace(export, files={**export.files, name: changed.encode()}), seconds=0.0))


def flailing() -> Robot:
    """A five-bar linkage whose forearms weigh nothing, and whose joints have no limits."""
    mechanism = eurdf.load("five_bar", geometry=False).mechanism
    light = Inertia(1e-3, mechanism.bodies[2].inertia.pose, (1e-6, 0.0, 0.0, 1e-6, 0.0, 1e-6))
    bodies = tuple(
        replace(body, inertia=light) if body.inertia and re.match("forearm|tool", body.name) else body
        for body in mechanism.bodies
    )
    joints = tuple(
        replace(joint, properties=replace(joint.properties, lower=(), upper=(), damping=(), friction=()))
        for joint in mechanism.joints
    )
    return build_robot(replace(mechanism, bodies=bodies, joints=joints), geometry=False)


def test_singular_pose_is_named_as_the_cause() -> None:
    pytest.importorskip("mujoco")
    found = findings(eurdf.export(flailing(), "mjcf"))
    assert re.search("diverges at|constraints open by more than 5 mm or 0.29 degrees in the fall", found)
    assert re.search(r"close to a singular pose, at which 'free_\w+'", found)
    assert "no limits; limit the joints so that the loops do not get there" in found
    assert "with half the time step, 0.0005 s" in found


def test_gimbal_lock_and_implausible_mass_are_named_as_the_cause() -> None:
    pytest.importorskip("mujoco")
    rod = inertial(0.005, '<origin xyz="0.01 0 0"/>', (3e-7, 0, 0, 3e-7, 0, 1.6e-7))
    links = [link_element("base", inertial(2e5)), link_element("one"), link_element("two"), link_element("rod", rod)]
    joints = [
        joint_element("x", "continuous", "base", "one", '<axis xyz="1 0 0"/>', '<origin xyz="0 0 0" rpy="0.1 0 0"/>'),
        joint_element("y", "continuous", "one", "two", '<axis xyz="0 1 0"/>'),
        joint_element("z", "continuous", "two", "rod", '<axis xyz="0 0 1"/>'),
    ]
    found = findings(eurdf.export(robot_element(*links, *joints), "mjcf"))
    assert re.search(r"'[xz]' and '[xz]' move almost no mass", found)
    assert "link 'base' has a mass of 2e+05 kg" in found


def test_program_that_is_not_installed_is_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(module, "find_spec", lambda _: None)
    with pytest.raises(MissingExtra) as caught:
        eurdf.export("four_bar", "drake").verify()
    assert caught.value.extra == "drake"
    assert main(["export", "four_bar", "--to", "mjcf", "--verify", "-o", str(tmp_path / "out")]) == 2
    assert "[mujoco]" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_command_shows_the_comparison(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("mujoco")
    monkeypatch.chdir(tmp_path)
    assert main(["export", "four_bar", "--to", "mjcf", "--verify"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"read back by MuJoCo .*\n +mass: 1.4 kg, of the robot 1.4 kg\n +mass matrix: differs", out)
    assert "    simulated: 2 s, without control\n" in out
    assert re.search(r"'rocker_pin': open by 0 mm at the start, by up to 0\.\d+ mm in the simulation, at", out)
    assert main(["export", "four_bar", "--to", "urdf", "--verify", "--json", "-o", "plain"]) == 0
    found = json.loads(capsys.readouterr().out)
    jsonschema.validate(found, output_schemas()["export.schema.json"])
    assert found["verification"]["unverified"]


def test_error_ends_the_command_with_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = ROBOTS / "four_bar"
    (tmp_path / "robot.urdf").write_bytes((folder / "robot.urdf").read_bytes())
    text = (folder / "robot.yaml").read_text(encoding="utf-8")
    description = text.replace("configurations:", "configurations:\n  open: {motor_crank: 1}")
    assert description != text
    (tmp_path / "robot.yaml").write_text(description, encoding="utf-8")
    arguments = ["export", str(tmp_path), "--to", "loop-joint", "--verify", "--configuration", "open"]
    assert main([*arguments, "-o", str(tmp_path / "out")]) == 1
    assert re.search(
        r"error: constraints are open at the start: 'rocker_pin' by .*\n +`eurdf check` shows", capsys.readouterr().out
    )
    assert main([*arguments, "--json", "-o", str(tmp_path / "again")]) == 1
    (finding,) = json.loads(capsys.readouterr().out)["verification"]["findings"]
    assert finding["message"].startswith("constraints are open")


def test_progress_is_shown_on_a_terminal(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    at_once = (
        "import sys; from eurdf.__main__ import start; from eurdf.commands import terminal; "
        "terminal.progress_bar.__wrapped__.__defaults__ = (0.0,); sys.exit(start())"
    )
    arguments = ["export", "kangaroo_leg", "--to", "mjcf", "--verify", "-o", str(tmp_path / "out")]
    code, seen = on_a_terminal(["-c", at_once, *arguments])
    assert code == 0
    assert "simulating" in seen


@pytest.mark.parametrize("to", EXPORTS)
def test_links_without_mass_are_no_error(to: str) -> None:
    installed(to)
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    links = [link_element("base"), link_element("arm", inertial()), *map(link_element, ("tip", "finger", "nail"))]
    joints = [
        joint_element("turn", "revolute", "base", "arm", limit),
        joint_element("flange", "fixed", "arm", "tip"),
        joint_element("knuckle", "revolute", "tip", "finger", limit),
        joint_element("root", "fixed", "finger", "nail"),
    ]
    assert eurdf.export(robot_element(*links, *joints), to).verify().findings == ()
