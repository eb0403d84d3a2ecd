"""A description can name any file: what is outside its folder is reported, and never shown."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.diagnostics.text import report_lines
from support.stl import TETRAHEDRON

YAML = 'extended_urdf: "2.0"\nurdf: {}\n'
URDF = '<robot name="r"><link name="a"/></robot>'
SECRET = "PASSWORD=hunter2\n"
COMMANDS = (["check"], ["info"], ["assemble"], ["migrate", "-o", "new.yaml"])


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that is given, beside one that is not."""
    folder = tmp_path / "given"
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "robot.urdf").write_text(URDF, encoding="utf-8")
    (tmp_path / "other" / "secret").write_text(SECRET, encoding="utf-8")
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def names(folder: Path, urdf: str) -> Path:
    (folder / "robot.yaml").write_text(YAML.format(urdf), encoding="utf-8")
    return folder


def codes(report: eurdf.Report) -> list[str]:
    return [found.code for found in report.diagnostics]


def shown(report: eurdf.Report) -> str:
    return "\n".join("".join(piece for piece, _ in line) for line in report_lines(report))


@pytest.mark.parametrize("urdf", ["../other/robot.urdf", "linked.urdf", "linked/robot.urdf", "{0}/other/robot.urdf"])
def test_urdf_outside_folder_is_warned_or_refused(folder: Path, urdf: str) -> None:
    (folder / "linked.urdf").symlink_to("../other/robot.urdf")
    (folder / "linked").symlink_to("../other")
    names(folder, urdf.format(folder.parent))
    report = eurdf.check(folder)
    assert codes(report) == ["x-urdf-outside-folder"]
    assert (report.diagnostics[0].line, report.diagnostics[0].column) == (2, 7)
    assert eurdf.load(folder).model.nv == 0
    report = eurdf.check(folder, confined=True)
    assert codes(report) == ["file-unreadable"]
    with pytest.raises(eurdf.InvalidRobot, match="confined"):
        eurdf.load(folder, confined=True)


def test_urdf_inside_folder_is_not_confined(folder: Path) -> None:
    (folder / "urdf").mkdir()
    (folder / "urdf" / "a.urdf").write_text(URDF, encoding="utf-8")
    (folder / "robot.urdf").symlink_to("urdf/a.urdf")
    for urdf in ("urdf/a.urdf", "robot.urdf", "../given/urdf/a.urdf"):
        assert codes(eurdf.check(names(folder, urdf), confined=True)) == []


def test_urdf_that_caller_gives_may_be_anywhere(folder: Path) -> None:
    names(folder, "missing.urdf")
    assert codes(eurdf.check(folder, urdf="../other/robot.urdf", confined=True)) == []


def test_folder_of_links_into_one_folder_is_accepted(folder: Path) -> None:
    names(folder.parent / "other", "robot.urdf")
    for name in ("robot.yaml", "robot.urdf"):
        (folder / name).symlink_to(f"../other/{name}")
    assert codes(eurdf.check(folder)) == []


@pytest.mark.parametrize("urdf", ["../other/secret", "secret.urdf", "../other/missing"])
def test_confined_file_is_not_opened(folder: Path, monkeypatch: pytest.MonkeyPatch, urdf: str) -> None:
    (folder / "secret.urdf").symlink_to("../other/secret")
    names(folder, urdf)
    opened: list[str] = []
    original = os.open

    def recorded(path: str, *rest: int) -> int:
        opened.append(str(path))
        return original(path, *rest)

    monkeypatch.setattr(os, "open", recorded)
    assert codes(eurdf.check(folder, confined=True)) == ["file-unreadable"]
    assert [Path(path).name for path in opened] == ["robot.yaml"]


@pytest.mark.parametrize("urdf", ["../other/secret", "secret.urdf", "/proc/self/environ"])
def test_no_line_of_a_file_outside_is_shown(folder: Path, urdf: str) -> None:
    (folder / "secret.urdf").symlink_to("../other/secret")
    report = eurdf.check(names(folder, urdf))
    assert not report.ok
    assert " | " in shown(report)  # of the description
    for part in ("PASSWORD", "hunter2", "PATH="):
        assert part not in shown(report)


@pytest.mark.parametrize("name", ["robot.yaml", "robot.urdf"])
def test_no_line_of_a_linked_file_is_shown(folder: Path, name: str) -> None:
    (folder / name).symlink_to("../other/secret")
    report = eurdf.check(folder)
    assert not report.ok
    assert "hunter2" not in shown(report)
    assert codes(eurdf.check(folder, confined=True)) == ["file-unreadable"]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command[0])
