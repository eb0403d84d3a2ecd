"""``eurdf robots``: the list of the collection."""

import json
from collections.abc import Callable

import jsonschema
import pytest

import eurdf
from eurdf import collection
from eurdf.commands.output import output_schemas

Run = Callable[..., tuple[int, str, str]]


def test_every_collection_robot_is_listed(run: Run) -> None:
    code, out, err = run("robots")
    assert (code, err) == (0, "")
    heading, *lines = out.splitlines()
    assert heading.split()[0] == "robot"
    assert [line.split()[0] for line in lines] == eurdf.collection_names()


def test_dimensions_and_description_are_shown(run: Run) -> None:
    _, out, _ = run("robots")
    digit = next(line for line in out.splitlines() if line.startswith("digit_leg "))
    assert digit.split()[1:8] == ["27", "3", "18", "9", "6", "3", "fixed"]
    assert "Left leg of Agility Robotics' Digit" in digit


def test_json_matches_schema(run: Run) -> None:
    code, out, _ = run("robots", "--json")
    found = json.loads(out)
    jsonschema.Draft202012Validator(output_schemas()["robots.schema.json"]).validate(found)
    assert code == 0
    assert next(robot for robot in found["robots"] if robot["name"] == "four_bar") == {
        "name": "four_bar",
        "description": "Planar four-bar linkage, a crank and rocker",
        "root": "fixed",
        "nv": 3,
        "closures": 1,
        "nc": 3,
        "mobility": 1,
        "actuated": 1,
        "uncontrolled": 0,
    }


def test_missing_collection_is_refused(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collection, "collection_folder", lambda: None)
    assert run("robots") == (2, "", "eurdf: the collection of robots is not installed\n")


def test_columns_are_dropped_before_names_are_broken(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    for columns, dropped in (("60", "closures, nc,"), ("80", "nc, root, description"), ("200", "")):
        monkeypatch.setenv("COLUMNS", columns)
        _, out, _ = run("--no-color", "robots")
        assert all(name in out for name in eurdf.collection_names())
        assert "mobility" in out
        assert ("Agility" in out) == (columns == "200")
        assert (f"a wider terminal also shows: {dropped}" in out) == (columns != "200")
