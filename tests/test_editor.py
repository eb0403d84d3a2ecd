"""In an editor with the YAML language server: completion, hover text, underlines, from the first-line comment alone."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("pygls", reason="pygls is not installed: pip install -e '.[test]'")

from language_server import MISSING, Editor, in_editor

ROOT = Path(__file__).parent.parent

pytestmark = [pytest.mark.skipif(bool(MISSING), reason=MISSING), pytest.mark.xdist_group("editor")]

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


def test_the_keys_of_a_description_are_completed_but_for_those_that_stand_there(tmp_path: Path) -> None:
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
def test_the_values_of_a_key_are_completed(tmp_path: Path, body: str, offered: set[str]) -> None:
    assert offered <= set(completed(tmp_path, body))


def test_the_keys_of_a_closure_are_completed(tmp_path: Path) -> None:
    assert "frames" in completed(tmp_path, "closures:\n  - name: rod\n    type: 6d\n    f|\n")


def test_hover_text_says_what_a_key_means_and_its_unit(tmp_path: Path) -> None:
    path, line, column = written(tmp_path, "joints:\n  screw: {type: helical, pi|tch: 0.005}\n")

    async def session(editor: Editor) -> str:
        await editor.open(path)
        return await editor.hover(path, line, column)

    text = in_editor(session)
    assert "Pitch" in text
    assert "m per revolution" in text


#: One fault of each kind that a schema can see: the file's body, the place that is underlined, and part of the message.
FAULTS = [
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
    """What is underlined in the file of each fault, all opened in one editor."""
    folder = tmp_path_factory.mktemp("faults")

    async def session(editor: Editor) -> dict[str, list[tuple[int, int, str]]]:
        return {
            body: await editor.open(written(folder, body, name=f"fault_{index}.yaml")[0])
            for index, (body, _) in enumerate(FAULTS)
        }

    return in_editor(session)


@pytest.mark.parametrize(("body", "said"), FAULTS, ids=[said for _, said in FAULTS])
def test_a_fault_of_the_schema_is_underlined_where_it_is(
    tmp_path: Path, underlined: dict[str, list[tuple[int, int, str]]], body: str, said: str
) -> None:
    _, line, column = written(tmp_path, body)
    ((at_line, at_column, message),) = underlined[body]
    assert (at_line, at_column) == (line, column)
    assert said in message


def test_the_names_of_a_robot_are_completed_from_its_own_schema(tmp_path: Path) -> None:
    robot = ROOT / "robots" / "four_bar" / "robot.urdf"
    command = [sys.executable, "-m", "eurdf.commands.main", "schema", "--for", str(robot)]
    schema = tmp_path / "four_bar.schema.json"
    schema.write_bytes(subprocess.run(command, check=True, capture_output=True).stdout)
    assert json.loads(schema.read_text())
    assert "motor_crank" in completed(tmp_path, "actuators:\n  - |\n", schema="four_bar.schema.json")
    assert "rocker_pin_a" in completed(
        tmp_path, "closures:\n  - name: pin\n    type: 3d\n    frames:\n      - |\n", schema="four_bar.schema.json"
    )
    assert "free_rocker" in completed(tmp_path, "joints:\n  |\n", schema="four_bar.schema.json")


def test_the_robots_of_the_collection_are_opened_without_an_underline() -> None:
    robots = sorted(ROOT.glob("robots/*/robot*.yaml"))

    async def session(editor: Editor) -> dict[Path, list[tuple[int, int, str]]]:
        return {path: await editor.open(path) for path in robots}

    assert len(robots) >= 4
    assert in_editor(session) == {path: [] for path in robots}
