"""Compliances of closures: carried for simulators with soft constraints, without effect on kinematics."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.mechanism.constraint import RIGID, Compliance

ROBOT = Path(__file__).parents[2] / "robots" / "four_bar"


def compliant(folder: Path, compliance: str) -> Path:
    """The four-bar, with a compliance of its 3d closure."""
    text = (ROBOT / "robot.yaml").read_text(encoding="utf-8").replace('"2.0"', '"2.1"')
    text = text.replace("    type: 3d\n", f"    type: 3d\n    compliance: {{{compliance}}}\n")
    (folder / "robot.urdf").write_bytes((ROBOT / "robot.urdf").read_bytes())
    (folder / "robot.yaml").write_text(text, encoding="utf-8")
    return folder


def test_compliance_changes_no_kinematics(tmp_path: Path) -> None:
    rigid = eurdf.load(ROBOT, geometry=False)
    robot = eurdf.load(compliant(tmp_path, "linear: 1.0e-6"), geometry=False)
    assert [closure.compliance for closure in robot.mechanism.closures] == [Compliance(1e-6, 0.0)]
    assert [closure.compliance for closure in rigid.mechanism.closures] == [RIGID]
    q = rigid.tree.integrate(eurdf.assemble(rigid).q, np.array([0.1, -0.2, 0.3]))
    for one, other in zip(eurdf.residual_and_jacobian(robot, q), eurdf.residual_and_jacobian(rigid, q), strict=True):
        np.testing.assert_array_equal(one, other)


def test_compliance_is_kept_where_joints_are_locked(tmp_path: Path) -> None:
    robot = eurdf.load(compliant(tmp_path, "linear: 1.0e-6"), geometry=False)
    locked = eurdf.lock(robot, ["motor_crank"])
    assert [closure.compliance for closure in locked.mechanism.closures] == [Compliance(1e-6, 0.0)]


def test_info_shows_compliance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(compliant(tmp_path, "linear: 2.5e-6, angular: 0"))
    assert main(["info", path, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["closure_list"][0]["compliance"] == [2.5e-6, 0.0]
    assert main(["info", path]) == 0
    assert "compliance 2.5e-06 m/N" in capsys.readouterr().out
