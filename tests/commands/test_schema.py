"""The schema that generate, migrate and schema write to a file."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from eurdf.commands.main import main
from eurdf.format.schema import FILES, json_schema, schema_text
from eurdf.linking.robot_files import read_robot
from support.places import ROBOTS

ROBOT = ROBOTS / "four_bar"

WRITING = (
    ["generate", "robot.urdf", "-o", "new.yaml"],
    ["generate", "robot.urdf", "-o", "new.yaml", "--version", "1"],
    ["migrate", "old.yaml", "-o", "new.yaml"],
)
command = pytest.mark.parametrize("argv", WRITING, ids=["generate", "generate version 1", "migrate"])


def schema_file(argv: list[str]) -> str:
    return FILES["1"] if "1" in argv else FILES["2"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a URDF and a description of version 1, the current one."""
    shutil.copy(ROBOT / "robot.urdf", tmp_path)
    (tmp_path / "old.yaml").write_text("closed_loop: [[rocker_pin_a, rocker_pin_b]]\ntype: [3d]\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@command
def test_schema_is_written_beside_description(folder: Path, argv: list[str]) -> None:
    (folder / "deep").mkdir()
    moved = [argument.replace("new.yaml", "deep/new.yaml") for argument in argv]
    assert main(moved) == 0
    assert sorted(path.name for path in (folder / "deep").iterdir()) == sorted([schema_file(argv), "new.yaml"])
    text = (folder / "deep" / "new.yaml").read_text(encoding="utf-8")
    assert text.startswith(f"# yaml-language-server: $schema=./{schema_file(argv)}\n")
    assert str(folder) not in text
    version = "1" if "1" in argv else "2"
    assert (folder / "deep" / schema_file(argv)).read_text(encoding="utf-8") == schema_text(json_schema(version))


@command
def test_schema_none_writes_no_schema(folder: Path, argv: list[str]) -> None:
    assert main([*argv, "--schema", "none"]) == 0
    assert not list(folder.glob("*.json"))
    assert "$schema" not in (folder / "new.yaml").read_text(encoding="utf-8")


@command
def test_same_schema_is_unchanged(folder: Path, argv: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / schema_file(argv)
    laid_out = json.dumps(json_schema("1" if "1" in argv else "2"), separators=(",", ":"))
    path.write_text(laid_out, encoding="utf-8")
    assert main(argv) == 0
    assert path.read_text(encoding="utf-8") == laid_out
    assert path.name not in capsys.readouterr().err


@command
def test_existing_description_prevents_writing_schema(folder: Path, argv: list[str]) -> None:
    (folder / "new.yaml").write_text("mine", encoding="utf-8")
    assert main(argv) == 2
    assert not list(folder.glob("*.json"))


@pytest.mark.parametrize(
    ("output", "name"),
    [("leg.yaml", "leg"), ("leg.eurdf.yml", "leg"), ("left leg.yaml", "robot"), ("jambe_é.yaml", "robot")],
)
def test_robot_schema_is_named_after_description(folder: Path, output: str, name: str) -> None:
    assert main(["generate", "robot.urdf", "-o", output, "--schema", "robot"]) == 0
    schema = json.loads((folder / f"{name}.schema.json").read_text(encoding="utf-8"))
    assert "motor_crank" in schema["$defs"]["UrdfJointName"]["enum"]
    assert f"$schema=./{name}.schema.json\n" in (folder / output).read_text(encoding="utf-8")


def test_description_cannot_have_name_of_schema(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", "robot.urdf", "-o", FILES["2"]]) == 2
    assert "name of the schema" in capsys.readouterr().err


def test_migrated_description_keeps_schema_path(folder: Path) -> None:
    old = folder / "old.yaml"
    old.write_text(
        f"# yaml-language-server: $schema=schemas/{FILES['1']}\n" + old.read_text(encoding="utf-8"), encoding="utf-8"
    )
    (folder / "schemas").mkdir()
    (folder / "schemas" / FILES["2"]).write_text(schema_text(json_schema("2")), encoding="utf-8")
    assert main(["migrate", "old.yaml", "-o", "new.yaml"]) == 0
    text = (folder / "new.yaml").read_text(encoding="utf-8")
    assert text.startswith(f"# yaml-language-server: $schema=schemas/{FILES['2']}\n")
    assert not list(folder.glob("*.json"))


@pytest.mark.parametrize("argv", [["generate", "robot.urdf"], ["migrate", "old.yaml"], ["schema"]])
def test_dash_is_standard_output(folder: Path, argv: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(argv) == 0
    shown = capsys.readouterr()
    assert main([*argv, "-o", "-"]) == 0
    assert capsys.readouterr() == shown
    assert not (folder / "-").exists()


@pytest.mark.parametrize("argv", [["generate", "robot.urdf"], ["migrate", "old.yaml"]])
def test_standard_output_names_no_schema(folder: Path, argv: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(argv) == 0
    out, err = capsys.readouterr()
    assert "$schema" not in out
    assert "-o FILE" in err
    (folder / "new.yaml").write_text(out, encoding="utf-8")
    assert read_robot("new.yaml").mechanism is not None
    assert main([*argv, "--schema", "none"]) == 0
    assert "-o FILE" not in capsys.readouterr().err


@pytest.mark.parametrize("option", [[], ["--for", "robot.urdf"], ["--version", "1"]])
def test_schema_command_writes_atomically_without_overwriting(
    folder: Path, option: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["schema", *option]) == 0
    shown = capsys.readouterr().out
    file = folder / "mine.schema.json"
    assert main(["schema", *option, "-o", file.name]) == 0
    assert file.read_text(encoding="utf-8") == shown
    assert capsys.readouterr().out == ""
    file.write_text("mine", encoding="utf-8")
    assert main(["schema", *option, "-o", file.name]) == 2
    assert "--force" in capsys.readouterr().err
    assert file.read_text(encoding="utf-8") == "mine"
    assert main(["schema", *option, "-o", file.name, "--force"]) == 0
    assert file.read_text(encoding="utf-8") == shown
    assert main(["schema", *option, "-o", "nowhere/x.json"]) == 2
    assert "nowhere/x.json" in capsys.readouterr().err
