"""The JSON Schemas: current, well formed, explained throughout, and of one mind with the models."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, Literal

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from eurdf.diagnostics import Diagnostics
from eurdf.format.model import VERSION2, lowest_version, violations
from eurdf.format.read import read_description
from eurdf.format.schema import FILES, NUMBERS, Names, SchemaVersion, json_schema, main, schema_text
from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml
from eurdf_conformance.properties.document import document as description_of
from eurdf_conformance.properties.strategies.mechanisms import mechanisms
from support.places import ROOT

VERSIONS: tuple[SchemaVersion, ...] = ("1", "2", "2.1")
VALIDATORS = {version: Draft202012Validator(json_schema(version)) for version in VERSIONS}

NAMES = Names(links=["base", "rod", "foot"], joints=["hip", "knee", "weld"], movable_joints=["hip", "knee"])

WHOLE: dict[str, dict[str, Any]] = {
    "1": {
        "closed_loop": [["rod", "foot"], ["a", "b"]],
        "type": ["3D", "6d"],
        "name_mot": ["hip"],
        "joint_name": ["knee", "ankle"],
        "joint_type": ["SPHERICAL", "UJOINT_ZX"],
        "notes": {"any": 1},
    },
    "2": {
        "extended_urdf": "2.0",
        "urdf": "leg.urdf",
        "root": "floating",
        "closures": [
            {"name": "rod", "type": "6d", "frames": ["rod", {"link": "foot", "xyz": [0, 0.5, 1]}]},
            {"name": "gear", "type": "x-gear", "frames": [{"joint": "hip", "rpy": [0, 0, 1]}, "tip"], "x-ratio": 2},
        ],
        "joints": {
            "hip": "spherical",
            "cardan": {"type": "universal", "axes": "zx", "friction": 1, "armature": [1, 0]},
            "oblique": {"type": "universal", "axes": [[1, 0, 0], [0, 1, 1]], "damping": 0, "limits": {"lower": -1}},
            "toe": {"type": "spherical", "merges": ["a", "b", "c"], "damping": [1, 2, 3], "friction": 1},
            "ankle": {"type": "spherical", "armature": 1, "limits": {"effort": [1, 2, 3]}},
            "screw": {"type": "helical", "pitch": 0.01, "damping": 1, "friction": 0, "armature": 2},
            "bolt": {"type": "helical", "pitch": -1, "limits": {"upper": [2], "velocity": 3}},
            "post": {"type": "cylindrical", "damping": 1, "friction": 0, "armature": 1, "limits": {"lower": 0}},
            "weld": {"type": "fixed", "damping": 1, "friction": 0, "armature": 1, "limits": {"upper": 0}},
            "knee": {"limits": {"effort": 80}, "damping": 1, "friction": 0, "armature": 0.1},
            "x-own": 3,
        },
        "actuators": ["hip", {"joint": "knee", "gear_ratio": -50, "rotor_inertia": 0}],
        "frames": [{"name": "tip", "link": "foot", "rpy": [0, 0, 1]}, {"name": "heel", "joint": "knee"}],
        "configurations": {"assembled": {"knee": 0.4, "hip": [0, 0, 0, 1], "x-own": None}, "x-old": 1},
        "metadata": {"license": "MIT", "more": [None]},
        "x-note": [],
    },
}

WHOLE["2.1"] = {
    **WHOLE["2"],
    "extended_urdf": "2.1",
    "closures": [
        *WHOLE["2"]["closures"],
        {"name": "pin", "type": "hinge", "frames": ["rod", "tip"], "x-play": 1},
        {"name": "rod", "type": "6d", "frames": ["rod", "tip"], "compliance": {"linear": 0, "angular": 1, "x-own": 2}},
        {"name": "tie", "type": "distance", "frames": ["rod", "tip"], "length": 0.2},
        {"name": "bolt", "type": "hinge", "frames": ["rod", "tip"], "axis": [0, 1, 0.5]},
        {"name": "peg", "type": "hinge", "frames": ["rod", "tip"], "axes": [[0, 1, 0.5], [1, 0, 0]]},
    ],
    "joints": {
        **WHOLE["2"]["joints"],
        "heel": {"stiffness": 1200, "rest": -0.1},
        "toe": {"type": "universal", "axes": "xy", "stiffness": [3, 0], "rest": [1, 2], "x-own": 1},
        "jaw": {"mimic": False},
    },
    "actuators": [*WHOLE["2"]["actuators"], {"joint": "heel", "name": "left", "control": [-3, 3]}],
    "couplings": [{"name": "belt", "joints": {"hip": 2, "knee": -1, "x-own": None}, "offset": 0.5, "x-own": 1}],
}

#: What is put in place of a value.
JUNK = [1e16, 1e-16, None, True, False, 0, -1, 1.5, "", "xy", "3d", "hinge", "x-own", "spherical", [], {}]
JUNK += [[1, 2, 3], [-1.5], ["a", "b"], [0] * 8, {"link": "a"}]

#: What a key is renamed to, or what a key is added.
KEYS = ["", "x-own", "type", "joint", "axes", "limits", "joint_type", "stiffness", "rest", "mimic", "name"]


def accepted(version: SchemaVersion, document: Any) -> bool:
    """Whether the model takes a document, after the schema is seen to be of one mind with it."""
    found = violations(NUMBERS[version], document)
    assert VALIDATORS[version].is_valid(document) == (not found), f"{document}\nmodel: {found or 'accepts it'}"
    return not found


@pytest.mark.parametrize("version", VERSIONS)
def test_schema_file_is_current(version: SchemaVersion) -> None:
    written = (ROOT / "schema" / FILES[version]).read_text(encoding="utf-8")
    assert written == schema_text(json_schema(version)), "run: python -m eurdf.format.schema schema"


def test_schema_files_are_written_to_given_folder(tmp_path: Path) -> None:
    main(str(tmp_path))
    assert {path.name: json.loads(path.read_text()) for path in tmp_path.iterdir()} == {
        FILES[version]: json_schema(version) for version in VERSIONS
    }


@pytest.mark.parametrize("names", [None, NAMES])
@pytest.mark.parametrize("version", VERSIONS)
def test_schema_is_draft_2020_12(version: SchemaVersion, names: Names | None) -> None:
    schema = json_schema(version, names)
    assert schema["$schema"] == Draft202012Validator.META_SCHEMA["$id"]
    assert ("$id" in schema) == (names is None)
    Draft202012Validator.check_schema(schema)


def properties(schema: Any, path: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Every property that a schema describes, by its path."""
    if isinstance(schema, dict):
        for key, value in schema.items():
            if key == "properties":
                yield from ((f"{path}/{name}", entry) for name, entry in value.items())
            if key != "examples":
                yield from properties(value, f"{path}/{key}")
    elif isinstance(schema, list):
        for index, value in enumerate(schema):
            yield from properties(value, f"{path}/{index}")


