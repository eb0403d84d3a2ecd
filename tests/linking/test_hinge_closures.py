"""Hinges of descriptions: what is loaded, analysed and shown of them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.closures.hinge import HingeClosure
from eurdf.commands.main import main

ROBOTS = Path(__file__).parents[2] / "robots"


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


def test_hinge_leaves_a_four_bar_its_mobility(tmp_path: Path) -> None:
    robot = eurdf.load(hinged(tmp_path, "four_bar", "3d"), geometry=False)
    (closure,) = robot.constraints
    assert isinstance(closure, HingeClosure)
    assert closure.axes == ((0.0, 1.0, 0.0), (0.0, 1.0, 0.0))
    found = eurdf.analyze(robot)
    assert (found.nc, found.rank, found.mobility, found.redundant) == (5, 2, 1, 3)
    assert np.abs(eurdf.assemble(robot).residual).max() < 1e-9


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


def test_hinged_robot_has_no_error(tmp_path: Path) -> None:
    assert eurdf.check(hinged(tmp_path, "four_bar", "3d")).diagnostics == ()


def test_info_shows_version_and_hinge(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(hinged(tmp_path, "four_bar", "3d"))
    assert main(["info", path, "--json"]) == 0
    info = json.loads(capsys.readouterr().out)
    assert (info["version"], info["nc"], info["closure_list"][0]["type"]) == ("2.1", 5, "hinge")
    assert main(["info", path]) == 0
    shown = capsys.readouterr().out
    assert "Extended URDF 2.1" in shown
    assert "1 of hinge" in shown


def test_migrate_has_nothing_to_do_on_version_2_1(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = hinged(tmp_path, "four_bar", "3d")
    assert main(["migrate", str(path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert (answer["from"], answer["to"], answer["text"]) == ("2.1", "2.1", path.read_text(encoding="utf-8"))


def test_schema_of_version_2_1_knows_hinges(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema", "--version", "2.1"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert schema["$id"] == "urn:extended-urdf:schema:2.1"
    assert "axis" in schema["$defs"]["Hinge"]["properties"]
