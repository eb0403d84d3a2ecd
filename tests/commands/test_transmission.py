"""``eurdf transmission``: tables, JSON and CSV of the map between motors and joints."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.commands.output import output_schemas

G1 = ["transmission", "unitree_g1_ankle", "--joints", "free_pitch", "free_roll"]
JOINTS = ("free_pitch", "free_roll")


def ran(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> tuple[str, str]:
    assert main(list(arguments)) == code
    captured = capsys.readouterr()
    return captured.out, captured.err


def validated(text: str) -> Any:
    found = json.loads(text)
    jsonschema.Draft202012Validator(output_schemas()["transmission.schema.json"]).validate(found)
    return found


def test_json_has_the_transmission_at_a_pose(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    pose = tmp_path / "q.json"
    pose.write_text('{"free_pitch": -0.5, "free_roll": [0.1]}', encoding="utf-8")
    found = validated(ran(capsys, *G1, "--at", str(pose), "--json")[0])
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    values, q, _ = eurdf.transmissions.actuator_values(robot, {"free_pitch": -0.5, "free_roll": 0.1})
    (at,) = found["poses"]
    assert at["joints"] == pytest.approx([-0.5, 0.1])
    assert at["motors"] == pytest.approx(list(values.values()), abs=1e-8)
    np.testing.assert_allclose(at["G"], eurdf.transmission(robot, JOINTS, q).G, atol=1e-7)
    limits, inertia = (
        eurdf.transmissions.serial_limits(robot, JOINTS, q),
        eurdf.transmissions.reflected_inertia(robot, JOINTS, q),
    )
    np.testing.assert_allclose(at["limits"]["torque"], limits.torque_axes, rtol=1e-6)
    np.testing.assert_allclose(at["limits"]["velocity_box"], limits.velocity_box, rtol=1e-6)
    np.testing.assert_allclose(at["inertia"]["linkage"], inertia.linkage, rtol=1e-6, atol=1e-12)
    assert found["linkage"] == list(inertia.bodies)
    assert found["common"]["torque_box"] == pytest.approx(at["limits"]["torque_box"])


def test_grid_finds_what_is_reached(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    table = tmp_path / "ankle.csv"
    out, err = ran(capsys, *G1, "--grid", "5", "--csv", str(table), "--json")
    common = validated(out)["common"]
    assert f"wrote 25 poses to '{table}'" in err
    with table.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    inside = [row for row in rows if row["reached"] == "1"]
    assert 0 < len(inside) < len(rows) == 25
    for row in inside[::4]:
        found = eurdf.transmissions.actuator_values(robot, {joint: float(row[joint]) for joint in JOINTS})
        assert float(row["motor_a"]) == pytest.approx(found.values["motor_a"], abs=1e-8)
        assert found.beyond == ()
        G = eurdf.transmission(robot, JOINTS, found.q).G
        assert float(row["G[motor_b,free_roll]"]) == pytest.approx(G[1, 1], abs=1e-7)
    # The common limits hold at each pose within limits.
    least = min(float(row["torque_max[free_pitch]"]) for row in inside)
    assert common["torque"][0][1] == pytest.approx(least)
    assert "already exists" in ran(capsys, *G1, "--csv", str(table), code=2)[1]


def test_table_shows_limits_and_inertia(capsys: pytest.CaptureFixture[str]) -> None:
    out, err = ran(capsys, *G1)
    for text in ("motors motor_a, motor_b", "per free_pitch", "-1.3785", "-68.808 to 68.808 N·m", "3.3972e-05 kg·m²"):
        assert text in out
    assert "the motors have no armature" in err
    out, _ = ran(capsys, *G1, "--grid", "3")
    assert "9 poses, " in out
    with pytest.raises(SystemExit):
        main([*G1, "--grid", "2", "--at", "assembled"])


def test_python_is_written_beside_c_or_neither(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    c, python = str(tmp_path / "c"), tmp_path / "training"
    _, err = ran(capsys, *G1, "--python", str(python))
    (file,) = python.iterdir()
    assert f"wrote '{file}'" in err
    before = file.stat().st_mtime_ns
    assert "--force replaces it" in ran(capsys, *G1, "--c", c, "--python", str(python), code=2)[1]
    assert not Path(c).exists()
    assert file.stat().st_mtime_ns == before
    ran(capsys, *G1, "--c", c, "--python", str(python), "--force")
    assert len(list(Path(c).iterdir())) == 2


def test_missing_map_exits_with_one(capsys: pytest.CaptureFixture[str]) -> None:
    out, err = ran(capsys, "transmission", "kangaroo_leg", "--joints", "free_ankle_y", "free_ankle_x", code=1)
    assert "add 'free_knee' to the joints" in err
    assert "per motor_leg_length" in out  # B_J still answers
    _, err = ran(capsys, "transmission", "kangaroo_leg", "--joints", "free_ankle_y", "--grid", "3", code=1)
    assert "to the joints" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--joints", "free_pich"], "did you mean 'free_pitch'"),
        (["--joints", "free_pitch", "--at", "nowhere"], "the configurations are: assembled"),
        (["--joints", "free_pitch", "--grid", "1"], "--grid 1 makes 1 poses; give 2 to 1000000"),
        (["--joints", "free_pitch", "--force"], "--force has no effect without --csv"),
        (["--joints", "free_pitch", "--single"], "--single has no effect without --c or --ros2; add one"),
        (["--joints", "universal_rod_a", "--grid", "3"], "has no limits"),
    ],
)
def test_wrong_arguments_are_refused(capsys: pytest.CaptureFixture[str], arguments: list[str], message: str) -> None:
    assert message in ran(capsys, "transmission", "unitree_g1_ankle", *arguments, code=2)[1]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[1]", "is no JSON object"),
        ("{", "cannot read"),
        ('{"free_pitch": "x"}', "actuated['free_pitch'] is 'x'"),
        ('{"free_pitch": -1.4, "free_roll": 0}', "the loops cannot be closed"),
    ],
)
def test_wrong_pose_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "q.json"
    file.write_text(text, encoding="utf-8")
    assert message in ran(capsys, *G1, "--at", str(file), code=2)[1]