@pytest.mark.parametrize("version", VERSIONS)
def test_properties_have_title_description_and_valid_examples(version: SchemaVersion) -> None:
    schema = json_schema(version)
    found = dict(properties(schema))
    assert len(found) >= 5
    for path, entry in found.items():
        assert entry.get("title"), path
        assert entry.get("description"), path
        assert entry.get("examples"), path
        validator = Draft202012Validator({"$defs": schema["$defs"], **entry})
        for example in [*entry["examples"], *([entry["default"]] if "default" in entry else [])]:
            assert validator.is_valid(example), f"{path}: {example}"


def test_dimensional_values_state_their_unit() -> None:
    units = {
        "xyz": "m.",
        "rpy": "rad.",
        "lower": "rad or m",
        "upper": "rad or m",
        "velocity": "rad/s or m/s",
        "effort": "N·m or N",
        "damping": "N·m·s/rad or N·s/m",
        "friction": "N·m or N",
        "armature": "kg·m² or kg",
        "rotor_inertia": "kg·m²",
        "pitch": "m per revolution",
        "configurations": "rad",
    }
    described = {path.rpartition("/")[2]: entry["description"] for path, entry in properties(json_schema("2"))}
    for name, unit in units.items():
        assert unit in described[name], name


@pytest.mark.parametrize("version", VERSIONS)
def test_complete_document_is_accepted(version: SchemaVersion) -> None:
    assert accepted(version, WHOLE[version])


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The place of every value of a document."""
    yield path
    steps = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for step, item in steps:
        yield from places(item, (*path, step))


def with_edit(document: Any, path: tuple[Any, ...], edit: Any) -> Any:
    """A copy of a document with the collection that holds a value edited: ``edit(collection, step)``."""
    edited = {"": copy.deepcopy(document)}
    path = ("", *path)
    holder: Any = edited
    for step in path[:-1]:
        holder = holder[step]
    edit(holder, path[-1])
    return edited[""]


def edits(document: Any, under: str | None = None) -> Iterator[Any]:
    """Every document that is one edit away: a value dropped, replaced, repeated, or a key renamed or added.

    With ``under``, only those edits that are made at that key of the document or below it.
    """
    for path in list(places(document)):
        if under is not None and path[:1] != (under,):
            continue
        if path:
            yield with_edit(document, path, lambda holder, step: holder.pop(step))
        for junk in JUNK:
            yield with_edit(document, path, lambda holder, step, junk=junk: holder.__setitem__(step, junk))
        if path and isinstance(path[-1], int):
            yield with_edit(document, path, lambda holder, step: holder.append(copy.deepcopy(holder[step])))
            yield with_edit(document, path, lambda holder, step: holder.__setitem__(step, copy.deepcopy(holder[0])))
        for key in KEYS if path and isinstance(path[-1], str) else ():
            yield with_edit(document, path, lambda holder, step, key=key: holder.update({key: holder.pop(step)}))
            yield with_edit(document, path, lambda holder, step, key=key: holder.setdefault(key, holder[step]))


def edited_pieces(version: SchemaVersion) -> Iterator[Any]:
    """Every edit of sound documents that have one entry of the whole one each, so that they are soon judged."""
    if version == "1":
        yield from edits(WHOLE["1"])
        return
    head = {"extended_urdf": WHOLE[version]["extended_urdf"]}
    yield from edits(head)
    for key, value in WHOLE[version].items():
        if isinstance(value, dict) and value:
            entries: list[Any] = [{name: entry} for name, entry in value.items()]
        else:
            entries = [[entry] for entry in value] if isinstance(value, list) and value else [value]
        for entry in entries:
            yield from edits({**head, key: entry}, under=key)


@pytest.mark.slow
@pytest.mark.parametrize("version", ["1", "2.1"])  # it is part of 2.1
def test_model_and_schema_agree_after_one_edit(version: SchemaVersion) -> None:
    verdicts = [accepted(version, document) for document in edited_pieces(version)]
    assert verdicts.count(True) > 100
    assert verdicts.count(False) > 200


DOCUMENTS: dict[str, st.SearchStrategy[dict[str, Any]]] = {
    version: mechanisms(version, 1).map(partial(description_of, version=version)) for version in VERSIONS
}


@st.composite
def mutants(draw: st.DrawFn, version: str) -> Any:
    """Sound documents with one to three edits."""
    document = draw(DOCUMENTS[version])
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from(list(places(document))))
        key, junk = draw(st.sampled_from(KEYS)), draw(st.sampled_from(JUNK))

        def edit(holder: Any, step: Any, kind: str, key: str = key, junk: Any = junk) -> None:
            match kind:
                case "replace":
                    holder[step] = copy.deepcopy(junk)
                case "drop" if step != "":
                    holder.pop(step)
                case "lengthen" if isinstance(holder[step], list):
                    holder[step].append(copy.deepcopy(holder[step][-1] if holder[step] else junk))
                case "repeat" if isinstance(holder[step], list) and holder[step]:
                    holder[step][-1] = copy.deepcopy(holder[step][0])
                case "add" if isinstance(holder[step], dict):
                    holder[step][key] = copy.deepcopy(junk)
                case "rename" if isinstance(holder, dict) and step != "":
                    holder[key] = holder.pop(step)

        kind = draw(st.sampled_from(["replace", "drop", "lengthen", "repeat", "add", "rename"]))
        document = with_edit(document, path, lambda holder, step, kind=kind, edit=edit: edit(holder, step, kind))
    return document


seldom = settings(max_examples=80, derandomize=True, deadline=None, database=None)


@pytest.mark.parametrize("version", VERSIONS)
@seldom
@given(st.data())
def test_valid_documents_pass_model_and_schema(version: SchemaVersion, data: st.DataObject) -> None:
    assert accepted(version, data.draw(DOCUMENTS[version]))


@pytest.mark.parametrize("version", ["2", "2.1"])
@seldom
@given(st.data())
def test_what_is_written_is_valid_and_read_again(version: SchemaVersion, data: st.DataObject) -> None:
    document = data.draw(DOCUMENTS[version])
    written = VERSION2.write(VERSION2.read(document, ()))
    assert accepted(version, written)
    assert VERSION2.write(VERSION2.read(written, ())) == written
    assert lowest_version(written) == "2.0" or version == "2.1"


@pytest.mark.slow
@pytest.mark.parametrize("version", VERSIONS)
@settings(max_examples=150, derandomize=True, deadline=None, database=None)
@given(st.data())
def test_model_and_schema_agree_on_invalid_documents(version: SchemaVersion, data: st.DataObject) -> None:
    accepted(version, data.draw(mutants(version)))


def test_reading_reports_what_schema_rejects() -> None:
    seen = 0
    for document in list(edited_pieces("2"))[::12]:
        if not isinstance(document, dict) or "extended_urdf" not in document:
            continue
        text = json.dumps(document, indent=1)
        diagnostics = Diagnostics()
        extension = read_description(read_yaml(Source("robot.yaml", text, text.encode())), diagnostics)
        assert (extension is not None) == VALIDATORS["2"].is_valid(document) == (not list(diagnostics)), document
        for found in diagnostics:
            assert found.line is not None
            assert found.phase == "schema"
            seen += 1
    assert seen > 90


def test_own_keys_are_no_joints_of_coupling() -> None:
    joints = {"knee": 1, "x-note": 2}
    document = {"extended_urdf": "2.1", "couplings": [{"name": "gear", "joints": joints}]}
    assert not accepted("2.1", document)
    joints["hip"] = 1
    assert accepted("2.1", document)


def robot_errors(version: SchemaVersion, text: str) -> list[str]:
    """What an editor says of a document, which knows the names of one robot."""
    validator = Draft202012Validator(json_schema(version, NAMES))
    return ["/".join(map(str, error.absolute_path)) for error in validator.iter_errors(yaml.safe_load(text))]


HEAD = 'extended_urdf: "2.0"\n'

KNOWN_TO_THE_ROBOT: list[tuple[Literal["1", "2"], str]] = [
    ("1", "closed_loop: [[rod, hip]]\nname_mot: [knee]\n"),
    ("1", "joint_name: [hip]\njoint_type: [UJOINT_XY]\nname_mot: [hip_X]\nclosed_loop: [[hip_Y, foot]]\n"),
    ("2", HEAD + "closures: [{name: a, type: 3d, frames: [rod, knee]}]\nactuators: [hip, {joint: knee}]\n"),
    ("2", HEAD + "closures: [{name: a, type: 3d, frames: [tip, foot]}]\nframes: [{name: tip, link: rod}]\n"),
    ("2", HEAD + "joints: {ball: {type: spherical, merges: [hip, knee, weld]}}\nactuators: [ball]\n"),
    ("2", HEAD + "configurations: {assembled: {hip: 1, x-own: 2}, x-old: {any: 1}}\n"),
    ("2", HEAD + "joints: {hip: fixed, x-own: 1}\nconfigurations: {ready: {made: 1}}\n"),
    ("2", HEAD + "closures: [{name: a, type: 3d, frames: [{link: rod}, {joint: weld}]}]\n"),
]


@pytest.mark.parametrize(("version", "text"), KNOWN_TO_THE_ROBOT)
def test_robot_schema_accepts_known_names(version: SchemaVersion, text: str) -> None:
    assert robot_errors(version, text) == []


UNKNOWN_TO_THE_ROBOT: list[tuple[Literal["1", "2"], str, str]] = [
    ("1", "closed_loop: [[rod, hpi]]\n", "closed_loop/0/1"),
    ("1", "name_mot: [weld]\n", "name_mot/0"),
    ("1", "joint_name: [rod]\njoint_type: [FIXED]\n", "joint_name/0"),
    ("2", HEAD + "closures: [{name: a, type: 3d, frames: [rdo, knee]}]\n", "closures/0/frames/0"),
    ("2", HEAD + "closures: [{name: a, type: 3d, frames: [rod, {link: knee}]}]\n", "closures/0/frames/1"),
    ("2", HEAD + "frames: [{name: tip, link: hip}]\n", "frames/0"),
    ("2", HEAD + "actuators: [weld]\n", "actuators/0"),
    ("2", HEAD + "actuators: [{joint: hpi}]\n", "actuators/0"),
    ("2", HEAD + "joints: {hpi: fixed}\n", "joints/hpi"),
    ("2", HEAD + "joints: {ball: {type: spherical, merges: [hip, knee, toe]}}\n", "joints/ball"),
    ("2", HEAD + "configurations: {ready: {hpi: 1}}\n", "configurations/ready"),
]


@pytest.mark.parametrize(("version", "text", "where"), UNKNOWN_TO_THE_ROBOT)
def test_robot_schema_rejects_unknown_names(version: SchemaVersion, text: str, where: str) -> None:
    assert set(robot_errors(version, text)) == {where}


def test_robot_schema_offers_names_for_completion() -> None:
    schema = json_schema("2", NAMES)
    assert schema["$defs"]["FrameName"]["anyOf"][0] == {"enum": ["base", "rod", "foot", "hip", "knee", "weld"]}
    assert schema["$defs"]["MovingJointName"]["anyOf"][0] == {"enum": ["hip", "knee"]}
    assert list(schema["properties"]["joints"]["properties"]) == ["hip", "knee", "weld"]
    assert list(schema["properties"]["configurations"]["additionalProperties"]["properties"]) == ["hip", "knee"]
    coupling = json_schema("2.1", NAMES)["$defs"]["Coupling"]
    assert list(coupling["properties"]["joints"]["properties"]) == ["hip", "knee"]


def test_robot_schema_leaves_general_schema_unchanged() -> None:
    before = json_schema("2")
    json_schema("2", NAMES)
    assert json_schema("2") == before
