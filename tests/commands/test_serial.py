"""``eurdf serial``, and what ``eurdf transmission`` writes for controllers and papers."""

from __future__ import annotations

import json
from pathlib import Path

import pinocchio as pin
import pytest

from eurdf.commands.main import main

G1 = ["unitree_g1_ankle", "--joints", "free_pitch", "free_roll"]


@pytest.mark.slow
def test_serial_robot_is_written_and_shown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "out"
    command = ["serial", *G1, "-o", str(folder), "--grid", "5", "--armature", "motor_a=0.0036", "motor_b=0.0036"]
    assert main(command) == 0
    shown = capsys.readouterr()
    assert "exact armature" in shown.out
    assert "0.122 kg are lumped onto others" in shown.out
    stated = json.loads((folder / "transmission.json").read_text(encoding="utf-8"))
    assert stated["joints"] == ["free_pitch", "free_roll"]
    model = pin.buildModelFromUrdf(str(folder / "urdf" / "robot.urdf"))
    assert model.effortLimit.tolist() == stated["torque"]
    assert main(command) == 2
    assert "--force replaces it" in capsys.readouterr().err
    assert main([*command, "--force", "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == stated


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--armature", "motor_c=1"], "armature names 'motor_c', which is no motor of these joints"),
        (["--grid", "2"], "at least 3 points"),
        (["--grid", "3"], "joint 'free_roll' has no range around q"),
        (["--degree", "0"], "degree is 0"),
    ],
)
def test_wrong_options_are_named(options: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["serial", *G1, "-o", "nowhere", "--grid", "5", *options]) == 2
    assert message in capsys.readouterr().err


def test_a_value_that_is_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["serial", *G1, "-o", "nowhere", "--armature", "motor_a"])
    assert "'motor_a' is not MOTOR=VALUE" in capsys.readouterr().err


def test_transmission_is_generated_as_c(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["transmission", *G1, "--c", str(tmp_path)]
    assert main(command) == 0
    name = "unitree_g1_ankle_transmission"
    assert {path.name for path in tmp_path.iterdir()} == {f"{name}.c", f"{name}.h"}
    assert f"{name}.h'" in capsys.readouterr().err
    assert main(command) == 2
    assert "--force replaces it" in capsys.readouterr().err
    assert main([*command, "--force", "--single"]) == 0
    assert "double" not in (tmp_path / f"{name}.c").read_text(encoding="utf-8")


@pytest.mark.slow
def test_transmission_is_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    drawn = tmp_path / "slider.png"
    robot = ["five_bar", "--joints", "motor_1"]
    assert main(["transmission", *robot, "--plot", str(drawn)]) == 0
    assert drawn.stat().st_size > 1000
    assert main(["transmission", *robot, "--plot", str(tmp_path / "figure.gif")]) == 2
    assert "a figure ends in .png, .svg or .pdf" in capsys.readouterr().err
