"""The words of errors in a description alone. The cases of the suite state their codes and places."""

from __future__ import annotations

import subprocess
import sys

import pytest

from eurdf.diagnostics import Diagnostic, Diagnostics
from eurdf.format.model import Description
from eurdf.format.read import read_description
from eurdf.reading.source import Source
from eurdf.reading.yaml_reader import read_yaml

ROOT = 'extended_urdf: "2.0"\n'
LATER = 'extended_urdf: "2.1"\n'


def read(text: str) -> tuple[Description | None, list[Diagnostic]]:
    diagnostics = Diagnostics()
    document = read_yaml(Source("robot.yaml", text, text.encode()))
    return read_description(document, diagnostics), list(diagnostics)


def said(text: str) -> str:
    """The message and hint of the one error of a text."""
    description, (found,) = read(text)
    assert description is None
    assert not found.message.endswith(".")
    return f"{found.code}: {found.message} ({found.hint})"


# fmt: off
VERSION_1 = [
    ("closed_loop: {a: b}", "must be a list, not a mapping"),
    ("closed_loop: [a, b]", "[[A, B], …]"),
    ("closed_loop: [[a, b], c]", "item 2 of 'closed_loop' must be a list"),
    ("closed_loop: [[a, b, c]]", "must have 2 items, not 3"),
    ('closed_loop: [[a, ""]]', "is empty"),
    ("closed_loop: [[a, b]]\ntype: 3d", "write it as a list: [3d]"),
    ("closed_loop: [[a, b]]\ntype: [4d]", "'3d', '3D', '6d' or '6D', not '4d'"),
    ("closed_loop: [[a, b]]\ntype: []", "not 1 and 0"),
    ("closed_loop: [[a, b]]\ntype: [3d, 6d]", "same number of items"),
    ("name_mot: [1]", "must be text, not 1"),
    ("joint_name: [hip]", "lacks 'joint_type'"),
    ("joint_name: [a]\njoint_type: [spherical]", "did you mean 'SPHERICAL'?"),
    ("joint_name: [a]\njoint_type: [UJOINT_XX]", "not 'UJOINT_XX'"),
]
VERSION_2 = [
    ("closuers: []", "did you mean 'closures'?"),
    ("mass: 3", "begin with 'x-'"),
    ("closed_loop: [[a, b]]", "use 'closures'"),
    ("name_mot: [a]", "use 'actuators'"),
    ("joint_type: [FIXED]", "use 'joints'"),
    ("closures: [{name: rod, type: 3d, frames: [a, b], ratio: 1}]", "'closures'"),
    ("closures: [{type: 3d, frames: [a, b]}]", "item 1 of 'closures' lacks 'name'"),
    ("closures: [{name: rod, type: 3d, frames: [a, {xyz: [0, 0, 1]}]}]", "'link' or 'joint'"),
    ("closures: [{name: rod, type: 3d, frames: [a, {lnik: c}]}]", "did you mean 'link'?"),
    ("closures: [{name: rod, type: 3d, frames: [a, {link: c, joint: d}]}]", "not both"),
    ("closures: [{}]", "lacks 'name', 'type' and 'frames'"),
    ("closures: [{name: rod, type: 3D, frames: [a, b]}]", "did you mean '3d'?"),
    ("closures: [{name: rod, type: 3, frames: [a, b]}]", "must be '3d' or '6d'"),
    ("closures: [{name: '', type: 3d, frames: [a, b]}]", "'name' is empty"),
    ("closures: [rod]", "must be a mapping, not 'rod'"),
    ("closures:", "is its value missing"),
    ("frames: [{}]", "lacks 'name' and 'link' or 'joint'"),
    ("frames: [tip]", "{name: …, link: …"),
    ("frames: [{name: tip, link: rod, xyz: 0 0 1}]", "write three numbers"),
    ("joints: {k: {x-a: 1}}", "at least one of 'limits'"),
    ("joints: {k: {limits: {}}}", "at least one of 'lower'"),
    ("joints: {k: {type: universal}}", "joint 'k' lacks 'axes'"),
    ("joints: {k: {tpye: helical, pitch: 1}}", "did you mean 'type'?"),
    ("joints: {k: {type: fixed, axes: xy}}", "belongs to type 'universal'"),
    ("joints: {k: SPHERICAL}", "did you mean 'spherical'?"),
    ("joints: {k: universal}", "{type: universal, axes: xy}"),
    ("joints: {k: helical}", "{type: helical, pitch: 0.005}"),
    ("joints: {k: revolute}", "keeps its URDF type"),
    ("joints: {k: {type: sferical, axes: xy}}", "did you mean 'spherical'?"),
    ("joints: {k: {type: }}", "not null"),
    ("joints: {k: 3}", "must be a joint type, or a mapping"),
    ('joints: {"": fixed}', "a name in 'joints' is empty"),
    ("joints: {universal: {type: universal, axes: XY}}", "mean 'xy'?"),
    ("joints: {k: {type: universal, axes: xx}}", "not 'xx'"),
    ("joints: {k: {type: universal, axes: 3}}", "two letters such as xy"),
    ("joints: {k: {type: helical, pitch: 1_000}}", "write the number as 1000"),
    ("joints: {k: {type: helical, pitch: '0,5'}}", "write the number as 0.5"),
    ("joints: {k: {type: helical, pitch: true}}", "must be a number, not true"),
    ("joints: {k: {damping: [0, -0.5]}}", "item 2 of 'damping' must be at least 0, not -0.5"),
    ("joints: {k: {damping: [1, 1, 1, 1, 1, 1, 1]}}", "at most 6 items, not 7"),
    ("actuators: motor", "write it as a list: [motor]"),
    ("actuators: [3]", "quote a name"),
    ("actuators: [{joint: a, ratio: 2}]", "did you mean 'gear_ratio'?"),
    ("actuators: [{joint: a, gear_ratio: -0.0}]", "must not be 0"),
    ("configurations: {c: {k: yes}}", "a number or a list of numbers"),
    ("configurations: {c: 1}", "configuration 'c' must be a mapping"),
    ("root: true", "is the root fixed to the world, or does it float?"),
    ("closed_loop: [[a, b]]\nname_mot: [a]", "the keys of version 1: 'closed_loop', 'name_mot'"),
    ("closures: [{name: p, type: pin, frames: [a, b]}]", "'pin' is called 'hinge' here; that is of version 2.1"),
    ("joints: {k: {stiffness: 1, rest: 0}}\ncouplings: []", "uses 'stiffness', 'rest', 'couplings' of version 2.1"),
    ("joints: {k: Hooke's joint}", "{type: universal, axes: xy}"),
    ("joints: {k: hinge}", "keeps its URDF type"),
]
VERSION_2_1 = [
    ("joints: {k: {rest: 0.1}}", "has 'rest' but lacks 'stiffness'"),
    ("joints: {k: {stiffness: stiff}}", "must be a number or a list of numbers"),
    ("joints: {k: {mimic: no}}", "must be false, not 'no'"),
    ("closures: [{name: p, type: 6d, frames: [a, b], compliance: {}}]", "at least one of 'linear', 'angular'"),
    ("closures: [{name: p, type: 6d, frames: [a, b], axis: [0, 0, 1]}]", "'axis' goes with type 'hinge'"),
    ("closures: [{name: p, type: 6d, frames: [a, b], length: 1}]", "'length' goes with type 'distance'"),
    ("closures: [{name: p, type: hing, frames: [a, b], axis: [0, 0, 1]}]", "'3d', '6d', 'hinge' or 'distance'"),
    ("closures: [{name: p, type: hinge, frames: [a, b], axis: [0, 0, 1], axes: [[0, 0, 1], [0, 0, 1]]}]", "exclude"),
    ("closures: [{name: p, type: hinge, frames: [a, b], limits: {upper: 1}}]", "put this joint into the tree"),
    ("closures: [{name: p, type: distance, frames: [a, b], length: 0.00009}]", "at least 0.0001, not 9e-05"),
    ("closures: [{name: p, type: distance, frames: [a, b], length: 1, damping: 1}]", "put this joint into the tree"),
    ("couplings: [{name: g, joints: {a: 2, x-b: 1}}]", "'joints' must have at least 2 items, not 1"),
    ("couplings: [{name: g, joints: {a: 2, b: 0.0}}]", "'b' must not be 0"),
    ("couplings: [{name: g, joints: {a: 2, b: 1}, gear_ratio: 3}]", "the joints that it relates have them"),
    ("closures: [{name: p, type: distance, frames: [a, b]}]", "between the origins of A and B, m"),
    ("joints: {k: {mimic: true}}", "follows the <mimic>"),
    ("actuators: [{name: a, gear_ratio: 8}]", "did you mean 'joint'?"),
    ("joints: {k: {spring: 1500}}", "did you mean 'stiffness'?"),
]
OTHER_VERSIONS = [
    ("[2.0]", "wrong-type", "in quotes"),
    ("2.1", "wrong-type", 'write extended_urdf: "2.1", in quotes'),
    ('"2.2"', "unsupported-version", "2.0 and 2.1"),
    ('""', "unsupported-version", 'extended_urdf: "2.0"'),
    ('"1"', "unsupported-version", "leave 'extended_urdf' out"),
    ("1.0", "wrong-type", "leave 'extended_urdf' out"),
]
# fmt: on


