"""Version 2.0: what is read from it, and what is found wrong in it."""

from __future__ import annotations

import subprocess
import sys
import timeit
from collections.abc import Iterator
from typing import Any

import pytest
import yaml

from eurdf.diagnostics import Diagnostics
from eurdf.format.extension import Extension, FrameReference
from eurdf.format.read_extension import read_extension
from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml


def read(text: str) -> tuple[Extension | None, Diagnostics]:
    diagnostics = Diagnostics()
    document = read_yaml(Source("robot.yaml", text, text.encode()))
    return read_extension(document, diagnostics), diagnostics


def sound(text: str) -> Extension:
    extension, diagnostics = read('extended_urdf: "2.0"\n' + text)
    assert not list(diagnostics)
    assert extension is not None
    return extension


FULL = """\
extended_urdf: "2.0"
urdf: leg.urdf
root: floating
closures:
  - name: knee_rod
    type: 6d
    frames: [rod_tip, knee_crank]
  - name: ankle_rod
    type: 3d
    frames:
      - {link: rod, xyz: [0, 0, 0.31]}
      - {joint: ankle, rpy: [0, 1.5, 0]}
  - {name: differential, type: x-gear, frames: [a, b], x-ratio: 3}
joints:
  hip_ball: spherical
  brace: fixed
  slider: cylindrical
  knee_cardan: {type: universal, axes: zx}
  hip_cardan: {type: universal, axes: [[1, 0, 0], [0, 0.6, 0.8]], damping: [0.1, 0.2]}
  toe_ball: {type: spherical, merges: [toe_rx, toe_ry, toe_rz]}
  ball_screw: {type: helical, pitch: 0.005, limits: {lower: -1, upper: [2.5]}}
  motor_knee: {limits: {velocity: 12.0, effort: 80}, friction: 1, armature: 0.02}
actuators:
  - motor_hip
  - {joint: motor_knee, gear_ratio: -50, rotor_inertia: 1.2e-4}
frames:
  - {name: toe_tip, link: foot, xyz: [0.12, 0, -0.03]}
  - {name: heel, joint: ankle}
configurations:
  assembled: {motor_knee: 0.4, hip_ball: [0, 0, 0, 1]}
  ready: {}
metadata: {license: BSD-3-Clause, anything: [1, null]}
x-note: kept
"""


def full() -> Extension:
    extension, diagnostics = read(FULL)
    assert not list(diagnostics)
    assert extension is not None
    return extension


def test_top_level_is_read() -> None:
    extension = full()
    assert (extension.version, extension.urdf, extension.root) == ("2.0", "leg.urdf", "floating")
    assert extension.metadata == {"license": "BSD-3-Clause", "anything": [1, None]}
    assert extension.own_data[("x-note",)] == "kept"


def test_defaults_are_applied() -> None:
    assert sound("") == Extension(
        read_yaml(Source("robot.yaml", "{}", b"{}")), version="2.0", urdf="robot.urdf", root="fixed"
    )


def test_closure_joins_named_frames_or_poses() -> None:
    rod, ankle, _ = full().closures
    assert (rod.name, rod.type, rod.pointer) == ("knee_rod", "6d", ("closures", 0))
    assert rod.b == FrameReference(("closures", 0, "frames", 1), name="knee_crank")
    assert ankle.a == FrameReference(("closures", 1, "frames", 0), "rod", "link", xyz=(0.0, 0.0, 0.31))
    assert ankle.b == FrameReference(("closures", 1, "frames", 1), "ankle", "joint", rpy=(0.0, 1.5, 0.0))


def test_closure_can_have_user_defined_type() -> None:
    assert full().closures[2].type == "x-gear"


