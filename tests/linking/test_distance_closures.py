"""Distances of descriptions, against the same mechanism with a massless rod in the tree."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import eurdf
from eurdf.commands.main import main
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


def written(folder: Path, yaml: str = DISTANCE, *more: str) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "robot.urdf").write_text(urdf(*CRANK, *more, *ROCKER), encoding="utf-8")
    (folder / "robot.yaml").write_text(yaml, encoding="utf-8")
    return folder


@pytest.fixture
def robot(tmp_path: Path) -> eurdf.Robot:
    return eurdf.load(written(tmp_path))


def closed(robot: eurdf.Robot) -> Any:
    return eurdf.forward_kinematics(robot, {"j0": 0.4})


def test_locked_distance_is_left_out(robot: eurdf.Robot) -> None:
    locked = eurdf.lock(robot, ["j0", "j2"], closed(robot))
    assert (locked.dropped_closures, locked.model.nv, len(locked.constraints)) == (("rod",), 1, 0)


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
