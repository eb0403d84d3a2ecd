"""Version 2.1: what it adds to version 2.0, and the errors of a 2.0 file that uses it."""

from __future__ import annotations

import pytest

from eurdf.diagnostics import Diagnostic, Diagnostics
from eurdf.format.extension import Extension
from eurdf.format.read_extension import read_extension, version_of
from eurdf.mechanism.constraint import Compliance
from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml

HINGE = """\
extended_urdf: "2.1"
closures:
  - name: pin
    type: hinge
    frames: [a, b]
"""


DISTANCE = HINGE.replace("hinge", "distance") + "    length: 0.155\n"


COUPLING = """\
extended_urdf: "2.1"
couplings:
  - name: gear
    joints: {a: 2, b: -1.5}
"""


def read(text: str) -> tuple[Extension | None, list[Diagnostic]]:
    diagnostics = Diagnostics()
    document = read_yaml(Source("robot.yaml", text, text.encode()))
    return read_extension(document, diagnostics), list(diagnostics)


@pytest.mark.parametrize(
    ("more", "axes"),
    [
        ("", ((0, 0, 1), (0, 0, 1))),
        ("    axis: [0, 2, 0]\n", ((0, 2, 0), (0, 2, 0))),
        ("    axes: [[0, 2, 0], [1, 0, 1.5]]\n", ((0, 2, 0), (1, 0, 1.5))),
    ],
)
def test_hinge_has_its_axes_or_z(more: str, axes: tuple[tuple[float, ...], ...]) -> None:
    extension, diagnostics = read(HINGE + more)
    assert extension is not None
    assert not diagnostics
    assert extension.version == "2.1"
    (closure,) = extension.closures
    assert (closure.name, closure.type, closure.axes) == ("pin", "hinge", axes)


def test_distance_has_its_length() -> None:
    extension, diagnostics = read(DISTANCE)
    assert extension is not None
    assert not diagnostics
    (closure,) = extension.closures
    assert (closure.type, closure.length) == ("distance", 0.155)


def test_other_closures_have_neither_axes_nor_length() -> None:
    extension, _ = read(HINGE.replace("hinge", "6d"))
    assert extension is not None
    assert (extension.closures[0].axes, extension.closures[0].length) == (None, None)


def test_version_2_0_is_read_alike_with_the_later_version() -> None:
    text = HINGE.replace("hinge", "3d")
    earlier, later = read(text.replace("2.1", "2.0"))[0], read(text)[0]
    assert earlier is not None
    assert later is not None
    assert (earlier.version, later.version) == ("2.0", "2.1")
    assert earlier.closures == later.closures


@pytest.mark.parametrize("version", ["2.0", "2.1"])
def test_version_of_a_file_is_what_it_states(version: str) -> None:
    text = HINGE.replace("2.1", version)
    assert version_of(read_yaml(Source("robot.yaml", text, text.encode()))) == version


@pytest.mark.parametrize(
    ("text", "code", "line"),
    [
        (HINGE, "wrong-value", 4),
        (HINGE + "    axis: [0, 0, 1]\n", "wrong-value", 4),
        (HINGE + "    axes: [[0, 0, 1]]\n", "wrong-value", 4),
        (HINGE.replace("hinge", "3d") + "    axis: [0, 0, 1]\n", "unknown-key", 6),
        (DISTANCE, "wrong-value", 4),
        (DISTANCE.replace("distance", "3d"), "unknown-key", 6),
    ],
)
def test_closure_in_version_2_0_names_the_line_to_change(text: str, code: str, line: int) -> None:
    extension, diagnostics = read("# a robot\n" + text.replace("2.1", "2.0"))
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == (code, line + 1)
    assert found.hint is not None
    assert 'write extended_urdf: "2.1" on line 2' in found.hint


JOINT = 'extended_urdf: "2.1"\njoints:\n  heel: {%s}\n'
ACTUATOR = 'extended_urdf: "2.1"\nactuators:\n  - {joint: heel, %s}\n'


def test_joint_has_springs_and_is_freed() -> None:
    extension, diagnostics = read(JOINT % "stiffness: [2, 3.5], rest: 0.1, mimic: false")
    assert extension is not None
    assert not diagnostics
    (joint,) = extension.joints
    assert (joint.stiffness, joint.rest, joint.freed) == ((2, 3.5), 0.1, True)


def test_joint_without_them_has_none() -> None:
    extension, _ = read(JOINT % "damping: 2")
    assert extension is not None
    (joint,) = extension.joints
    assert (joint.stiffness, joint.rest, joint.freed) == (None, None, False)