def test_joints_are_read_in_all_forms() -> None:
    joints = {joint.name: joint for joint in full().joints}
    assert {name: joint.type for name, joint in joints.items()} == {
        "hip_ball": "spherical",
        "brace": "fixed",
        "slider": "cylindrical",
        "knee_cardan": "universal",
        "hip_cardan": "universal",
        "toe_ball": "spherical",
        "ball_screw": "helical",
        "motor_knee": None,
    }
    assert joints["knee_cardan"].axes == ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
    assert joints["hip_cardan"].axes == ((1.0, 0.0, 0.0), (0.0, 0.6, 0.8))
    assert joints["hip_cardan"].damping == (0.1, 0.2)
    assert joints["toe_ball"].merges == ("toe_rx", "toe_ry", "toe_rz")
    assert joints["ball_screw"].pitch == 0.005
    assert (joints["ball_screw"].lower, joints["ball_screw"].upper) == (-1.0, (2.5,))
    knee = joints["motor_knee"]
    assert (knee.velocity, knee.effort, knee.friction, knee.armature) == (12.0, 80.0, 1.0, 0.02)
    assert knee.lower is knee.upper is knee.damping is None
    assert knee.pointer == ("joints", "motor_knee")


def test_actuators_frames_and_configurations_are_read() -> None:
    extension = full()
    hip, knee = extension.actuators
    assert (hip.joint, hip.gear_ratio, hip.rotor_inertia) == ("motor_hip", None, None)
    assert (knee.joint, knee.gear_ratio, knee.rotor_inertia) == ("motor_knee", -50.0, 1.2e-4)
    toe, heel = extension.frames
    assert (toe.name, toe.reference.name, toe.reference.xyz) == ("toe_tip", "foot", (0.12, 0.0, -0.03))
    assert (heel.name, heel.reference.name, heel.reference.kind, heel.pointer) == (
        "heel",
        "ankle",
        "joint",
        ("frames", 1),
    )
    assembled, ready = extension.configurations
    assert assembled.joints == {"motor_knee": (0.4,), "hip_ball": (0.0, 0.0, 0.0, 1.0)}
    assert (ready.name, ready.joints) == ("ready", {})


def test_integers_are_read_as_numbers() -> None:
    knee = next(joint for joint in full().joints if joint.name == "motor_knee")
    assert isinstance(knee.effort, float)