@pytest.mark.parametrize(
    ("text", "words"),
    VERSION_1
    + [(ROOT + text, words) for text, words in VERSION_2]
    + [(LATER + text, words) for text, words in VERSION_2_1],
)
def test_error_is_reported_once_in_these_words(text: str, words: str) -> None:
    assert words in said(f"{text}\n")


# fmt: off
FIXES = [
    ("closures: [{name: p, type: ball, frames: [a, b]}]", "closures: [{name: p, type: 3d, frames: [a, b]}]"),
    ("joints: {k: ball joint}", "joints: {k: spherical}"),
    ("joints: {k: {type: screw, pitch: 1}}", "joints: {k: {type: helical, pitch: 1}}"),
    ("joints: {k: {type: universal, axes: [X, y]}}", "joints: {k: {type: universal, axes: xy}}"),
    ("closures:\n- name: p\n  type: 3d\n  frames: a, b", "closures:\n- name: p\n  type: 3d\n  frames: [a, b]"),
    ("closures: [{name: p, type: 3d, site1: a, site2: b}]", "closures: [{name: p, type: 3d, frames: [a, b]}]"),
    ("closures:\n- name: p\n  type: 3d\n  p1: a\n  p2: b", "closures:\n- name: p\n  type: 3d\n  frames: [a, b]"),
    ("closures:\n  p:\n    type: 3d\n    frames: [a, b]", "closures:\n  - name: p\n    type: 3d\n    frames: [a, b]"),
    ("closures:\n  name: p\n  type: 3d\n  frames: [a, b]", "closures:\n  - name: p\n    type: 3d\n    frames: [a, b]"),
    ("actuators: {joint: a, gear_ratio: 3}", "actuators: [{joint: a, gear_ratio: 3}]"),
    ("actuators: {a: {gear_ratio: 3}, b: {}}", "actuators: [{joint: a, gear_ratio: 3}, {joint: b, }]"),
    ("actuators:\n  a: {gear_ratio: 3}", "actuators:\n  - {joint: a, gear_ratio: 3}"),
    ("joints:\n a: &a {damping: 1}\n b:\n  <<: *a", "joints:\n a: &a {damping: 1}\n b:\n  damping: 1"),
    ("joints: {a: &a {damping: 1}, b: {<<: *a}}", "joints: {a: &a {damping: 1}, b: {damping: 1}}"),
    ("configurations: {c: {k: -90°}}", "configurations: {c: {k: -1.57079632679}}"),
    ("configurations: {c: {k: 2*pi/3}}", "configurations: {c: {k: 2.09439510239}}"),
    ("frames: [{name: p, link: a, xyz: 0.5 0 -2}]", "frames: [{name: p, link: a, xyz: [0.5, 0.0, -2.0]}]"),
    ("actuators: [{joint: a, gear_ratio: 1/8}]", "actuators: [{joint: a, gear_ratio: 0.125}]"),
    ("actuators: [{name: a, gear_ratio: 8}]", "actuators: [{joint: a, gear_ratio: 8}]"),
    ("frames: [{name: p, link: a, pos: [0, 0, 1]}]", "frames: [{name: p, link: a, xyz: [0, 0, 1]}]"),
    ("root: world", "root: fixed"),
    ("configurations: {c: {k: 30 mm}}", "configurations: {c: {k: 0.03}}"),
]
# fmt: on


