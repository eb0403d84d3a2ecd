"""The files of a robot that its page without a server contains."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.commands.main import main
from eurdf.viewing.live_robot import live_page, live_view, page_robot, page_robot_of
from support.described import strut
from support.linkage import described, n_bar
from support.places import ROBOTS
from support.stl import TETRAHEDRON

MESHES = (
    '<robot name="a"><link name="a">'
    '<visual><geometry><mesh filename="corner.stl"/></geometry></visual>'
    '<collision><geometry><mesh filename="../outside.stl"/></geometry></collision>'
    "</link></robot>"
)


def content_of(page: str) -> Any:
    """What the page of a robot contains."""
    start = page.index('json">') + 6
    return json.loads(page[start : page.index("</script>", start)])


def test_page_has_the_two_files_as_they_are() -> None:
    content = content_of(live_view(page_robot(ROBOTS / "digit_leg")))
    for key, name in (("urdf", "robot.urdf"), ("description", "robot.yaml")):
        assert content[key] == {"name": name, "text": (ROBOTS / "digit_leg" / name).read_text(encoding="utf-8")}
    assert content["q"] is None
    bare = content_of(live_view(page_robot(ROBOTS / "digit_leg/robot.urdf")))
    assert bare["description"] is None


def test_other_root_than_that_of_the_files_is_written(tmp_path: Path) -> None:
    given = page_robot(ROBOTS / "four_bar", root="floating")
    (tmp_path / "robot.urdf").write_text(given.urdf, encoding="utf-8")
    assert given.description is not None
    (tmp_path / "robot.yaml").write_text(given.description, encoding="utf-8")
    robot = eurdf.load(tmp_path)
    assert robot.mechanism.root == "floating"
    assert [each.name for each in robot.constraints] == ["rocker_pin"]


def test_robot_in_memory_is_written_with_its_configuration(tmp_path: Path) -> None:
    urdf, yaml = described(n_bar(4))
    (tmp_path / "robot.urdf").write_text(urdf, encoding="utf-8")
    (tmp_path / "robot.yaml").write_text(f'extended_urdf: "2.0"\n{yaml}', encoding="utf-8")
    for robot in (eurdf.load(tmp_path), strut("spherical")):
        q = eurdf.assemble(robot).q
        given = page_robot_of(robot, q)
        assert given.description is not None
        again = eurdf.load(given.description, urdf=given.urdf)
        np.testing.assert_allclose(again.configuration(given.q), q, atol=1e-12)


@pytest.mark.parametrize("in_memory", [False, True])
def test_meshes_are_in_the_page_unless_they_are_outside(tmp_path: Path, in_memory: bool) -> None:
    folder = tmp_path / "robot"
    folder.mkdir()
    (tmp_path / "outside.stl").write_bytes(TETRAHEDRON)
    (folder / "corner.stl").write_bytes(TETRAHEDRON)
    (folder / "robot.urdf").write_text(MESHES)
    if in_memory:
        given = page_robot_of(eurdf.load(folder / "robot.urdf", allow_outside=True))
        assert given.meshes == {"corner.stl": TETRAHEDRON, "../outside.stl": TETRAHEDRON}
    else:
        given = page_robot(folder / "robot.urdf")
        assert given.meshes == {"corner.stl": TETRAHEDRON}
        assert list(given.left_out) == ["../outside.stl"]
    assert set(content_of(live_view(given))["meshes"]) == set(given.meshes)


def test_no_name_ends_the_content_of_the_page() -> None:
    attack = "</script><img src=x onerror=alert(1)><!--"
    quoted = attack.replace("<", "&lt;").replace(">", "&gt;")
    view = live_view(page_robot(f'<robot name="{quoted}"><link name="{quoted}"/></robot>'))
    assert view.count("<") == 4
    assert quoted in content_of(view)["urdf"]["text"]


def test_robot_with_errors_gets_no_page() -> None:
    with pytest.raises(eurdf.InvalidRobot, match="urdf-missing-element"):
        page_robot('<robot name="a"><link name="a"/><joint name="j" type="fixed"><parent link="a"/></joint></robot>')


def test_command_writes_a_page_that_needs_nothing_else(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "robot.urdf").write_text(MESHES)
    file = tmp_path / "page.html"
    assert main(["view", str(tmp_path / "robot.urdf"), "-o", str(file)]) == 0
    notes = capsys.readouterr().err.splitlines()
    assert [note.split(":")[0] for note in notes[:2]] == [
        f"the page does not show the mesh '{name}'" for name in ("corner.stl", "../outside.stl")
    ]
    assert notes[2:] == [f"wrote '{file}'"]
    page = file.read_text(encoding="utf-8")
    assert page.count("<script>") == 1
    assert content_of(page)["urdf"]["text"] == MESHES
    assert main(["view", "four_bar", "-o", str(file), "--force", "--trajectory", "walk.csv"]) == 2
    assert "leave out --trajectory or --output" in capsys.readouterr().err


def test_page_that_is_not_built_says_what_to_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("eurdf.viewing.page_files._FOLDER", tmp_path)
    with pytest.raises(FileNotFoundError, match="is not built"):
        live_page(page_robot(ROBOTS / "four_bar"))
    assert main(["view", "four_bar", "-o", str(tmp_path / "page.html")]) == 2
    assert "run: " in capsys.readouterr().err