def test_every_command_confines(folder: Path, command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    names(folder, "../other/robot.urdf")
    name, *options = command
    assert main([name, "robot.yaml", "--confined", *options]) == 1
    assert "files are confined to it" in "".join(capsys.readouterr())


def test_excerpt_is_that_of_the_text_that_was_read(folder: Path) -> None:
    names(folder, "robot.urdf\nclosurs: []")
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    report = eurdf.check(folder)
    (folder / "robot.yaml").unlink()
    os.mkfifo(folder / "robot.yaml")  # to open it would wait for a writer
    assert "    3 | closurs: []" in shown(report)


def test_pipe_that_becomes_a_file_is_an_error(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "robot.urdf").write_text(URDF, encoding="utf-8")
    monkeypatch.setattr("eurdf.reading.robot_source._is_pipe", lambda path: True)
    assert codes(eurdf.check("robot.urdf")) == ["file-unreadable"]


def test_mesh_outside_folder_is_warned_refused_or_read(folder: Path) -> None:
    (folder.parent / "other" / "a.stl").write_bytes(TETRAHEDRON)
    (folder / "inside.stl").write_bytes(TETRAHEDRON)
    (folder / "linked.stl").symlink_to("../other/a.stl")
    meshes = "".join(
        f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'
        for name in ("inside.stl", "linked.stl", "../other/a.stl")
    )
    (folder / "robot.urdf").write_text(f'<robot name="r"><link name="a">{meshes}</link></robot>', encoding="utf-8")
    urdf = folder / "robot.urdf"
    [found] = eurdf.check(urdf).diagnostics
    assert found.code == "x-file-outside-folder"
    assert "'linked.stl', '../other/a.stl'" in found.message
    robot = eurdf.load(urdf)
    assert robot.model.nv == 0
    with pytest.raises(eurdf.InvalidRobot, match="outside the folder"):
        _ = robot.visual_model
    assert codes(eurdf.check(urdf, confined=True)) == ["urdf-mesh-unreadable"] * 2
    with pytest.raises(eurdf.InvalidRobot):
        eurdf.load(urdf, confined=True)
    assert eurdf.load(urdf, allow_outside=True).visual_model.ngeoms == 3
    [found] = eurdf.check(urdf, allow_outside=True).diagnostics
    assert "are read all the same" in found.message
    assert codes(eurdf.check(urdf, package_dirs=["../other"])) == []
    with pytest.raises(ValueError, match="exclude each other"):
        eurdf.check(urdf, confined=True, allow_outside=True)


def test_meshes_beside_the_file_that_a_urdf_links_to_are_inside(folder: Path) -> None:
    (folder.parent / "other" / "a.stl").write_bytes(TETRAHEDRON)
    mesh = '<visual><geometry><mesh filename="a.stl"/></geometry></visual>'
    real = folder.parent / "other" / "real.urdf"
    real.write_text(f'<robot name="r"><link name="a">{mesh}</link></robot>', encoding="utf-8")
    (folder / "robot.urdf").symlink_to(real)
    (folder / "a.stl").symlink_to("../other/a.stl")
    assert codes(eurdf.check(folder / "robot.urdf")) == []


def test_folder_of_robot_may_be_a_link(folder: Path) -> None:
    package = folder.parent / "other"
    (package / "package.xml").write_text("<package><name>arm</name></package>", encoding="utf-8")
    (package / "a.stl").write_bytes(TETRAHEDRON)
    (package / "urdf").mkdir()
    meshes = "".join(
        f'<visual><geometry><mesh filename="{uri}"/></geometry></visual>' for uri in ("../a.stl", "package://arm/a.stl")
    )
    (package / "urdf" / "robot.urdf").write_text(f'<robot name="r"><link name="a">{meshes}</link></robot>')
    (folder / "linked").symlink_to(package / "urdf")
    assert codes(eurdf.check(folder / "linked" / "robot.urdf", confined=True)) == []


def test_mesh_of_another_format_is_a_warning(folder: Path) -> None:
    (folder / "a.fbx").write_bytes(b"Kaydara FBX Binary")
    mesh = '<visual><geometry><mesh filename="a.fbx"/></geometry></visual>'
    (folder / "robot.urdf").write_text(f'<robot name="r"><link name="a">{mesh}</link></robot>', encoding="utf-8")
    assert codes(eurdf.check(folder / "robot.urdf")) == ["x-mesh-format"]
    robot = eurdf.load(folder / "robot.urdf")
    with pytest.raises(eurdf.InvalidRobot, match=r"a\.fbx"):
        _ = robot.visual_model
