"""Each message has a JSON Schema in a file, which says what the runner says."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path
from typing import Any, ClassVar

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from eurdf_conformance.level import Level, Version
from eurdf_conformance.protocol.message import (
    ANSWER,
    PROTOCOL,
    REQUEST,
    Accepted,
    AnyRequest,
    Evaluate,
    Load,
    Start,
    Stop,
)
from eurdf_conformance.protocol.reply import accepted
from eurdf_conformance.protocol.schema import FOLDER, main, message_schemas, schema_text
from eurdf_conformance.protocol.serve import serve
from eurdf_conformance.runner.answer import read_answer
from eurdf_conformance.runner.outcome import Malformed, Misplaced

SCHEMAS = message_schemas()

JOINT = {
    "name": "j", "type": "revolute", "parent": "a", "child": "b", "lower": [-1], "upper": [None], "velocity": [None],
    "effort": [2.5], "damping": [0], "friction": [0], "armature": [0],
}  # fmt: skip
ROBOT = {
    "name": "r", "version": "2", "root": "fixed", "links": ["a", "b"], "frames": [], "joints": [JOINT],
    "closures": [{"name": "c", "type": "3d", "a": "a", "b": "b"}], "actuators": [{"joint": "j", "gear_ratio": [50]}],
    "configurations": {"home": {"j": [0.5]}}, "own": {"/x-a": {"deep": [1, "two", None, True]}},
}  # fmt: skip
ISSUE = {"code": "unknown-frame", "severity": "error", "file": "robot.yaml", "line": 1, "column": 2, "message": "m"}
PARSER = {"name": "n", "version": "", "language": "C++"}
POSE = {"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "translation": [0, 0, 0.5]}
VALUES = {
    "poses": {"tool": POSE},
    "residuals": {"c": [0, 0, 1e-9]},
    "jacobian": {"columns": [["j", 0]], "rows": {"c": [[1], [0], [0]]}},
    "mass_matrix": {"columns": [["j", 0]], "matrix": [[2]]},
    "mass": 3,
    "center_of_mass": [0, 0, 1],
}

#: Requests, and answers to each that fit; ids are left out.
REQUESTS: dict[str, AnyRequest] = {
    "start": Start(id=1, protocol=PROTOCOL),
    "load": Load(id=1, description="/robot.yaml", urdf="/robot.urdf"),
    "evaluate": Evaluate(id=1, quantities=["mass", "poses"], frames=["tool"], configurations=[{"j": [0.5]}]),
    "stop": Stop(id=1),
}
SOUND: list[tuple[str, dict[str, Any]]] = [
    ("start", {"outcome": "started", "protocol": "1.0", "parser": PARSER, "claims": {"1": ["accept"], "2": []}}),
    ("load", {"outcome": "accepted", "robot": ROBOT, "issues": [ISSUE, {"message": "m"}]}),
    ("load", {"outcome": "accepted", "robot": None}),
    ("load", {"outcome": "rejected", "issues": []}),
    ("load", {"outcome": "rejected", "issues": [{"message": "m", "line": 3.0}]}),
    ("load", {"outcome": "unsupported", "feature": "f"}),
    ("load", {"outcome": "skipped", "reason": "r"}),
    ("start", {"outcome": "errored", "message": "m"}),
    ("evaluate", {"outcome": "evaluated", "values": [VALUES]}),
    ("evaluate", {"outcome": "evaluated", "values": [{}]}),
    ("evaluate", {"outcome": "unsupported", "feature": "f", "reason": "r"}),
    ("stop", {"outcome": "stopped"}),
]


def changed(value: Any, pointer: str, new: Any) -> Any:
    """A copy with the value at a JSON pointer replaced, or removed where the new one is ``...``."""
    copy = json.loads(json.dumps(value))
    *way, last = pointer.split("/")[1:]
    place = copy
    for key in way:
        place = place[int(key) if isinstance(place, list) else key]
    if new is ...:
        del place[last]
    else:
        place[int(last) if isinstance(place, list) else last] = new
    return copy


#: Which of the sound answers, the pointer, what is there instead.
BROKEN: list[tuple[int, str, Any]] = [
    (0, "/protocol", "1.1"),
    (0, "/protocol", ...),
    (0, "/parser", None),
    (0, "/parser/name", ""),
    (0, "/parser/language", ...),
    (0, "/claims", []),
    (0, "/claims/3", ["accept"]),
    (0, "/claims/1", ["all"]),
    (0, "/claims/1", "accept"),
    (1, "/robot", ...),
    (1, "/robot/version", "2.0"),
    (1, "/robot/root", "free"),
    (1, "/robot/links", {"a": 1}),
    (1, "/robot/own", ...),
    (1, "/robot/extra", 1),
    (1, "/robot/joints/0/type", "fixed"),
    (1, "/robot/joints/0/lower", -1),
    (1, "/robot/joints/0/lower", ["-1"]),
    (1, "/robot/joints/0/damping", [None]),
    (1, "/robot/joints/0/mimic", {"joint": "k"}),
    (1, "/robot/joints/0/armature", ...),
    (1, "/robot/closures/0/type", "6D"),
    (1, "/robot/actuators/0/gear_ratio", 50),
    (1, "/robot/configurations/home", [0.5]),
    (1, "/robot/configurations/home/j", 0.5),
    (1, "/issues/0/severity", "fatal"),
    (1, "/issues/0/line", 0),
    (1, "/issues/0/column", 1.5),
    (1, "/issues/1/message", ...),
    (1, "/issues/1/hint", "h"),
    (1, "/issues", None),
    (3, "/issues", ...),
    (5, "/feature", ...),
    (6, "/reason", ...),
    (7, "/message", 3),
    (8, "/values", VALUES),
    (8, "/values/0/poses/tool/rotation", [[1, 0, 0], [0, 1, 0]]),
    (8, "/values/0/poses/tool/rotation/0", [1, 0, 0, 0]),
    (8, "/values/0/poses/tool/translation", [0, 0]),
    (8, "/values/0/jacobian/columns/0", ["j"]),
    (8, "/values/0/jacobian/columns/0", ["j", "0"]),
    (8, "/values/0/jacobian/rows/c", [1, 0, 0]),
    (8, "/values/0/mass_matrix/matrix", None),
    (8, "/values/0/mass", True),
    (8, "/values/0/center_of_mass", [0, 0]),
    (8, "/values/0/potential_energy", 1),
    (11, "/outcome", "ended"),
    (11, "/reason", "done"),
]


def fits(outcome: str, answer: Any) -> bool:
    """Whether an answer fits the schema of that outcome, if there is one."""
    return outcome in SCHEMAS and Draft202012Validator(SCHEMAS[outcome]).is_valid(answer)


ANSWERS = {word: Draft202012Validator(schema) for word, schema in SCHEMAS.items() if "outcome" in schema["properties"]}

# Text that is no Unicode, a lone surrogate, is none in JSON either.
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=3)
words = st.sampled_from(["", "a", "j", "3d", "6d", "1", "2", "error", "warning", "accept", "fixed", "rejected", "1.0"])
numbers = (
    st.integers(-2, 3)
    | st.sampled_from([0.5, -0.0, 1.0, 2.0, 3.0, 2.0**53, 1e22, 1.5e300, 2**53 + 1, 10**30])
    | st.floats(allow_nan=False, allow_infinity=False)
)
members = st.sampled_from(["extra", "issues", "reason", "line", "mimic", "code"]) | texts
scalars = st.none() | st.booleans() | numbers | words | texts
values = st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(words | texts, inner, max_size=3), max_leaves=5
)


def places(value: Any) -> list[tuple[Any, Any]]:
    """Each collection in a value, itself included, with each of its keys or indices."""
    found = []
    if isinstance(value, dict | list):
        for key in list(value) if isinstance(value, dict) else range(len(value)):
            found += [(value, key), *places(value[key])]
    return found


@st.composite
def spoiled_answers(draw: st.DrawFn) -> tuple[str, dict[str, Any]]:
    """A request, and an answer to it that was sound before up to three changes anywhere in it."""
    command, sound = draw(st.sampled_from(SOUND))
    answer: dict[str, Any] = json.loads(json.dumps({"id": 1, **sound}))
    for _ in range(draw(st.integers(1, 3))):
        around, key = draw(st.sampled_from(places(answer)))
        match draw(st.sampled_from(["replace", "remove", "add", "wrap", "unwrap", "other"])):
            case "replace":
                around[key] = draw(values)
            case "remove":
                del around[key]
            case "add" if isinstance(around, dict):
                around[draw(st.sampled_from(["extra", "issues", "reason", "line", "mimic", "code"]) | texts)] = draw(
                    values
                )
            case "add":
                around.insert(key, draw(values))
            case "wrap":
                around[key] = [around[key]]
            case "unwrap" if isinstance(around[key], list) and around[key]:
                around[key] = around[key][0]
            case "other":
                there, what = draw(st.sampled_from(places(answer)))
                around[key] = json.loads(json.dumps(there[what]))
        if not answer:
            break
    return command, answer


@pytest.mark.slow
@settings(max_examples=500, deadline=None)
@given(spoiled_answers())
@example(("load", {"id": 1, "outcome": "rejected", "issues": [{"message": "m", "line": 1e22}]}))
@example(("load", {"id": 1e22, "outcome": "rejected", "issues": []}))
@example(("evaluate", {"id": 1.0, "outcome": "evaluated", "values": [{"mass": 10**30}]}))
def test_runner_and_schemas_agree_on_spoiled_answers(spoiled: tuple[str, dict[str, Any]]) -> None:
    command, answer = spoiled
    identity = answer.get("id")
    if isinstance(identity, int | float) and not isinstance(identity, bool) and identity == int(identity):
        request = REQUESTS[command].model_copy(update={"id": int(identity)})  # so that it is not misplaced
    else:
        request = REQUESTS[command]
    found = read_answer(json.dumps(answer).encode(), request)
    # Whether it answers this request is another question than whether it is an answer.
    taken = not isinstance(found, Malformed) or re.search("is not an answer to|configurations, expected", found.why)
    assert bool(taken) == any(validator.is_valid(answer) for validator in ANSWERS.values()), str(found)


def test_the_files_are_current() -> None:
    written = {path.name: path.read_text(encoding="utf-8") for path in FOLDER.iterdir()}
    assert written == {f"{word}.schema.json": schema_text(schema) for word, schema in SCHEMAS.items()}, (
        "python -m eurdf_conformance.protocol.schema"
    )


def test_the_command_writes_the_files(tmp_path: Path) -> None:
    main(tmp_path / "schema")
    assert {path.name for path in (tmp_path / "schema").iterdir()} == {path.name for path in FOLDER.iterdir()}


def test_each_message_has_a_valid_schema_with_its_own_id() -> None:
    assert set(SCHEMAS) == {
        "start", "load", "evaluate", "stop",
        "started", "accepted", "rejected", "evaluated", "stopped", "unsupported", "skipped", "errored",
    }  # fmt: skip
    for word, schema in SCHEMAS.items():
        Draft202012Validator.check_schema(schema)
        assert schema["$id"] == f"urn:extended-urdf:protocol:1.0:{word}"


@pytest.mark.parametrize("command", REQUESTS)
def test_a_request_fits_only_its_schema_and_needs_each_member(command: str) -> None:
    request = json.loads(REQUESTS[command].model_dump_json())
    assert [word for word in SCHEMAS if fits(word, request)] == [command]
    assert REQUEST.validate_json(json.dumps(request)) == REQUESTS[command]
    for member in request:
        assert not fits(command, {key: value for key, value in request.items() if key != member})


@pytest.mark.parametrize(("command", "answer"), SOUND)
def test_a_valid_answer_fits_only_its_schema_and_is_accepted(command: str, answer: dict[str, Any]) -> None:
    answer = {"id": 1, **answer}
    assert [word for word in SCHEMAS if fits(word, answer)] == [answer["outcome"]]
    found = read_answer(json.dumps(answer).encode(), REQUESTS[command])
    assert not isinstance(found, Malformed | Misplaced), str(found)


@pytest.mark.parametrize(("index", "pointer", "new"), BROKEN)
def test_an_answer_is_malformed_if_it_violates_the_schema(index: int, pointer: str, new: Any) -> None:
    command, sound = SOUND[index]
    answer = changed({"id": 1, **sound}, pointer, new)
    assert not fits(answer["outcome"], answer)
    found = read_answer(json.dumps(answer).encode(), REQUESTS[command])
    assert isinstance(found, Malformed)
    assert found.placed


@pytest.mark.parametrize("identity", [None, "1", True, 1.5, [1]])
def test_an_id_is_a_whole_number(identity: Any) -> None:
    answer = {"id": identity, "outcome": "stopped"}
    assert not fits("stopped", answer)
    found = read_answer(json.dumps(answer).encode(), REQUESTS["stop"])
    assert isinstance(found, Malformed)
    assert not found.placed


def test_an_answer_with_another_id_is_misplaced() -> None:
    for answer in ({"id": 2, "outcome": "stopped"}, {"id": 2}, {"id": 2, "outcome": "accepted", "robot": 3}):
        found = read_answer(json.dumps(answer).encode(), REQUESTS["stop"])
        assert isinstance(found, Misplaced)
        assert (found.expected_id, found.given_id) == (1, 2)


@pytest.mark.parametrize("outcome", ["unsupported", "skipped", "errored"])
def test_only_stopped_answers_stop(outcome: str) -> None:
    answer = {"id": 1, **next(sound for _, sound in SOUND if sound["outcome"] == outcome)}
    found = read_answer(json.dumps(answer).encode(), REQUESTS["stop"])
    assert isinstance(found, Malformed)
    assert f"'{outcome}' is not an answer to 'stop'" in found.why


@pytest.mark.parametrize("text", ["NaN", "Infinity", "-Infinity"])
def test_non_json_constant_is_refused(text: str) -> None:
    answer = {"id": 1, "outcome": "accepted", "robot": ROBOT}
    said = json.dumps(answer).replace('"two"', text).encode()
    found = read_answer(said, REQUESTS["load"])
    assert isinstance(found, Malformed)
    assert found.why == f"/robot/own/~1x-a/deep/1: {text} is not JSON"
    quoted = json.dumps(answer).replace('"two"', f'"{text}"').encode()
    assert not isinstance(read_answer(quoted, REQUESTS["load"]), Malformed)


class Named:
    """A parser in Python that accepts whatever it is to load."""

    name, version, language = "named", "1", "Python"
    claims: ClassVar[dict[Version, list[Level]]] = {"2": [Level.ACCEPT]}

    def load(self, description: Path, urdf: Path) -> Accepted:
        return accepted()


#: Texts in an answer to `load`, with what is there instead, and what is reported.
TWICE = [
    ('"outcome": "accepted"', '"outcome": "rejected", "outcome": "accepted"', "(top level): duplicate key 'outcome'"),
    ('"outcome": "accepted"', '"outcome":"accepted","outcome"\t:\t"rejected"', "(top level): duplicate key 'outcome'"),
    ('"root": "fixed"', '"root": "fixed", "root": "fixed"', "/robot: duplicate key 'root'"),
    ('"name": "j"', '"name": "i", "name": "j"', "/robot/joints/0: duplicate key 'name'"),
    ('"home": ', '"home": {"j": [9]}, "home": ', "/robot/configurations: duplicate key 'home'"),
    ('"two"', '{"k": 1, "k": {"l": 2}}', "/robot/own/~1x-a/deep/1: duplicate key 'k'"),
    ('"two"', '[{"k": "\\u003a", "k": 1}]', "/robot/own/~1x-a/deep/1/0: duplicate key 'k'"),
    ('"deep": ', '"a:b": 1, "a\\u003ab": ":", "deep": ', "/robot/own/~1x-a: duplicate key 'a:b'"),
    ('"issues"', '"verdict": 1, "verdict": 2, "issues"', "(top level): duplicate key 'verdict'"),
]


@pytest.mark.parametrize(("before", "after", "told"), TWICE, ids=[told for *_, told in TWICE])
def test_duplicate_key_is_malformed(before: str, after: str, told: str) -> None:
    sound = json.dumps({"id": 1, "outcome": "accepted", "robot": ROBOT, "issues": []})
    assert sound.count(before) == 1
    found = read_answer(sound.replace(before, after).encode(), REQUESTS["load"])
    assert isinstance(found, Malformed)
    assert found.placed
    assert found.why == told


@pytest.mark.parametrize("ids", [(1, 2), (2, 1), (1, 1)])
def test_an_answer_with_two_ids_answers_no_request(ids: tuple[int, int]) -> None:
    line = '{{"id": {}, "id": {}, "outcome": "rejected", "issues": []}}'.format(*ids)
    found = read_answer(line.encode(), REQUESTS["load"])
    assert isinstance(found, Malformed)
    assert not found.placed
    assert found.why == "duplicate key 'id'"


@pytest.mark.parametrize("text", [r"\"id\": 1, \"id\": 2", r"\u0022k\u0022\u003a 1, \"k\": 1", "::"])
def test_text_can_look_like_duplicate_keys(text: str) -> None:
    line = json.dumps({"id": 1, "outcome": "accepted", "robot": ROBOT}).replace("two", text)
    assert not isinstance(read_answer(line.encode(), REQUESTS["load"]), Malformed)


@pytest.mark.parametrize(
    ("short", "pointer"),
    [('"two"', "/robot/own/~1x-a/deep/1"), ("-7", "/issues/0/line"), ("50", "/robot/actuators/0/gear_ratio/0")],
)
@pytest.mark.parametrize("number", ["1" * 5000, "1" * 310, "1E+309", "-12.5e400", "1" * 250 + "e99"])
def test_number_beyond_a_double_is_reported(short: str, pointer: str, number: str) -> None:
    issue = {"message": "m", "line": -7}
    text = json.dumps({"id": 1, "outcome": "accepted", "robot": ROBOT, "issues": [issue]})
    assert text.count(short) == 1
    found = read_answer(text.replace(short, number).encode(), REQUESTS["load"])
    assert isinstance(found, Malformed)
    assert found.placed
    assert found.why == f"{pointer}: a number is beyond the range of a double"


@pytest.mark.parametrize("number", ["1e308", "1" * 309, "1e-400", "0.1e+0308"])
def test_numbers_in_the_range_of_a_double_are_read(number: str) -> None:
    text = json.dumps({"id": 1, "outcome": "accepted", "robot": ROBOT})
    assert not isinstance(read_answer(text.replace('"two"', number).encode(), REQUESTS["load"]), Malformed)


def test_python_adapter_refuses_duplicate_keys() -> None:
    line = b'{"id": 3, "command": "load", "description": "/a", "description": "/b", "urdf": "/c"}'
    answers = io.BytesIO()
    serve(Named(), [line], answers)
    answer = json.loads(answers.getvalue())
    told = "not a request of protocol 1.0: (top level): duplicate key 'description'"
    assert answer == {"id": 3, "outcome": "errored", "message": told}


def test_several_errors_are_reported_with_pointers() -> None:
    answer = {
        "id": 1,
        "outcome": "accepted",
        "robot": changed(ROBOT, "/joints/0/lower", ["low"]),
        "issues": 3,
        "a/b": 1,
    }
    found = read_answer(json.dumps(answer).encode(), REQUESTS["load"])
    assert isinstance(found, Malformed)
    for pointer in ("/robot/joints/0/lower/0: ", "/issues: ", "/a~1b: "):
        assert pointer in found.why


def test_a_message_cannot_be_changed() -> None:
    with pytest.raises(ValidationError):
        REQUESTS["stop"].id = 3
    assert ANSWER.validate_json('{"id": 1, "outcome": "stopped"}').id == 1
