"""What is found in documents that are open, saved or not."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")

from lsprotocol import types as lsp

import eurdf
from eurdf.editor.open_robots import OpenRobots
from eurdf.editor.shown import shown
from eurdf_conformance.corpus.case import TOPICS, InvalidCase
from eurdf_conformance.corpus.read import all_cases
from support.described import ARM, ARM_DESCRIPTION, written
from support.places import ROBOTS
from support.typed import checked, opened, place_of

XACRO = """\
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm">
  <link name="base"/>
  <link name="tip">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="turn" type="{type}"><parent link="base"/><child link="tip"/></joint>
</robot>
"""


def codes(robots: OpenRobots, path: Path) -> list[str]:
    return [each.code for each in robots.found().get(str(path), ())]


@pytest.mark.parametrize("topic", TOPICS)
def test_invalid_cases_are_found_where_check_finds_them_in_texts_that_are_not_saved(topic: str) -> None:
    for case in all_cases():
        if not isinstance(case.case, InvalidCase) or case.topic != topic:
            continue
        robots = opened(*(path for path in (case.description, case.urdf) if path.is_file()))
        for path, document in robots.documents.opened.items():
            # What no editor has as a text is read from the file.
            document.is_saved = document.text.encode() != Path(path).read_bytes()
        robot = str(case.description)
        checked(robots, robot)
        for found in eurdf.check(case.description).diagnostics:
            path = robots.documents.shown(found.file)
            line, column = (found.line or 1) - 1, (found.column or 1) - 1
            before = robots.documents.text(path).replace("\r\n", "\n").replace("\r", "\n").split("\n")[line][:column]
            starts = [(each.code, shown(robots, path, each).range.start) for each in robots.found()[path]]
            assert (found.code, lsp.Position(line, len(before.encode("utf-16-le")) // 2)) in starts, case.name


def test_every_robot_of_the_collection_is_free_of_errors() -> None:
    for file in sorted(ROBOTS.glob("*/robot.yaml")):
        robots = opened(file, file.with_name("robot.urdf"))
        assert not any(robots.found().values()), file


def test_files_that_are_not_written_yet_are_a_robot(tmp_path: Path) -> None:
    robots = opened(tmp_path / "robot.yaml", tmp_path / "robot.urdf", robot_yaml=ARM_DESCRIPTION, robot_urdf=ARM)
    assert not any(robots.found().values())
    assert not any(tmp_path.iterdir())
    robots.documents.close((tmp_path / "robot.urdf").as_uri())
    checked(robots, str(tmp_path / "robot.yaml"))
    assert codes(robots, tmp_path / "robot.yaml") == ["urdf-not-found"]


def test_a_urdf_is_checked_with_the_description_beside_it(tmp_path: Path) -> None:
    written(tmp_path, ARM, ARM_DESCRIPTION)
    robots = opened(tmp_path / "robot.urdf", robot_urdf=ARM.replace('name="shoulder"', 'name="sholder"'))
    assert "unknown-actuator" in codes(robots, tmp_path / "robot.yaml")


def test_a_urdf_named_by_another_path_is_the_one_that_is_open(tmp_path: Path) -> None:
    written(tmp_path, ARM, ARM_DESCRIPTION)
    (tmp_path / "other").mkdir()
    (tmp_path / "link.urdf").symlink_to(tmp_path / "robot.urdf")
    for name in ("../robot.urdf", "../link.urdf"):
        file = tmp_path / "other" / "robot.yaml"
        file.write_text(f"{ARM_DESCRIPTION}urdf: {name}\n", encoding="utf-8")
        robots = opened(file, tmp_path / "robot.urdf", robot_urdf=ARM.replace("<robot", "<robots"))
        assert codes(robots, tmp_path / "robot.urdf") == ["xml-syntax"]


def test_other_files_are_left_alone(tmp_path: Path) -> None:
    (tmp_path / "compose.yaml").write_text("services: [", encoding="utf-8")
    robots = opened(tmp_path / "compose.yaml")
    assert not robots.documents.opened
    for uri in ("untitled:Untitled-1", "file:///robot%00.yaml", "http://host/robot.yaml", "file:///a.txt"):
        assert robots.documents.change(uri, "closures: []") is None


def test_half_a_character_is_no_error_of_the_server(tmp_path: Path) -> None:
    robots = opened(tmp_path / "robot.yaml", robot_yaml='extended_urdf: "\ud800"\n')
    assert codes(robots, tmp_path / "robot.yaml")


def test_places_count_as_the_editor_does(tmp_path: Path) -> None:
    text = '{extended_urdf: "2.0", metadata: {x: "𝄞𝄞"}, root: sinking}\n'
    for encoding, width in (("utf-16", 2), ("utf-8", 4), ("utf-32", 1)):
        robots = OpenRobots()
        robots.documents.encoding = encoding
        path = robots.documents.change((tmp_path / "robot.yaml").as_uri(), text)
        assert path is not None
        checked(robots, path)
        (found,) = [shown(robots, path, each) for each in robots.found()[path]]
        column = text.index("sinking")
        assert found.range.start.character == column + 2 * (width - 1)


def test_a_named_xacro_is_expanded_once_until_it_is_saved(tmp_path: Path) -> None:
    pytest.importorskip("xacro", reason="xacro is not installed: pip install -e '.[test]'")
    file, xacro = tmp_path / "robot.yaml", tmp_path / "arm.urdf.xacro"
    xacro.write_text(XACRO.format(type="continous"), encoding="utf-8")
    file.write_text('extended_urdf: "2.0"\nurdf: arm.urdf.xacro\n', encoding="utf-8")
    robots = opened(file, xacro)
    assert codes(robots, xacro) == ["urdf-joint-type"]
    (found,) = robots.found()[str(xacro)]
    assert shown(robots, str(xacro), found).range.start.line == place_of(XACRO, "<joint").line
    xacro.write_text(XACRO.format(type="continuous"), encoding="utf-8")
    checked(robots, str(file))
    assert codes(robots, xacro) == ["urdf-joint-type"]
    robots.saved(str(xacro))
    checked(robots, str(file))
    assert codes(robots, xacro) == []


def test_a_xacro_of_its_own_is_not_run(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf.xacro"
    text = XACRO.format(type="${__import__('os').mkdir('made')}")
    file.write_text(text, encoding="utf-8")
    assert codes(opened(file), file) == []
    assert codes(opened(file, arm_urdf_xacro=text.replace("</robot>", "")), file) == ["xml-syntax"]
    assert not os.path.exists("made")


def test_names_stay_known_while_a_file_has_an_error_of_syntax() -> None:
    file = ROBOTS / "four_bar" / "robot.yaml"
    robots = opened(file, file.with_name("robot.urdf"))
    names = {kind: [*robots.names(str(file)).of(kind)] for kind in ("link", "joint", "closure")}
    assert all(names.values())
    for each in ("robot.yaml", "robot.urdf"):
        robots.documents.change(file.with_name(each).as_uri(), "{<")
    assert {kind: [*robots.names(str(file)).of(kind)] for kind in names} == names


def test_a_name_given_twice_shows_the_other_place(tmp_path: Path) -> None:
    text = ARM.replace("</robot>", '<link name="base"/></robot>')
    robots = opened(tmp_path / "robot.urdf", robot_urdf=text)
    path = str(tmp_path / "robot.urdf")
    related = [each for found in robots.found()[path] for each in shown(robots, path, found).related_information or ()]
    assert [each.location.range.start for each in related] == [place_of(text, 'base"')]


@pytest.mark.parametrize(
    ("name", "code", "others"),
    [
        ("yaml/duplicate-actuators-key", "yaml-duplicate-key", ["actuators"]),
        ("urdf/two-parents-by-fixed-joint", "urdf-two-parents", ["wheel", "spin", "strut"]),
        ("closures/duplicate-after-own-closure", "closure-duplicate", ["belt"]),
        ("closures/distance-on-one-body", "closure-same-body", ["crank"]),
        ("names/frame-named-as-joint-merged-away", "duplicate-frame", ["ry"]),
    ],
)
def test_other_places_of_a_diagnostic_are_shown(name: str, code: str, others: list[str]) -> None:
    description = next(case.description for case in all_cases() if case.name == name)
    robots = opened(description)
    [(path, found)] = [(path, each) for path, all_ in robots.found().items() for each in all_ if each.code == code]
    texts = []
    for related in shown(robots, path, found).related_information or ():
        at, end = related.location.range.start, related.location.range.end
        file = description.with_name(related.location.uri.rpartition("/")[2])
        texts.append(file.read_text(encoding="utf-8").splitlines()[at.line][at.character : end.character])
    assert texts == others
