"""What a command prints is no command of a workflow, whatever names of files are; names that are meant."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.diagnostics.fix import nearest
from eurdf.diagnostics.wording import no_command, similar
from eurdf_conformance.visible import visible

NAME = "::error file=a::b"
MOVING = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
URDF = f"""<robot name="{NAME}"><link name="::a"/><link name="::b">{MOVING}</link>
<joint name="::add-mask::j" type="continuous"><parent link="::a"/><child link="::b"/></joint></robot>"""
SOUND = 'extended_urdf: "2.0"\nactuators: ["::add-mask::j"]\n'
COMMANDS = (
    ["check", NAME],
    ["check", NAME, NAME],
    ["check", f" {NAME}"],
    ["check", f"{NAME}/empty", "--allow-none"],
    ["check", f"--{NAME}\n{NAME}"],
    ["info", NAME],
    ["assemble", NAME],
    ["migrate", f"{NAME}/robot.v1.yaml", "-o", "new.yaml"],
    ["migrate", NAME, "-o", "new.yaml"],
    ["generate", f"{NAME}/robot.urdf", "-o", "new.yaml", "--schema", "none"],
    ["schema", "--for", f"{NAME}/lost.urdf"],
    ["robots", NAME],
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two robots in folders whose names begin as a command."""
    monkeypatch.chdir(tmp_path)
    for name in (NAME, f" {NAME}"):
        folder = tmp_path / name
        (folder / "empty").mkdir(parents=True)
        (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
        (folder / "robot.yaml").write_text(SOUND, encoding="utf-8")
        (folder / "robot.v1.yaml").write_text('name_mot: ["::add-mask::j"]\n', encoding="utf-8")
    return tmp_path


def printed(command: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    with contextlib.suppress(SystemExit):  # of wrong arguments
        main(command)
    return "".join(capsys.readouterr())


@pytest.mark.parametrize("has_error", [False, True])
@pytest.mark.parametrize("color", ["", "1"])
@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_no_line_is_a_command(
    folder: Path,
    command: list[str],
    color: str,
    has_error: bool,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("FORCE_COLOR", color)
    if has_error:
        for file in folder.glob("*/robot*.yaml"):
            file.write_text(file.read_text(encoding="utf-8") + 'closures: ["::error::x"]\n"::k": [\n', encoding="utf-8")
    text = printed(command, capsys)
    assert text.strip()
    assert [line for line in text.splitlines() if line.lstrip().startswith("::")] == []


def test_path_keeps_its_other_characters(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert printed(["check", NAME], capsys) == "\\x3a:error file=a::b: valid\n"


def test_no_line_of_an_exception_is_a_command(folder: Path) -> None:
    (folder / NAME / "robot.yaml").write_text("a: [\n", encoding="utf-8")
    with pytest.raises(eurdf.InvalidRobot) as caught:
        eurdf.load(NAME)
    assert [line for line in str(caught.value).splitlines() if line.lstrip().startswith("::")] == []


@pytest.mark.parametrize(
    ("line", "safe"), [("::a", r"\x3a:a"), (" ::a", r" \x3a:a"), (":a::b", ":a::b"), ("", ""), ("a ::b", "a ::b")]
)
def test_only_the_begin_of_a_line_is_changed(line: str, safe: str) -> None:
    assert no_command(line) == safe
    assert visible(line) == safe


def test_every_line_of_a_text_from_a_parser_is_no_command() -> None:
    assert visible("::a\n  ::b\nc ::d\n\n::e") == "\\x3a:a\n  \\x3a:b\nc ::d\n\n\\x3a:e"


@pytest.mark.parametrize(
    ("wrong", "known", "meant"),
    [
        ("left_ankle", ["left_knee", "left_ankle_motor"], ["left_ankle_motor"]),
        ("left_ankle_motor", ["left_ankle", "left_knee_motor"], ["left_ankle"]),
        ("left_knee_moto", ["left_knee", "left_knee_motor"], ["left_knee_motor"]),
        ("leg", ["leg_ankle_", "leg_hip"], ["leg_hip"]),
        ("left_leg", ["left_leg_ankle", "left_leg_hip"], ["left_leg_hip", "left_leg_ankle"]),
    ],
)
def test_name_that_continues_another_is_nearer_than_three_edits(wrong: str, known: list[str], meant: list[str]) -> None:
    assert nearest(wrong, similar(wrong, known)) == meant