@pytest.mark.parametrize(("wrong", "right"), FIXES)
def test_words_of_other_formats_have_a_fix(wrong: str, right: str) -> None:
    _, (found,) = read(f"{ROOT}{wrong}\n")
    assert found.proposals[0].texts() == {"robot.yaml": f"{ROOT}{right}\n"}
    assert read(f"{ROOT}{right}\n")[0] is not None


@pytest.mark.parametrize("version", ["closed_loop: [[a, b]]\n", LATER])
def test_fix_of_the_version_leaves_the_rest(version: str) -> None:
    rest = version.replace(LATER, "joints: {k: {stiffness: 1, rest: 0}}\n") + "name_mot: [a]\n" * (version != LATER)
    _, (found,) = read(ROOT + rest)
    (fix,) = found.proposals
    assert fix.texts() == {"robot.yaml": (LATER if version == LATER else "\n") + rest}


def test_key_that_is_legal_where_it_is_is_not_moved() -> None:
    assert "do not indent" not in said(f"{ROOT}closures: [{{name: p, type: 3d, frames: {{a: b}}}}]\n")
    assert "do not indent" in said(f"{ROOT}joints:\n  k: fixed\n  actuators: [k]\n")


@pytest.mark.parametrize(("value", "code", "hint"), OTHER_VERSIONS)
def test_other_version_is_refused_with_hint(value: str, code: str, hint: str) -> None:
    found = said(f"extended_urdf: {value}\nclosures: []\n")
    assert found.startswith(code)
    assert hint in found


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("notes: 1\nactuators: [motor]\n", "actuators"),
        ('Extended_URDF: "2.0"\n', "Extended_URDF"),
        ("couplings: [{name: g, joints: {a: 2, b: 1}}]\n", "couplings"),
    ],
)
def test_version_2_without_version_is_not_version_1(text: str, key: str) -> None:
    found = said(text)
    assert found.startswith("missing-key")
    assert f"'{key}'" in found
    assert "'extended_urdf'" in found


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("closed-loop", "'closed_loop'"),
        ("Type", "'type'"),
        ("joint_tpye", "'joint_type'"),
        ("actuators", "version 2.0"),
    ],
)
def test_near_miss_key_of_version_1_is_warned_and_kept(key: str, words: str) -> None:
    description, (warning,) = read(f"closed_loop: [[a, b]]\n{key}: [1]\n")
    assert description is not None
    assert description.own_data == {(key,): [1]}
    assert words in f"{warning.message} {warning.hint}"


