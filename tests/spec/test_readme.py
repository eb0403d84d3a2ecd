"""What the README shows is what happens."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from eurdf.commands.main import main
from support.places import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")


def _block(language: str) -> str:
    found = re.search(rf"^```{language}\n(.*?)^```", README, re.M | re.S)
    assert found
    return found[1]


def _joint(name: str, parent: str, child: str) -> str:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    return (
        f'<link name="{child}">{inertial}</link><joint name="{name}" type="continuous">'
        f'<parent link="{parent}"/><child link="{child}"/></joint>'
    )


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A robot for the description that the README shows."""
    tree = "".join(
        _joint(*names)
        for names in (("motor_hip", "base", "leg"), ("motor_knee", "leg", "foot"), ("rod_ball", "leg", "rod_tip"))
    )
    (tmp_path / "my_robot").mkdir()
    (tmp_path / "my_robot" / "robot.urdf").write_text(f'<robot name="r"><link name="base"/>{tree}</robot>')
    monkeypatch.chdir(tmp_path)
    return tmp_path / "my_robot" / "robot.yaml"


def test_shown_description_is_valid_apart_from_names(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot.write_text(_block("yaml"), encoding="utf-8")
    main(["check", "my_robot"])
    assert set(re.findall(r"\[([a-z-]+) EU", capsys.readouterr().out)) <= {"assembled-open"}


def test_shown_message_is_current(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot.write_text(_block("yaml").replace("[rod_tip", "[rod_tpi"), encoding="utf-8")
    assert main(["check", "my_robot"]) == 1
    _, shown = _block("console").split("\n", 1)
    assert capsys.readouterr().out.strip() == shown.strip()


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_shown_python_runs(page: str) -> None:
    names: dict[str, object] = {}
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)
    assert blocks
    for block in blocks:
        exec(block, names)


def test_first_command_runs_main_job(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    _, *commands = _block("sh").strip().split(" && ")
    for command in commands:
        assert main(command.split()[1:]) == 0
    assert "sound" in capsys.readouterr().out
