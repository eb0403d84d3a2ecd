"""In an editor with the YAML language server: completion, hover text, underlines, from the first-line comment alone."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from support.places import ROOT

pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")

from eurdf.commands.main import main
from support.language_server import MISSING, Editor, in_editor

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

HEAD = '# yaml-language-server: $schema={}\nextended_urdf: "2.0"\n'
TOP = ["urdf", "root", "closures", "joints", "actuators", "frames", "configurations", "metadata"]


def written(folder: Path, body: str, *, schema: str | None = None, name: str = "robot.yaml") -> tuple[Path, int, int]:
    """A description with the first-line comment, and the place of the cursor, ``|``, in it: line and column from 1."""
    reference = schema or (ROOT / "schema" / "extended-urdf-2.0.schema.json").as_uri()
    text = HEAD.format(reference) + body
    before = text.partition("|")[0]
    path = folder / name
    path.write_text(text.replace("|", "", 1), encoding="utf-8")
    return path, before.count("\n") + 1, len(before) - before.rfind("\n")


def completed(folder: Path, body: str, *, schema: str | None = None) -> list[str]:
    path, line, column = written(folder, body, schema=schema)

    async def session(editor: Editor) -> list[str]:
        await editor.open(path)
        return await editor.completions(path, line, column)

    return in_editor(session)


def test_keys_are_completed_except_present_ones(tmp_path: Path) -> None:
    assert completed(tmp_path, "|\n") == TOP
    assert completed(tmp_path, "closures: []\n|\n") == [key for key in TOP if key != "closures"]


@pytest.mark.parametrize(
    ("body", "offered"),
    [
        ("root: |\n", {"fixed", "floating"}),
        ("closures:\n  - name: rod\n    type: |\n    frames: [a, b]\n", {"3d", "6d"}),
        ("joints:\n  hip: |\n", {"spherical", "cylindrical", "fixed"}),
        ("joints:\n  hip: {type: |}\n", {"spherical", "universal", "cylindrical", "helical", "fixed"}),
        ("joints:\n  hip: {type: universal, axes: |}\n", {"xy", "xz", "yx", "yz", "zx", "zy"}),
    ],
)
def test_values_of_a_key_are_completed(tmp_path: Path, body: str, offered: set[str]) -> None:
    assert offered <= set(completed(tmp_path, body))


def test_hover_shows_meaning_and_unit(tmp_path: Path) -> None:
    path, line, column = written(tmp_path, "joints:\n  screw: {type: helical, pi|tch: 0.005}\n")

    async def session(editor: Editor) -> str:
        await editor.open(path)
        return await editor.hover(path, line, column)

    text = in_editor(session)
    assert "Pitch" in text
    assert "m per revolution" in text


#: One error of each kind that a schema can see: the file's body, the place that is underlined, and part of the message.
ERRORS = [
    ("|closurs: []\n", "Property closurs is not allowed"),
    ("root: |flying\n", 'Valid values: "fixed", "floating"'),
    ("closures:\n  - name: rod\n    type: |4d\n    frames: [a, b]\n", 'Valid values: "3d", "6d"'),
    ("closures:\n  - name: rod\n    type: 6d\n    frames: |[a]\n", "too few items"),
    ("closures:\n  - |name: rod\n    type: 6d\n", 'Missing property "frames"'),
    ("joints:\n  |screw: {type: helical}\n", 'Missing property "pitch"'),
    ("joints:\n  ball: {type: spherical, |pitch: 1}\n", "Property pitch is not allowed"),
    ("joints:\n  cross: {type: universal, axes: |xx}\n", 'Valid values: "xy"'),
    ("joints:\n  knee: {armature: |-1}\n", "below the minimum of 0"),
    ("actuators:\n  - {joint: knee, gear_ratio: |fast}\n", 'Expected "number"'),
    ("frames:\n  - {name: tip, link: foot, xyz: |[0, 0]}\n", "too few items"),
]


@pytest.fixture(scope="module")
def underlined(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[tuple[int, int, str]]]:
    """What is underlined in the file of each error, all opened in one editor."""
    folder = tmp_path_factory.mktemp("errors")

    async def session(editor: Editor) -> dict[str, list[tuple[int, int, str]]]:
        return {
            body: await editor.open(written(folder, body, name=f"fault_{index}.yaml")[0])
            for index, (body, _) in enumerate(ERRORS)
        }

    return in_editor(session)


@pytest.mark.parametrize(("body", "said"), ERRORS, ids=[said for _, said in ERRORS])
def test_schema_error_is_underlined(
    tmp_path: Path, underlined: dict[str, list[tuple[int, int, str]]], body: str, said: str
) -> None:
    _, line, column = written(tmp_path, body)
    ((at_line, at_column, message),) = underlined[body]
    assert (at_line, at_column) == (line, column)
    assert said in message


def test_robot_schema_completes_robot_names(tmp_path: Path) -> None:
    robot = ROOT / "robots" / "four_bar" / "robot.urdf"
    assert main(["schema", "--for", str(robot), "-o", str(tmp_path / "four_bar.schema.json")]) == 0
    assert "motor_crank" in completed(tmp_path, "actuators:\n  - |\n", schema="four_bar.schema.json")
    assert "rocker_pin_a" in completed(
        tmp_path, "closures:\n  - name: pin\n    type: 3d\n    frames:\n      - |\n", schema="four_bar.schema.json"
    )
    assert "free_rocker" in completed(tmp_path, "joints:\n  |\n", schema="four_bar.schema.json")


def test_collection_opens_without_underlines() -> None:
    # Of every version; `eurdf check` holds all of them to the same schemas.
    robots = [*sorted(ROOT.glob("robots/*/robot*.yaml"))[::4], *sorted(ROOT.glob("robots/t*/robot.yaml"))]

    async def session(editor: Editor) -> dict[Path, list[tuple[int, int, str]]]:
        return {path: await editor.open(path) for path in robots}

    assert {re.sub(r'(?s).*extended_urdf: "(.*?)".*|.*', r"\1", path.read_text("utf-8")) for path in robots} == {
        "",
        "2.0",
        "2.1",
    }
    assert in_editor(session) == {path: [] for path in robots}


#: Commands that write a description in a folder that has a URDF, and a description of version 1, alone.
WRITING = {
    "generate": ["generate", "robot.urdf", "-o", "leg.yaml"],
    "migrate": ["migrate", "old.yaml", "-o", "leg.yaml"],
}


@pytest.mark.parametrize("choice", ["format", "robot"])
@pytest.mark.parametrize("command", sorted(WRITING))
def test_command_output_is_completed_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str, choice: str
) -> None:
    robot = ROOT / "robots" / "four_bar"
    shutil.copy(robot / "robot.urdf", tmp_path)
    (tmp_path / "old.yaml").write_text("closed_loop: [[rocker_pin_a, rocker_pin_b]]\nname_mot: [motor_crank]\n")
    monkeypatch.chdir(tmp_path)
    assert main([*WRITING[command], "--schema", choice]) == 0
    path = tmp_path / "leg.yaml"
    text = path.read_text(encoding="utf-8")
    first = "leg.schema.json" if choice == "robot" else "extended-urdf-2.0.schema.json"
    assert text.splitlines()[0] == f"# yaml-language-server: $schema=./{first}"
    path.write_text(text + "frames: [{name: tip, link: }]\n\n", encoding="utf-8")
    line = text.count("\n") + 1

    async def session(editor: Editor) -> tuple[list[tuple[int, int, str]], list[str], list[str]]:
        underlined = await editor.open(path)
        keys = await editor.completions(path, line + 1, 1)
        links = await editor.completions(path, line, len("frames: [{name: tip, link: ") + 1)
        return underlined, keys, links

    underlined, keys, links = in_editor(session)
    assert {at for at, _, _ in underlined} == {line}  # the link that is not written yet
    assert {"root", "configurations", "metadata"} <= set(keys)
    assert ("coupler" in links) == (choice == "robot")


def test_schema_of_a_page_is_found_by_its_first_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copy(ROOT / "robots" / "four_bar" / "robot.urdf", tmp_path)
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "editor.md").read_text()
    shown = re.findall(r"^eurdf (schema .*?) +# line 1: (# yaml-language-server: .*)$", page, re.M)
    assert len(shown) == 2
    for command, first_line in shown:
        assert main(command.split()) == 0
        path = tmp_path / f"{len(command)}.yaml"
        path.write_text(f'{first_line}\nextended_urdf: "2.0"\nactuators: []\nframes: []\n\n', encoding="utf-8")

        async def session(editor: Editor, path: Path = path) -> tuple[list[tuple[int, int, str]], list[str], list[str]]:
            underlined = await editor.open(path)
            return underlined, await editor.completions(path, 5, 1), await editor.completions(path, 3, 13)

        underlined, keys, motors = in_editor(session)
        assert underlined == []
        assert "closures" in keys
        assert ("motor_crank" in motors) == ("--for" in command)