@pytest.mark.parametrize(
    "text",
    [
        "closures: [{name: p, type: hinge, frames: [a, b], axis: [0, 0, 1]}]",
        "closures: [{name: p, type: 3d, frames: [a, b], axis: [0, 0, 1]}]",
        "closures: [{name: p, type: distance, frames: [a, b], length: 1}]",
        "closures: [{name: p, type: 6d, frames: [a, b], compliance: {linear: 1}}]",
        "joints: {heel: {stiffness: 3}}",
        "joints: {heel: {type: fixed, mimic: false}}",
        "actuators: [{joint: heel, control: [-1, 1]}]",
        "couplings: [{name: g, joints: {a: 2, b: 1}}]",
    ],
)
def test_what_version_2_1_adds_names_the_line_to_change(text: str) -> None:
    assert 'write extended_urdf: "2.1" on line 2' in said(f"# a robot\n{ROOT}{text}\n")


@pytest.mark.parametrize("text", ["joints: {heel: {colour: 3}}", "gearbox: 3"])
def test_hints_in_version_2_0_list_its_own_keys(text: str) -> None:
    earlier, later = said(f"{ROOT}{text}\n"), said(f"{LATER}{text}\n")
    for key in ("'stiffness'", "'couplings'"):
        assert key not in earlier
    assert "'stiffness'" in later or "'couplings'" in later


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("name_mot: 1\nclosed_loop: [[a]]\ntype: [x]\n", ["wrong-type", "wrong-length", "wrong-value"]),
        ("extended_urdf: 2.0\nroot: loose\n", ["wrong-type", "wrong-value"]),
        ('extended_urdf: "3.0"\nroot: loose\nnew: 1\n', ["unsupported-version"]),
        (f"{ROOT}closures: [{{names: rod, type: 3d}}]\n", ["missing-key", "unknown-key"]),
    ],
)
def test_several_errors_are_reported_in_order(text: str, codes: list[str]) -> None:
    assert [found.code for found in read(text)[1]] == codes


def test_number_of_reported_errors_is_bounded() -> None:
    _, found = read("name_mot: [" + "1, " * 20_000 + "]\n")
    assert len(found) == 100
    assert "19,900 more errors" in (found[-1].hint or "")


def test_joint_named_like_a_keyword_has_right_place() -> None:
    _, found = read(f'{ROOT}joints: {{"fixed joint": {{type: fixed, "one number": 1, armature: x}}}}\n')
    assert [each.pointer for each in found] == ["/joints/fixed joint/one number", "/joints/fixed joint/armature"]


def test_long_or_unprintable_name_is_escaped() -> None:
    _, found = read(f'{ROOT}? "' + "a" * 5000 + '"\n: 1\n"tab\\there": 1\n')
    long, tab = (each.message for each in found)
    assert len(long) < 120
    assert "'tab\\there'" in tab


SOUND = f"{ROOT}joints: {{knee: {{damping: 2}}}}\n"


def test_reading_without_closures_loads_neither_numpy_nor_pydantic() -> None:
    code = (
        "import sys; from eurdf.format.read import *; from eurdf.reading.yaml_reader import read_yaml;"
        "from eurdf.reading.source import Source; from eurdf.diagnostics import Diagnostics;"
        "text = open(0).read(); source = Source('robot.yaml', text, text.encode());"
        "assert read_description(read_yaml(source), Diagnostics());"
        "sys.exit(not sys.modules.keys().isdisjoint({'pinocchio', 'numpy', 'pydantic', 'rich'}))"
    )
    for text in (SOUND, "name_mot: [knee]\n"):
        assert subprocess.run([sys.executable, "-c", code], input=text.encode(), check=False).returncode == 0
