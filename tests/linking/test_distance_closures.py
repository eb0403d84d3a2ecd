"""Distances of descriptions, against the same mechanism with a massless rod in the tree."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.closures.distance import DistanceClosure
from eurdf.commands.main import main
from eurdf.kinematics.residual import acceleration_drift
from eurdf.pinocchio.constraint import NoConstraintModel
from support.described import body, revolute
from support.plain_urdf import robot as urdf

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
# The rod is turned about two axes, so it does not spin about its own line.
ROD = [
    '<link name="rod"/>',
    '<joint name="ball" type="continuous"><parent link="crank"/><child link="rod"/><origin xyz="0.4 0 0"/>'
    '<axis xyz="0 0 1"/></joint>',
]
WITH_ROD = """\
extended_urdf: "2.0"
closures:
  - {name: rod, type: 3d, frames: [{link: rod, xyz: [1, 0, 0]}, {link: rocker, xyz: [0.8, 0, 0]}]}
joints: {ball: {type: universal, axes: yz}}
actuators: [j0]
"""


def written(folder: Path, yaml: str = DISTANCE, *more: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "robot.urdf").write_text(urdf(*CRANK, *more, *ROCKER), encoding="utf-8")
    (folder / "robot.yaml").write_text(yaml, encoding="utf-8")
    return folder


@pytest.fixture
def robot(tmp_path: Path) -> eurdf.Robot:
    return eurdf.load(written(tmp_path))


@pytest.fixture
def twin(tmp_path: Path) -> eurdf.Robot:
    return eurdf.load(written(tmp_path / "twin", WITH_ROD, *ROD))


def closed(robot: eurdf.Robot) -> Any:
    return eurdf.forward_kinematics(robot, {"j0": 0.4})


def test_distance_is_read_with_its_length(robot: eurdf.Robot) -> None:
    (rod,) = robot.constraints
    assert isinstance(rod, DistanceClosure)
    assert (rod.name, rod.length, rod.a.body, rod.b.body) == ("rod", 1.0, "crank", "rocker")


def test_distance_removes_one_freedom(robot: eurdf.Robot) -> None:
    found = eurdf.analyze(robot)
    assert (found.nv, found.nc, found.rank, found.mobility, found.uncontrolled) == (3, 1, 1, 2, 1)


def test_distance_assembles_where_the_rod_in_the_tree_does(robot: eurdf.Robot, twin: eurdf.Robot) -> None:
    q, q_twin = closed(robot), closed(twin)
    assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
    names = ("j0", "j2", "wrist")
    one, other = (
        [q_[r.model.joints[r.model.getJointId(n)].idx_q] for n in names] for r, q_ in ((robot, q), (twin, q_twin))
    )
    np.testing.assert_allclose(one, other, atol=1e-9)


def test_dynamics_are_those_of_a_massless_rod(robot: eurdf.Robot, twin: eurdf.Robot) -> None:
    found = []
    for each in (robot, twin):
        q = closed(each)
        v = eurdf.dq_dq_actuated(each, q)[:, 0] * 1.5
        columns = [each.model.joints[each.model.getJointId(name)].idx_v for name in ("j0", "j2", "wrist")]
        found.append(eurdf.forward_dynamics(each, q, v, np.array([0.7])).a[columns])
    np.testing.assert_allclose(found[0], found[1], atol=1e-8)


def test_drift_is_the_second_derivative_of_the_residual(robot: eurdf.Robot) -> None:
    q, v, h = np.array([0.3, -0.4, 0.2]), np.array([0.7, 1.1, -0.3]), 1e-4
    r = [eurdf.residual(robot, pin.integrate(robot.model, q, t * v)) for t in (-h, 0.0, h)]
    np.testing.assert_allclose(acceleration_drift(robot, q, v), (r[0] - 2 * r[1] + r[2]) / h**2, atol=1e-6)


def test_locked_distance_is_left_out(robot: eurdf.Robot) -> None:
    locked = eurdf.lock(robot, ["j0", "j2"], closed(robot))
    assert (locked.dropped_closures, locked.model.nv, len(locked.constraints)) == (("rod",), 1, 0)


def test_distance_has_no_constraint_model_of_pinocchio(robot: eurdf.Robot) -> None:
    with pytest.raises(NoConstraintModel, match="distance"):
        _ = robot.constraint_models


def test_check_reports_a_distance_that_is_out_of_reach(tmp_path: Path) -> None:
    report = eurdf.check(written(tmp_path, DISTANCE.replace("length: 1}", "length: 10}")))
    found = next(each for each in report.diagnostics if each.code == "closure-cannot-close")
    assert "'rod' by" in found.message
    assert found.line == 3


def test_info_shows_the_distance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(written(tmp_path))
    assert main(["info", path, "--json"]) == 0
    (closure,) = json.loads(capsys.readouterr().out)["closure_list"]
    assert (closure["type"], closure["rows"], closure["bodies"]) == ("distance", 1, ["crank", "rocker"])
    assert main(["info", path]) == 0
    assert "1 of distance" in capsys.readouterr().out