def mappings(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The places of mappings in a value."""
    if isinstance(value, dict):
        yield path
        for key, item in value.items():
            yield from mappings(item, (*path, key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from mappings(item, (*path, index))


@pytest.mark.parametrize("path", list(mappings(yaml.safe_load(FULL))), ids=str)
def test_user_keys_are_allowed_in_every_mapping(path: tuple[str | int, ...]) -> None:
    data = yaml.safe_load(FULL)
    mapping = data
    for step in path:
        mapping = mapping[step]
    mapping["x-own"] = {"any": [None, True]}
    extension, diagnostics = read(yaml.safe_dump(data, sort_keys=False))
    assert not list(diagnostics)
    assert extension is not None
    before, after = full(), extension
    for part in ("closures", "joints", "actuators", "frames", "configurations"):
        assert getattr(after, part) == getattr(before, part)


def test_user_data_are_kept_and_not_interpreted() -> None:
    text = "x-a: {x-b: 1}\nclosures: [{name: c, type: 3d, frames: [a, b], x-d: [1]}]\nmetadata: {x-e: 2}\n"
    extension = sound(text)
    assert extension.own_data == {("x-a",): {"x-b": 1}, ("closures", 0, "x-d"): [1], ("metadata", "x-e"): 2}
    assert extension.metadata == {"x-e": 2}


def test_user_keys_among_joint_names_are_kept() -> None:
    extension = sound("joints: {x-rail: fixed}\nconfigurations: {x-old: {x-a: 1}, ready: {x-rail: 1, hip: 2}}\n")
    assert extension.joints == ()
    assert set(extension.own_data) == {
        ("joints", "x-rail"),
        ("configurations", "x-old"),
        ("configurations", "ready", "x-rail"),
    }
    (ready,) = extension.configurations
    assert ready.joints == {"hip": (2.0,)}


VERSIONS = [
    ("2.0", "wrong-type", "in quotes"),
    ("2", "wrong-type", "in quotes"),
    ("[2.0]", "wrong-type", "in quotes"),
    ("true", "wrong-type", "in quotes"),
    ("null", "wrong-type", "in quotes"),
    ("3", "wrong-type", "in quotes"),
    ("2.1", "wrong-type", 'write extended_urdf: "2.1", in quotes'),
    ('"2.2"', "unsupported-version", "2.0 and 2.1"),
    ('""', "unsupported-version", 'extended_urdf: "2.0"'),
    ('"1"', "unsupported-version", "leave 'extended_urdf' out"),
    ("1.0", "wrong-type", "leave 'extended_urdf' out"),
]


@pytest.mark.parametrize(("value", "code", "hint"), VERSIONS)
def test_other_version_is_refused_with_hint(value: str, code: str, hint: str) -> None:
    extension, diagnostics = read(f"extended_urdf: {value}\nclosures: []\n")
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.pointer, found.line, found.column) == (code, "/extended_urdf", 1, 16)
    assert found.hint is not None
    assert hint in found.hint


def test_unquoted_version_hides_no_other_errors() -> None:
    _, diagnostics = read("extended_urdf: 2.0\nroot: loose\n")
    assert [found.code for found in diagnostics] == ["wrong-type", "wrong-value"]


def test_unknown_version_is_the_only_diagnostic() -> None:
    _, diagnostics = read('extended_urdf: "3.0"\nroot: loose\nnew: 1\n')
    assert [found.code for found in diagnostics] == ["unsupported-version"]


CLOSURE = "closures: [{name: rod, type: 3d, frames: [a, b]}]"

# one line of the file, code, pointer, column, part of the message or hint
ERRORS = [
    # keys
    ("closuers: []", "unknown-key", "/closuers", 1, "did you mean 'closures'?"),
    ("Root: fixed", "unknown-key", "/Root", 1, "did you mean 'root'?"),
    ("mass: 3", "unknown-key", "/mass", 1, "begin with 'x-'"),
    ("closed_loop: [[a, b]]", "unknown-key", "/closed_loop", 1, "use 'closures'"),
    ("name_mot: [a]", "unknown-key", "/name_mot", 1, "use 'actuators'"),
    ("joint_type: [FIXED]", "unknown-key", "/joint_type", 1, "use 'joints'"),
    (CLOSURE.replace("name", "nmae"), "unknown-key", "/closures/0/nmae", 13, "did you mean 'name'?"),
    (CLOSURE.replace("}", ", stiffness: 1}"), "unknown-key", "/closures/0/stiffness", 50, "'closures'"),
    (CLOSURE.replace("name: rod, ", ""), "missing-key", "/closures/0", 12, "item 1 of 'closures' lacks 'name'"),
    (CLOSURE.replace("type: 3d, ", ""), "missing-key", "/closures/0", 12, "lacks 'type'"),
    (CLOSURE.replace(", frames: [a, b]", ""), "missing-key", "/closures/0", 12, "lacks 'frames'"),
    (CLOSURE.replace("b]", "{xyz: [0, 0, 1]}]"), "missing-key", "/closures/0/frames/1", 46, "'link' or 'joint'"),
    (CLOSURE.replace("b]", "{lnik: c}]"), "unknown-key", "/closures/0/frames/1/lnik", 47, "did you mean 'link'?"),
    (CLOSURE.replace("b]", "{jiont: c}]"), "unknown-key", "/closures/0/frames/1/jiont", 47, "did you mean 'joint'?"),
    (CLOSURE.replace("b]", "{link: c, joint: d}]"), "conflicting-keys", "/closures/0/frames/1/joint", 56, "not both"),
    ("frames: [{link: a}]", "missing-key", "/frames/0", 10, "lacks 'name'"),
    ("frames: [{name: a, link: b, joint: c}]", "conflicting-keys", "/frames/0/joint", 29, "not both"),
    ("frames: [{name: a}]", "missing-key", "/frames/0", 10, "lacks 'link' or 'joint'"),
    ("frames: [{}]", "missing-key", "/frames/0", 10, "lacks 'name' and 'link' or 'joint'"),
    ("closures: [{}]", "missing-key", "/closures/0", 12, "lacks 'name', 'type' and 'frames'"),
    ("closures: [{type: 3d}]", "missing-key", "/closures/0", 12, "lacks 'name' and 'frames'"),
    ("frames: [tip]", "wrong-type", "/frames/0", 10, "{name: …, link: …"),
    ("actuators: [{gear_ratio: 2}]", "missing-key", "/actuators/0", 13, "lacks 'joint'"),
    ("actuators: [{joint: a, ratio: 2}]", "unknown-key", "/actuators/0/ratio", 24, "did you mean 'gear_ratio'?"),
    # joints
    ("joints: {k: {}}", "missing-key", "/joints/k", 13, "at least one of 'limits'"),
    ("joints: {k: {x-a: 1}}", "missing-key", "/joints/k", 13, "at least one of 'limits'"),
    ("joints: {k: {limits: {}}}", "missing-key", "/joints/k/limits", 22, "at least one of 'lower'"),
    ("joints: {k: {type: universal}}", "missing-key", "/joints/k", 13, "joint 'k' lacks 'axes'"),
    ("joints: {k: {type: helical}}", "missing-key", "/joints/k", 13, "lacks 'pitch'"),
    ("joints: {k: {merges: [a, b, c]}}", "missing-key", "/joints/k", 13, "lacks 'type'"),
    ("joints: {k: {tpye: helical, pitch: 1}}", "unknown-key", "/joints/k/tpye", 14, "did you mean 'type'?"),
    ("joints: {k: {tpye: fixed}}", "unknown-key", "/joints/k/tpye", 14, "did you mean 'type'?"),
    ("joints: {k: {type: universal, axs: xy}}", "unknown-key", "/joints/k/axs", 31, "did you mean 'axes'?"),
    ("joints: {k: {type: fixed, axes: xy}}", "conflicting-keys", "/joints/k/axes", 27, "belongs to type 'universal'"),
    ("joints: {k: {type: spherical, pitch: 1}}", "conflicting-keys", "/joints/k/pitch", 31, "to type 'helical'"),
    ("joints: {k: {limits: {lowr: 1}}}", "unknown-key", "/joints/k/limits/lowr", 23, "did you mean 'lower'?"),
    ("joints: {k: sferical}", "wrong-value", "/joints/k", 13, "did you mean 'spherical'?"),
    ("joints: {k: SPHERICAL}", "wrong-value", "/joints/k", 13, "did you mean 'spherical'?"),
    ("joints: {k: universal}", "wrong-value", "/joints/k", 13, "{type: universal, axes: xy}"),
    ("joints: {k: helical}", "wrong-value", "/joints/k", 13, "{type: helical, pitch: 0.005}"),
    ("joints: {k: revolute}", "wrong-value", "/joints/k", 13, "keeps its URDF type"),
    ("joints: {k: {type: sferical, axes: xy}}", "wrong-value", "/joints/k/type", 20, "did you mean 'spherical'?"),
    ("joints: {k: {type: 3, axes: xy}}", "wrong-type", "/joints/k/type", 20, "not 3"),
    ("joints: {k: {type: }}", "wrong-type", "/joints/k/type", None, "not null"),
    ("joints: {k: 3}", "wrong-type", "/joints/k", 13, "must be a joint type, or a mapping"),
    ("joints: {k: ~}", "wrong-type", "/joints/k", 13, "remove the key"),
    ("joints: [k]", "wrong-type", "/joints", 9, "must be a mapping"),
    ('joints: {"": fixed}', "wrong-value", "/joints/", 10, "a name in 'joints' is empty"),
    ("joints: {universal: {type: universal, axes: XY}}", "wrong-value", "/joints/universal/axes", 45, "mean 'xy'?"),
    ("joints: {k: {type: universal, axes: xx}}", "wrong-value", "/joints/k/axes", 37, "not 'xx'"),
    ("joints: {k: {type: universal, axes: 3}}", "wrong-type", "/joints/k/axes", 37, "two letters such as xy"),
    ("joints: {k: {type: universal, axes: [[1, 0, 0]]}}", "wrong-length", "/joints/k/axes", 37, "must have 2 items"),
    ("joints: {k: {type: universal, axes: [[1, 0], [0, 1, 0]]}}", "wrong-length", "/joints/k/axes/0", 38, "3 items"),
    ("joints: {k: {type: spherical, merges: [a, b]}}", "wrong-length", "/joints/k/merges", 39, "3 items, not 2"),
    ("joints: {k: {type: helical, pitch: 1_000}}", "wrong-type", "/joints/k/pitch", 36, "write the number as 1000"),
    ("joints: {k: {type: helical, pitch: '0,5'}}", "wrong-type", "/joints/k/pitch", 36, "write the number as 0.5"),
    ("joints: {k: {type: helical, pitch: true}}", "wrong-type", "/joints/k/pitch", 36, "must be a number, not true"),
    ("joints: {k: {armature: -1}}", "out-of-range", "/joints/k/armature", 24, "must be at least 0, not -1"),
    ("joints: {k: {damping: [0, -0.5]}}", "out-of-range", "/joints/k/damping/1", 27, "item 2 of 'damping'"),
    ("joints: {k: {friction: []}}", "wrong-length", "/joints/k/friction", 24, "at least 1 item, not 0"),
    (
        "joints: {k: {damping: [1, 1, 1, 1, 1, 1, 1]}}",
        "wrong-length",
        "/joints/k/damping",
        23,
        "at most 6 items, not 7",
    ),
    ("joints: {k: {limits: {effort: -2}}}", "out-of-range", "/joints/k/limits/effort", 31, "at least 0"),
    ("joints: {k: {limits: {lower: no}}}", "wrong-type", "/joints/k/limits/lower", 30, "not 'no'"),
    ("joints: {k: {limits: 3}}", "wrong-type", "/joints/k/limits", 22, "must be a mapping, not 3"),
    # closures, actuators, frames, configurations
    (CLOSURE.replace("3d", "3D"), "wrong-value", "/closures/0/type", 30, "did you mean '3d'?"),
    (CLOSURE.replace("3d", "3"), "wrong-type", "/closures/0/type", 30, "must be '3d' or '6d'"),
    (CLOSURE.replace("rod", '""'), "wrong-value", "/closures/0/name", 19, "'name' is empty"),
    (CLOSURE.replace("rod", "7"), "wrong-type", "/closures/0/name", 19, "quote a name"),
    (CLOSURE.replace("[a, b]", "[a]"), "wrong-length", "/closures/0/frames", 42, "must have 2 items, not 1"),
    (CLOSURE.replace("[a, b]", "[a, 2]"), "wrong-type", "/closures/0/frames/1", 46, "quote a name"),
    (CLOSURE.replace("[a, b]", "{a: b}"), "wrong-type", "/closures/0/frames", 42, "must be a list"),
    ("closures: {rod: 3d}", "wrong-type", "/closures", 11, "must be a list, not a mapping"),
    ("closures: [rod]", "wrong-type", "/closures/0", 12, "must be a mapping, not 'rod'"),
    ("actuators: motor", "wrong-type", "/actuators", 12, "write it as a list: [motor]"),
    ("frames: [{name: tip, link: rod, xyz: 0 0 1}]", "wrong-type", "/frames/0/xyz", 38, "write three numbers"),
    ("actuators: [3]", "wrong-type", "/actuators/0", 13, "quote a name"),
    ("actuators: [{joint: a, gear_ratio: 0}]", "out-of-range", "/actuators/0/gear_ratio", 36, "must not be 0"),
    ("actuators: [{joint: a, gear_ratio: -0.0}]", "out-of-range", "/actuators/0/gear_ratio", 36, "must not be 0"),
    ("actuators: [{joint: a, rotor_inertia: -1}]", "out-of-range", "/actuators/0/rotor_inertia", 39, "at least 0"),
    ("frames: [{name: a, link: b, xyz: [1, 2]}]", "wrong-length", "/frames/0/xyz", 34, "must have 3 items, not 2"),
    ("frames: [{name: a, link: b, rpy: [1, 2, x]}]", "wrong-type", "/frames/0/rpy/2", 41, "must be a number, not 'x'"),
    ("configurations: {c: {k: [1, 2, 3, 4, 5, 6, 7, 8]}}", "wrong-length", "/configurations/c/k", 25, "at most 7"),
    ("configurations: {c: {k: yes}}", "wrong-type", "/configurations/c/k", 25, "a number or a list of numbers"),
    ("configurations: {c: 1}", "wrong-type", "/configurations/c", 21, "configuration 'c' must be a mapping"),
    ("root: Floating", "wrong-value", "/root", 7, "did you mean 'floating'?"),
    ("root: 1", "wrong-type", "/root", 7, "'fixed' or 'floating'"),
    ('urdf: ""', "wrong-value", "/urdf", 7, "'urdf' is empty"),
    ("metadata: BSD", "wrong-type", "/metadata", 11, "must be a mapping"),
    ("closures:", "wrong-type", "/closures", None, "remove the key"),
]


@pytest.mark.parametrize(("line", "code", "pointer", "column", "said"), ERRORS, ids=[error[0] for error in ERRORS])
def test_one_error_gives_one_diagnostic(line: str, code: str, pointer: str, column: int | None, said: str) -> None:
    extension, diagnostics = read(f'extended_urdf: "2.0"\n{line}\n')
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.pointer, found.line) == (code, pointer, 2)
    assert column is None or found.column == column
    assert said in f"{found.message} ({found.hint})"
    assert not found.message.endswith(".")


def test_wrong_and_missing_keys_are_two_errors() -> None:
    _, diagnostics = read('extended_urdf: "2.0"\nclosures: [{names: rod, type: 3d}]\n')
    assert [(found.code, found.message) for found in diagnostics] == [
        ("missing-key", "item 1 of 'closures' lacks 'frames'"),
        ("unknown-key", "item 1 of 'closures' has an unknown key 'names'"),
    ]


def test_joint_named_like_a_keyword_has_right_place() -> None:
    text = 'extended_urdf: "2.0"\njoints: {"fixed joint": {type: fixed, "one number": 1, armature: x}}\n'
    _, diagnostics = read(text)
    assert [found.pointer for found in diagnostics] == [
        "/joints/fixed joint/one number",
        "/joints/fixed joint/armature",
    ]


def test_reading_loads_neither_simulator_nor_models() -> None:
    code = (
        "import sys; from eurdf.format.read_extension import *; from eurdf.reading.yaml_reader import read_yaml;"
        "from eurdf.reading.source import Source; from eurdf.diagnostics import Diagnostics;"
        "text = open(0).read(); source = Source('robot.yaml', text, text.encode());"
        "assert read_extension(read_yaml(source), Diagnostics());"
        "sys.exit(not sys.modules.keys().isdisjoint({'pinocchio', 'numpy', 'pydantic', 'rich'}))"
    )
    for text in (FULL, "name_mot: [knee]\n"):
        assert subprocess.run([sys.executable, "-c", code], input=text.encode(), check=False).returncode == 0


def test_long_or_unprintable_name_is_escaped() -> None:
    _, diagnostics = read('extended_urdf: "2.0"\n? "' + "a" * 5000 + '"\n: 1\n"tab\\there": 1\n')
    long, tab = (found.message for found in diagnostics)
    assert len(long) < 120
    assert "'tab\\there'" in tab


def test_reading_is_well_under_a_millisecond() -> None:
    document = read_yaml(Source("robot.yaml", FULL, FULL.encode()))
    read_extension(document, Diagnostics())  # the validators are built once
    assert min(timeit.repeat(lambda: read_extension(document, Diagnostics()), number=1, repeat=50)) < 1e-3
