"""``eurdf robots``: the list of the collection."""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import jsonschema
import pytest

import eurdf
from eurdf import collection
from eurdf.commands.output import output_schemas

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A collection of two robots, as an installed package has them: only their files."""
    home = collection.collection_folder()
    assert home is not None
    for name in ("four_bar", "digit_leg"):
        (tmp_path / name).mkdir()
        for file in ("robot.urdf", "robot.yaml"):
            shutil.copy(home / name / file, tmp_path / name)
    monkeypatch.setattr(collection, "collection_folder", lambda: tmp_path)
    return tmp_path


def test_every_collection_robot_is_listed(run: Run) -> None:
    code, out, err = run("robots")
    assert (code, err) == (0, "")
    heading, *lines = out.splitlines()
    assert heading.split()[0] == "robot"
    assert [line.split()[0] for line in lines] == eurdf.collection_names()


def test_dimensions_and_description_are_shown(folder: Path, run: Run) -> None:
    _, out, _ = run("robots")
    digit = next(line for line in out.splitlines() if line.startswith("digit_leg "))
    assert digit.split()[1:8] == ["27", "3", "18", "9", "6", "3", "fixed"]
    assert "Left leg of Agility Robotics' Digit" in digit


def test_json_matches_schema(folder: Path, run: Run) -> None:
    code, out, _ = run("robots", "--json")
    found = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["robots.schema.json"]).validate(found)
    assert code == 0
    assert found["robots"][1] == {
        "name": "four_bar",
        "description": "Planar four-bar linkage, a crank and rocker",
        "root": "fixed",
        "nv": 3,
        "closures": 1,
        "nc": 3,
        "mobility": 1,
        "actuated": 1,
        "uncontrolled": 0,
        "error": None,
    }


@pytest.mark.parametrize("content", ["closures: [", 'extended_urdf: "2.0"\nactuators: [motor]\n', "\0", ""])
def test_broken_robot_is_listed_with_error(folder: Path, run: Run, content: str) -> None:
    (folder / "digit_leg" / "robot.yaml").write_text(content)
    code, out, err = run("robots")
    assert code == 1
    assert "four_bar" in out
    assert "cannot be built" in out.splitlines()[1]
    assert err.startswith("digit_leg: ")
    code, out, _ = run("robots", "--json")
    found = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["robots.schema.json"]).validate(found)
    assert code == 1
    assert found["robots"][0]["nv"] is None
    assert found["robots"][0]["error"]
    assert found["robots"][1]["error"] is None


def test_open_robot_is_listed_without_ranks(folder: Path, run: Run) -> None:
    urdf = folder / "four_bar" / "robot.urdf"
    text = urdf.read_text()
    assert "-0.07 0 0.24" in text
    urdf.write_text(text.replace("-0.07 0 0.24", "9 0 0"))
    code, out, _ = run("robots", "--json")
    four_bar = json.loads(out)["robots"][1]
    assert code == 0
    assert (four_bar["nc"], four_bar["mobility"]) == (3, None)


def test_descriptions_are_dropped_in_narrow_terminal(folder: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = run("robots")
    assert "27" in out
    assert "Agility" not in out
    monkeypatch.setenv("COLUMNS", "200")
    _, out, _ = run("robots")
    assert "Agility" in out