def test_actuator_has_name_and_control_range() -> None:
    extension, _ = read(ACTUATOR % "name: left, gear_ratio: 5, control: [-3, 4.5]")
    assert extension is not None
    (actuator,) = extension.actuators
    assert (actuator.name, actuator.gear_ratio, actuator.control) == ("left", 5, (-3, 4.5))


CLOSURE = 'extended_urdf: "2.1"\nclosures:\n  - {name: pin, type: 6d, frames: [a, b], %s}\n'


def test_closure_has_compliance() -> None:
    extension, _ = read(CLOSURE % "compliance: {angular: 1.0e-4}")
    assert extension is not None
    assert extension.closures[0].compliance == Compliance(0.0, 1e-4)


@pytest.mark.parametrize(
    "text",
    [
        CLOSURE % "compliance: {linear: 1}",
        JOINT % "stiffness: 3",
        JOINT % "mimic: false",
        JOINT % "type: fixed, mimic: false",
        JOINT % "type: helical, pitch: 1, stiffness: 3",
        ACTUATOR % "name: left",
        ACTUATOR % "control: [-1, 1]",
    ],
)
def test_key_of_version_2_1_in_version_2_0_names_the_line_to_change(text: str) -> None:
    extension, diagnostics = read(text.replace("2.1", "2.0"))
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == ("unknown-key", 3)
    assert found.hint is not None
    assert 'write extended_urdf: "2.1" on line 1' in found.hint


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        (JOINT % "rest: 0.1", "missing-key", "has 'rest' but lacks 'stiffness'"),
        (JOINT % "stiffness: -0.1", "out-of-range", "at least 0, not -0.1"),
        (JOINT % "stiffness: stiff", "wrong-type", "must be a number or a list of numbers"),
        (JOINT % "mimic: true", "wrong-value", "must be false, not true"),
        (JOINT % "mimic: 0", "wrong-type", "must be false, not 0"),
        (JOINT % "mimic: no", "wrong-type", "must be false, not 'no'"),
        (JOINT % "stifness: 3", "unknown-key", "'stifness'"),
        (CLOSURE % "compliance: {}", "missing-key", "at least one of 'linear', 'angular'"),
        (CLOSURE % "compliance: {linear: -1}", "out-of-range", "at least 0, not -1"),
        (CLOSURE % "compliance: 1", "wrong-type", "must be a mapping"),
        (CLOSURE % "compliance: {lineal: 1}", "unknown-key", "'lineal'"),
        (ACTUATOR % "control: [1]", "wrong-length", "must have 2 items"),
        (ACTUATOR % "control: 5", "wrong-type", "must be a list"),
        (ACTUATOR % "name: ''", "wrong-value", "is empty"),
    ],
)
def test_error_of_an_added_key_is_reported_once(text: str, code: str, said: str) -> None:
    extension, diagnostics = read(text)
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == (code, 3)
    assert said in found.message


def test_hints_in_version_2_0_list_its_own_keys() -> None:
    _, (found,) = read(JOINT.replace("2.1", "2.0") % "colour: 3")
    assert found.hint is not None
    assert "'armature'" in found.hint
    assert "'stiffness'" not in found.hint


@pytest.mark.parametrize(
    ("text", "code", "line", "said"),
    [
        (HINGE + "    axis: [0, 0, 1]\n    axes: [[0, 0, 1], [0, 0, 1]]\n", "conflicting-keys", 6, "exclude"),
        (HINGE.replace("hinge", "3d") + "    axes: [[0, 0, 1], [0, 0, 1]]\n", "conflicting-keys", 6, "type 'hinge'"),
        (
            HINGE.replace("hinge", "hing") + "    axis: [0, 0, 1]\n",
            "wrong-value",
            4,
            "'3d', '6d', 'hinge' or 'distance'",
        ),
        (HINGE.replace("    type: hinge\n", "    axis: [0, 0, 1]\n"), "missing-key", 3, "lacks 'type'"),
        (HINGE + "    axis: z\n", "wrong-type", 6, "must be a list"),
        (HINGE + "    axis: [0, 1]\n", "wrong-length", 6, "must have 3 items"),
        (HINGE + "    axes: [[0, 0, 1]]\n", "wrong-length", 6, "must have 2 items"),
        (HINGE + "    length: 0.1\n", "conflicting-keys", 6, "'length' goes with type 'distance'"),
        (HINGE + "    radius: 0.1\n", "unknown-key", 6, "'radius'"),
        (DISTANCE.replace("0.155", "0.00009"), "out-of-range", 6, "'length' must be at least 0.0001, not 9e-05"),
        (DISTANCE.replace("0.155", "[0.155]"), "wrong-type", 6, "'length' must be a number"),
        (DISTANCE.replace("length: 0.155", "lenght: 0.155"), "unknown-key", 6, "'lenght'"),
        (DISTANCE.replace("    length: 0.155\n", ""), "missing-key", 3, "lacks 'length'"),
        (DISTANCE.replace("    type: distance\n", ""), "missing-key", 3, "lacks 'type'"),
        (DISTANCE.replace("distance", "3d"), "conflicting-keys", 6, "'length' goes with type 'distance'"),
        (DISTANCE + "    axis: [0, 0, 1]\n", "conflicting-keys", 7, "'axis' goes with type 'hinge'"),
    ],
)
def test_error_of_a_closure_is_reported_once(text: str, code: str, line: int, said: str) -> None:
    extension, diagnostics = read(text)
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == (code, line)
    assert said in found.message


