"""Version 1, the published dialect: what is read from it, and what is found wrong in it."""

from __future__ import annotations

import pytest

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
    extension, diagnostics = read(text)
    assert not list(diagnostics)
    assert extension is not None
    return extension


PUBLISHED = """\
closed_loop: [[rod_tip, knee_crank], [ankle_A, ankle_B]]
type: [3D, 6d]
name_mot: [motor_hip, motor_knee]
joint_name: [hip_ball, cardan, brace]
joint_type: [SPHERICAL, UJOINT_ZX, FIXED]
"""


def test_closures_are_named_by_order_with_places() -> None:
    first, second = sound(PUBLISHED).closures
    assert (first.name, first.type) == ("closure_1", "3d")
    assert (second.name, second.type) == ("closure_2", "6d")
    assert first.a == FrameReference(("closed_loop", 0, 0), name="rod_tip")
    assert second.b == FrameReference(("closed_loop", 1, 1), name="ankle_B")


def test_closures_are_6d_by_default() -> None:
    extension = sound("closed_loop: [[a, b], [c, d]]\n")
    assert [closure.type for closure in extension.closures] == ["6d", "6d"]


def test_joint_types_are_translated() -> None:
    joints = sound(PUBLISHED).joints
    assert [(joint.name, joint.type, joint.split) for joint in joints] == [
        ("hip_ball", "spherical", ""),
        ("cardan", "universal", "ZX"),
        ("brace", "fixed", ""),
    ]
    assert joints[1].pointer == ("joint_name", 1)


def test_actuators_keep_order_and_place() -> None:
    actuators = sound(PUBLISHED).actuators
    assert [(actuator.joint, actuator.pointer) for actuator in actuators] == [
        ("motor_hip", ("name_mot", 0)),
        ("motor_knee", ("name_mot", 1)),
    ]


def test_version_1_merges_and_has_fixed_root() -> None:
    extension = sound(PUBLISHED)
    assert extension.version == "1"
    assert (extension.urdf, extension.root) == ("robot.urdf", "fixed")


def test_other_keys_are_user_data() -> None:
    extension = sound("closed_loop: []\nnotes: {mass: [1, 2]}\nx-type: any\n")
    assert extension.own_data == {("notes",): {"mass": [1, 2]}, ("x-type",): "any"}


def test_file_without_known_keys_is_accepted() -> None:
    extension = sound("notes: none\n")
    assert extension.closures == extension.joints == extension.actuators == ()


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("closed_loops", "closed_loop"),
        ("closed-loop", "closed_loop"),
        ("types", "type"),
        ("Type", "type"),
        ("name_mots", "name_mot"),
        ("joint_names", "joint_name"),
        ("joint_tpye", "joint_type"),
        ("extended-urdf", "extended_urdf"),
    ],
)
def test_near_miss_key_is_warned_and_kept(key: str, meant: str) -> None:
    extension, diagnostics = read(f"closed_loop: [[a, b]]\n{key}: [1]\n")
    assert extension is not None
    assert extension.own_data == {(key,): [1]}
    (warning,) = diagnostics
    assert (warning.code, warning.line, warning.column) == ("near-miss-key", 2, 1)
    assert warning.hint == f"did you mean '{meant}'?"


@pytest.mark.parametrize("key", ["name", "notes", "time", "joint", "loop", "metadata", "x-types", "mass"])
def test_other_key_is_kept_silently(key: str) -> None:
    assert sound(f"closed_loop: []\n{key}: 1\n").own_data == {(key,): 1}


def test_version_2_key_in_version_1_is_warned() -> None:
    extension, diagnostics = read("closed_loop: []\nactuators: [motor]\n")
    assert extension is not None
    assert extension.actuators == ()
    (warning,) = diagnostics
    assert warning.code == "near-miss-key"
    assert "version 2.0" in warning.message


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("closures: []\n", "closures"),
        ("notes: 1\nactuators: [motor]\n", "actuators"),
        ("root: floating\n", "root"),
        ("metadata: {}\nactuators: [motor]\n", "metadata"),
        ('extended-urdf: "2.0"\nclosures: []\n', "extended-urdf"),
        ('Extended_URDF: "2.0"\n', "Extended_URDF"),
    ],
)
def test_version_2_without_version_is_not_version_1(text: str, key: str) -> None:
    extension, diagnostics = read(text)
    assert extension is None
    (error,) = diagnostics
    assert error.code == "missing-key"
    assert error.pointer == f"/{key}"
    assert f"'{key}'" in error.message
    assert "'extended_urdf'" in error.message


