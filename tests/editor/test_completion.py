"""What is completed at the cursor, and what hovering shows."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")


from eurdf.editor.completion import completions
from eurdf.editor.hover import hover
from support.places import ROBOTS
from support.typed import checked, opened, place, place_of

URDF = (ROBOTS / "four_bar" / "robot.urdf").read_text(encoding="utf-8")
LINKS = {"ground", "crank", "coupler", "rocker", "crank_tip"}
HEAD = 'extended_urdf: "2.1"\n'


def completed(folder: Path, text: str, *, urdf: bool = False) -> dict[str, str]:
    """What is completed at the mark of a text: what the text then is at that place, by label."""
    text, at = place(text)
    files = {"robot_urdf": text if urdf else URDF, "robot_yaml": HEAD if urdf else text}
    robots = opened(folder / "robot.yaml", folder / "robot.urdf", **files)
    path = folder / ("robot.urdf" if urdf else "robot.yaml")
    return {each.label: each.text_edit.new_text for each in completions(robots, str(path), at)}


def names(text: str, tag: str) -> list[str]:
    return [part.split('"')[0] for part in text.split(f'<{tag} name="')[1:]]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("|", ["extended_urdf: ", "urdf: "]),
        (f"{HEAD}act|", ["actuators:"]),
        (f"{HEAD}closures:\n  - name: a\n    |", ["type: ", "frames:"]),
        (f"{HEAD}closures:\n- name: a\n  ty|\n  frames: [a, b]", ["type: "]),
        (f"{HEAD}closures:\n  - {{name: a, |", ["type: "]),
        (f"{HEAD}closures:\n  - name: a\n    type: |\n    frames: [a, b]", ["6d", "3d", "hinge", "distance"]),
        (f"{HEAD}closures:\n  - name: a\n    type: hinge\n    |", ["frames:", "axis:"]),
        (f"{HEAD}joints:\n  x:\n    type: universal\n    axes: |", ["xy", "zx"]),
        (f"{HEAD}joints:\n  x: {{type: helical, |}}", ["pitch: "]),
        (f"{HEAD}root: f|", ["fixed", "floating"]),
        (f"{HEAD}actuators:\n  - |", ["joint:", "gear_ratio: "]),
        ("extended_urdf: |", ['"2.0"', '"2.1"']),
        ("closed_loop: []\nty|", ["type:"]),
        ("closed_loop: [[a, b]]\ntype: [|]", ["3d", "6d"]),
        # Also while an error is elsewhere in the file.
        (f"{HEAD}frames: ]\nclosures:\n  - name: a\n    type: |", ["6d"]),
        (f"{HEAD}closures:\n  - name: a\n    type: |\njoints: [", ["6d"]),
    ],
)
def test_keys_and_values_are_completed(tmp_path: Path, text: str, expected: list[str]) -> None:
    found = completed(tmp_path, text)
    assert {each.rstrip(": ") for each in expected} <= found.keys()
    assert not any("eurdf-cursor" in each for each in found)


def test_keys_that_are_there_are_not_completed(tmp_path: Path) -> None:
    assert not {"name", "type"} & completed(tmp_path, f"{HEAD}closures:\n  - name: a\n    type: 6d\n    |").keys()
    assert "pitch" not in completed(tmp_path, f"{HEAD}joints:\n  x: {{type: spherical, |}}")
    assert "couplings" not in completed(tmp_path, 'extended_urdf: "2.0"\n|')


@pytest.mark.parametrize("text", [f"{HEAD}# |", f"{HEAD}metadata: {{a: |}}", f"{HEAD}closures: |"])
def test_nothing_is_completed_where_anything_can_be(tmp_path: Path, text: str) -> None:
    assert not completed(tmp_path, text)


def test_names_of_the_robot_are_completed_where_they_can_be(tmp_path: Path) -> None:
    links, joints = names(URDF, "link"), names(URDF, "joint")
    assert set(links + joints) <= completed(tmp_path, f"{HEAD}closures: [{{name: a, type: 6d, frames: [|").keys()
    assert set(completed(tmp_path, f"{HEAD}frames:\n  - name: f\n    link: |")) == set(links)
    moving = completed(tmp_path, f"{HEAD}actuators: [|]").keys()
    assert moving < set(joints)
    assert set(completed(tmp_path, f"{HEAD}configurations:\n  up:\n    |")) == moving
    assert set(completed(tmp_path, f"{HEAD}joints:\n  |")) == set(joints)


def test_names_that_are_used_are_not_completed_again(tmp_path: Path) -> None:
    first, *others = completed(tmp_path, f"{HEAD}actuators: [|]")
    assert list(completed(tmp_path, f"{HEAD}actuators: [{first}, |]")) == others
    assert list(completed(tmp_path, f"{HEAD}configurations: {{up: {{{first}: 0, |}}}}")) == others


def test_frames_of_the_description_are_completed(tmp_path: Path) -> None:
    text = f"{HEAD}frames: [{{name: mine, link: {names(URDF, 'link')[0]}}}]\nclosures: [{{frames: [|]}}]"
    assert "mine" in completed(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('<robot><link name="a"/><joint><parent link="|"/></joint></robot>', {"a"}),
        ('<robot><link name="a"/><joint name="j" type="|"/></robot>', {"revolute", "fixed"}),
        ("<robot><joint><|", {"parent", "child", "axis"}),
        ("<robot><joint><li|", {"limit"}),
        ("<robot><joint><limit |/></joint></robot>", {"lower", "effort"}),
        ("<robot><link name='a'></link><|", {"link", "joint"}),
    ],
)
def test_a_urdf_is_completed(tmp_path: Path, text: str, expected: set[str]) -> None:
    assert expected <= completed(tmp_path, text, urdf=True).keys()


def test_a_link_that_has_a_parent_is_not_completed_as_a_child(tmp_path: Path) -> None:
    text = '<robot><link name="a"/><link name="b"/><joint><child link="a"/><child link="|"/></joint></robot>'
    assert set(completed(tmp_path, text, urdf=True)) == {"b"}


def test_what_is_completed_is_inserted_over_the_word(tmp_path: Path) -> None:
    text, at = place(f"{HEAD}root: flo|ting")
    robots = opened(tmp_path / "robot.yaml", robot_yaml=text)
    found = completions(robots, str(tmp_path / "robot.yaml"), at)
    assert {(each.text_edit.range.start.character, each.text_edit.range.end.character) for each in found} == {(6, 13)}


# -- hover ------------------------------------------------------------------------------------------------------------


def hovered(name: str, word: str, file: str = "robot.yaml", **texts: str) -> str:
    folder = ROBOTS / name
    robots = opened(folder / "robot.yaml", folder / "robot.urdf", **texts)
    checked(robots, str(folder / "robot.yaml"), thorough=True)
    text = robots.documents.text(str(folder / file))
    found = hover(robots, str(folder / file), place_of(text, word))
    return "" if found is None else found.contents.value


def test_hover_shows_what_is_named() -> None:
    joint = hovered("digit_leg", "motor_knee")
    assert all(part in joint for part in ("`thigh` → `shin`", "-1.539 … 0.555", "231.3", "actuated")), joint
    assert "passive" in hovered("digit_leg", 'free_knee"', "robot.urdf")
    closure = hovered("digit_leg", "achilles")
    assert all(part in closure for part in ("6 constraint rows", "closed", "mobility 2, 1 actuated")), closure
    assert " kg" in hovered("digit_leg", 'thigh"', "robot.urdf")


def test_hover_shows_what_a_key_means() -> None:
    assert "Type" in hovered("digit_leg", "type")
    assert hovered("digit_leg", "metadata") != ""


def test_hover_shows_the_clause_of_a_diagnostic() -> None:
    text = (
        (ROBOTS / "four_bar" / "robot.yaml").read_text(encoding="utf-8").replace("actuators: [", "actuators: [nobody, ")
    )
    assert "EU-ACT-001" in hovered("four_bar", "nobody", robot_yaml=text)