@pytest.mark.parametrize(("more", "offset"), [("", 0.0), ("    offset: -0.2\n", -0.2)])
def test_coupling_has_its_coefficients_and_offset(more: str, offset: float) -> None:
    extension, diagnostics = read(COUPLING + more)
    assert extension is not None
    assert not diagnostics
    (coupling,) = extension.couplings
    assert (coupling.name, coupling.joints, coupling.offset) == ("gear", {"a": 2.0, "b": -1.5}, offset)


def test_user_data_of_a_coupling_are_not_joints() -> None:
    extension, _ = read(COUPLING.replace("b: -1.5", "b: -1.5, x-teeth: 12"))
    assert extension is not None
    assert extension.couplings[0].joints.keys() == {"a", "b"}
    assert extension.own_data == {("couplings", 0, "joints", "x-teeth"): 12}


@pytest.mark.parametrize(
    ("text", "code", "line", "said"),
    [
        (COUPLING.replace(", b: -1.5", ""), "wrong-length", 4, "'joints' must have at least 2 items, not 1"),
        (COUPLING.replace("b: -1.5", "x-b: -1.5"), "wrong-length", 4, "'joints' must have at least 2 items, not 1"),
        (COUPLING.replace("-1.5", "0.0"), "out-of-range", 4, "'b' must not be 0"),
        (COUPLING.replace("-1.5", "half"), "wrong-type", 4, "'b' must be a number"),
        (COUPLING.replace("{a: 2, b: -1.5}", "[a, b]"), "wrong-type", 4, "'joints' must be a mapping"),
        (COUPLING + "    offset: none\n", "wrong-type", 5, "'offset' must be a number"),
        (COUPLING + "    ratio: 2\n", "unknown-key", 5, "'ratio'"),
        (COUPLING.replace("couplings", "couplngs"), "unknown-key", 2, "'couplngs'"),
        (COUPLING.replace("    joints: {a: 2, b: -1.5}\n", ""), "missing-key", 3, "lacks 'joints'"),
        (COUPLING.replace('extended_urdf: "2.1"\n', ""), "missing-key", 1, "a key of version 2.1"),
    ],
)
def test_error_of_a_coupling_is_reported_once(text: str, code: str, line: int, said: str) -> None:
    extension, diagnostics = read(text)
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == (code, line)
    assert said in found.message
    assert "do not indent" not in (found.hint or "")


def test_couplings_in_version_2_0_name_the_line_to_change() -> None:
    extension, diagnostics = read(COUPLING.replace("2.1", "2.0"))
    assert extension is None
    (found,) = diagnostics
    assert (found.code, found.line) == ("unknown-key", 2)
    assert 'write extended_urdf: "2.1" on line 1' in (found.hint or "")


def test_keys_listed_for_version_2_0_are_its_own() -> None:
    _, (found,) = read(COUPLING.replace("2.1", "2.0").replace("couplings", "gearbox"))
    assert found.hint is not None
    assert "'closures'" in found.hint
    assert "'couplings'" not in found.hint


@pytest.mark.parametrize(
    "text", [HINGE + "    limits: {upper: 1}\n", DISTANCE + "    damping: 1\n", HINGE + "    motor: 1\n"]
)
def test_joint_with_limit_or_motor_belongs_in_the_tree(text: str) -> None:
    _, (found,) = read(text)
    assert found.code == "unknown-key"
    assert "put this joint into the tree" in (found.hint or "")


def test_coupling_has_no_motor() -> None:
    _, (found,) = read(COUPLING + "    gear_ratio: 3\n")
    assert found.code == "unknown-key"
    assert "the joints that it relates have them" in (found.hint or "")