# text, code, pointer, line, column, part of the message or hint
ERRORS = [
    ("closed_loop: {a: b}\n", "wrong-type", "/closed_loop", 1, 14, "must be a list, not a mapping"),
    ("closed_loop: [a, b]\n", "wrong-type", "/closed_loop", 1, 14, "[[A, B], …]"),
    ("closed_loop: [[a, b], c]\n", "wrong-type", "/closed_loop/1", 1, 23, "item 2 of 'closed_loop' must be a list"),
    ("closed_loop: [[a, b], [c]]\n", "wrong-length", "/closed_loop/1", 1, 23, "must have 2 items, not 1"),
    ("closed_loop: [[a, b, c]]\n", "wrong-length", "/closed_loop/0", 1, 15, "must have 2 items, not 3"),
    ("closed_loop: [[a, 3]]\n", "wrong-type", "/closed_loop/0/1", 1, 19, "quote a name"),
    ("closed_loop: [[a, true]]\n", "wrong-type", "/closed_loop/0/1", 1, 19, "quote a name"),
    ('closed_loop: [[a, ""]]\n', "wrong-value", "/closed_loop/0/1", 1, 19, "is empty"),
    ("closed_loop:\n", "wrong-type", "/closed_loop", 1, None, "remove the key"),
    ("closed_loop: [[a, b]]\ntype: 3d\n", "wrong-type", "/type", 2, 7, "write it as a list: [3d]"),
    ("closed_loop: [[a, b]]\ntype: [4d]\n", "wrong-value", "/type/0", 2, 8, "'3d', '3D', '6d' or '6D', not '4d'"),
    ("closed_loop: [[a, b]]\ntype: [3]\n", "wrong-type", "/type/0", 2, 8, "not 3"),
    ("closed_loop: [[a, b]]\ntype: []\n", "length-mismatch", "/type", 2, 7, "not 1 and 0"),
    ("closed_loop: [[a, b]]\ntype: [3d, 6d]\n", "length-mismatch", "/closed_loop", 1, 14, "same number of items"),
    ("type: [3d]\n", "length-mismatch", "/type", 1, 7, "not 0 and 1"),
    ("name_mot: motor\n", "wrong-type", "/name_mot", 1, 11, "write it as a list: [motor]"),
    ("name_mot: [1]\n", "wrong-type", "/name_mot/0", 1, 12, "must be text, not 1"),
    ("joint_name: [hip]\n", "missing-key", "/joint_name", 1, 1, "lacks 'joint_type'"),
    ("joint_type: [FIXED]\n", "missing-key", "/joint_type", 1, 1, "lacks 'joint_name'"),
    ("joint_name: [a, b]\njoint_type: [FIXED]\n", "length-mismatch", "/joint_type", 2, 13, "not 2 and 1"),
    ("joint_name: [a]\njoint_type: [spherical]\n", "wrong-value", "/joint_type/0", 2, 14, "did you mean 'SPHERICAL'?"),
    ("joint_name: [a]\njoint_type: [UJOINT_XX]\n", "wrong-value", "/joint_type/0", 2, 14, "not 'UJOINT_XX'"),
]


@pytest.mark.parametrize(("text", "code", "pointer", "line", "column", "said"), ERRORS)
def test_one_error_gives_one_diagnostic(
    text: str, code: str, pointer: str, line: int, column: int | None, said: str
) -> None:
    extension, diagnostics = read(text)
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.pointer, found.line) == (code, pointer, line)
    assert column is None or found.column == column
    assert said in f"{found.message} ({found.hint})"


def test_several_errors_are_reported_in_order() -> None:
    _, diagnostics = read("name_mot: 1\nclosed_loop: [[a]]\ntype: [x]\n")
    assert [found.code for found in diagnostics] == ["wrong-type", "wrong-length", "wrong-value"]


def test_number_of_reported_errors_is_bounded() -> None:
    _, diagnostics = read("name_mot: [" + "1, " * 20_000 + "]\n")
    found = list(diagnostics)
    assert len(found) == 100
    assert found[-1].hint is not None
    assert "19,900 more errors" in found[-1].hint
