"""A description from the names in a URDF, the YAML text that it is written as, and its file."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, Literal

import pytest
import yaml
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from lxml import etree

import eurdf
from eurdf.commands.main import main
from eurdf.diagnostics import Diagnostics
from eurdf.format.urdf.data import Urdf
from eurdf.format.urdf.read import read_urdf
from eurdf.format.yaml_text import lines_of, scalar
from eurdf.kinematics.analysis import analyze
from eurdf.linking.robot_files import read_robot
from eurdf.mechanism.same_model import with_universal_joints
from eurdf.pinocchio.robot import build_robot
from eurdf.reading.source import Source, read_source
from eurdf.reading.xml_reader import read_xml
from eurdf.reading.yaml_reader import read_yaml
from eurdf.writing.generation import Generation, generate
from eurdf.writing.naming_conventions import PUBLISHED_CLOSURE, BadPattern, conventions, find, hints
from support.places import ROOT, WILD
from support.wild import FACTS, needs_wild

#: Pairs that are named in the URDF, but that the published file leaves out.
LEFT_OUT = {"kangaroo_like": {frozenset({"closedloop1_A", "closedloop1_B"})}}


def urdf_text(*joints: str) -> str:
    """A URDF from lines ``name type parent child axis``; a link is one of a rod, but where its name ends in 0."""
    robot = etree.Element("robot", name="bench")
    rows = [line.split() for line in joints]
    links = dict.fromkeys(name for _, _, parent, child, *_ in rows for name in (parent, child))
    return _written(
        robot, list(links), [(name, kind, parent, child, rest) for name, kind, parent, child, *rest in rows]
    )


def _written(robot: Any, links: list[str], joints: list[tuple[str, str, str, str, list[str]]]) -> str:
    for name in links:
        link = etree.SubElement(robot, "link", name=name)
        if not name.endswith("0"):
            inertial = etree.SubElement(link, "inertial")
            etree.SubElement(inertial, "mass", value="1")
            etree.SubElement(inertial, "inertia", ixx="1", ixy="0", ixz="0", iyy="1", iyz="0", izz="1")
    for name, kind, parent, child, rest in joints:
        joint = etree.SubElement(robot, "joint", name=name, type=kind)
        etree.SubElement(joint, "parent", link=parent)
        etree.SubElement(joint, "child", link=child)
        if kind != "fixed":
            etree.SubElement(joint, "axis", xyz={"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}[rest[0] if rest else "z"])
            etree.SubElement(joint, "limit", lower="-1", upper="1", effort="1", velocity="1")
        if len(rest) > 1:
            etree.SubElement(joint, "mimic", joint=rest[1])
    return etree.tostring(robot, encoding="unicode")


def read(text: str) -> Urdf:
    diagnostics = Diagnostics()
    urdf = read_urdf(read_xml(Source("robot.urdf", text, text.encode())), diagnostics)
    assert urdf is not None, list(diagnostics)
    return urdf


def generated(*joints: str, **patterns: list[str]) -> Generation:
    return generate(read(urdf_text(*joints)), conventions(**patterns))


LEG = (
    "motor_hip revolute base thigh x",
    "free_knee revolute thigh shin y",
    "free_rod revolute base rod y",
    "closedloop1_A_frame fixed shin closedloop1_A",
    "closedloop1_B_frame fixed rod closedloop1_B",
)
BALL = ("rev0 revolute base int10 x", "rev1 revolute int10 int20 y", "rev2 revolute int20 tip z")


# -- published robots ---------------------------------------------------------------------------------------------


@pytest.mark.slow
@needs_wild
@pytest.mark.parametrize("name", FACTS)
def test_names_of_published_robot_match_its_file(name: str) -> None:
    urdf = read_urdf(read_xml(read_source(WILD / name / "robot.urdf")), Diagnostics())
    assert urdf is not None
    found = generate(urdf, conventions()).found
    published = yaml.safe_load((WILD / name / "robot.yaml").read_text(encoding="utf-8"))
    said = {frozenset(pair): kind for pair, kind in zip(published["closed_loop"], published["type"], strict=True)}
    closures = {frozenset(closure.frames): closure.type for closure in found.closures}
    left_out = LEFT_OUT.get(name, set())
    assert closures.keys() - said.keys() == left_out
    if FACTS[name]["closes"]:  # else the types that the published file has cannot be right
        assert {pair: kind for pair, kind in closures.items() if pair not in left_out} == said
    assert set(found.motors) == set(published["name_mot"])
    # Some joints that are named spherical are universal in the published file: a name does not show it.
    assert set(found.sphericals) == set(published.get("joint_name", ()))
    assert found.warnings == ()


# -- closures -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("a", "b", "closure"),
    [
        ("closedloop1_A", "closedloop1_B", ("closedloop1", None)),
        ("closedloop3D_1A", "closedloop3D_1B", ("closedloop3D_1", "3d")),
        ("closedloop0_A_3D", "closedloop0_B_3D", ("closedloop0", "3d")),
        ("closedloop12_A_6D", "closedloop12_B_6D", ("closedloop12", "6d")),
        ("knee_closedloop_a_3d", "knee_closedloop_b", ("knee_closedloop", "3d")),
        ("closed_loop_6d_knee.a", "closed_loop_6d_knee.b", ("closed_loop_6d_knee", "6d")),
        ("left/closed_loop-A", "left/closed_loop-B", ("left/closed_loop", None)),
        ("fermeture2_A", "fermeture2_B", ("fermeture2", None)),
        ("closing_knee_1", "closing_knee_2", ("closing_knee", None)),
    ],
)
def test_two_similar_link_names_are_a_closure(a: str, b: str, closure: tuple[str, str | None]) -> None:
    urdf = read(urdf_text("hip revolute base thigh", f"j1 fixed thigh {a}", f"j2 fixed base {b}"))
    found = find(urdf, conventions())
    assert [(one.name, one.type) for one in found.closures] == [closure]
    assert found.closures[0].frames == (a, b)
    assert found.warnings == ()


def test_contradicting_type_names_decide_nothing() -> None:
    found = find(
        read(urdf_text("hip revolute base a0", "j1 fixed a0 closedloop1_A_3D", "j2 fixed base closedloop1_B_6D")),
        conventions(),
    )
    assert [closure.type for closure in found.closures] == [None]
    assert found.warnings == ("the names of loop 'closedloop1' state both 3d and 6d, so neither is used",)


#: As onshape-to-robot names the frames of a revolute mate, with the joints that fix them.
HINGE = tuple(
    f"closing_pin_{name}_frame fixed {link} closing_pin_{name}"
    for link, names in (("shin", ("1", "1_z")), ("rod", ("2", "2_z")))
    for name in names
)


def mate(*origins: str) -> Urdf:
    """A leg with a revolute mate; the origins are those of the frames on its axis, in the order of their sides."""
    robot = etree.fromstring(urdf_text(*LEG[:3], *HINGE))
    for side, origin in enumerate(origins, 1):
        (joint,) = robot.xpath(f"joint[@name='closing_pin_{side}_z_frame']")
        etree.SubElement(joint, "origin", xyz=origin, rpy="0.3 0.2 0.1")
    return read(etree.tostring(robot, encoding="unicode"))


def test_onshape_revolute_mate_is_a_hinge() -> None:
    generation = generate(mate("0 0 0.1", "0 0 0.1"), conventions())
    assert generation.text.startswith('extended_urdf: "2.1"\n')
    (closure,) = read_back(generation.text)["closures"]
    frames = ["closing_pin_1", "closing_pin_2"]
    assert closure == {"name": "closing_pin", "type": "hinge", "frames": frames, "axis": [0, 0, 1]}
    (note,) = generation.notes
    assert note.startswith("'closing_pin' and 'closing_pin_z' are one hinge, which needs version 2.1")
    assert generation.mechanism is not None
    assert [closure.type for closure in generation.mechanism.closures] == ["hinge"]
    askew = read_back(generate(mate("0 0.1 0", "0.06 0 0.08"), conventions()).text)["closures"][0]
    assert askew["axes"] == [[0, 1, 0], pytest.approx([0.6, 0, 0.8])]


@pytest.mark.parametrize("name", ["closing_{}_{}", "closedloop3D_{}_{}"])
def test_two_points_are_a_hinge_by_their_distance(name: str) -> None:
    # Their names say nothing of each other; the type of the closures is chosen, or stated.
    text = (ROOT / "spec" / "examples" / "onshape" / "robot.urdf").read_text(encoding="utf-8")
    for side, letter in (("1", "A"), ("2", "B")):
        said = letter if "3D" in name else side
        text = text.replace(f"closing_pin_{side}_z", name.format("end", said))
        text = text.replace(f"closing_pin_{side}", name.format("pin", said))
    hinge, points = (generate(read(text), conventions(), version) for version in (None, "2"))
    assert (hinge.version, [closure.type for closure in hinge.found.closures]) == ("2.1", ["hinge"])
    assert (points.version, [closure.type for closure in points.found.closures]) == ("2", ["3d", "3d"])
    found = [analyze(build_robot(each.mechanism, geometry=False)) for each in (hinge, points) if each.mechanism]
    assert [(each.mobility, each.nc) for each in found] == [(1, 5), (1, 6)]


def test_points_of_unequal_distance_are_reported() -> None:
    generation = generate(mate("0 0 0.1", "0 0 0.2"), conventions())
    assert [closure.type for closure in generation.found.closures] == ["3d", "3d"]
    (note,) = generation.notes
    assert "are 0.1 m apart in one and 0.2 m in the other" in note


@pytest.mark.parametrize("version", ["1", "2", None])
def test_revolute_mate_is_two_3d_closures_where_no_hinge_can_be(version: Literal["1", "2"] | None) -> None:
    # By default only if the second point is at the first one, where it states no axis.
    urdf = mate() if version is None else mate("0 0 0.1", "0 0 0.1")
    generation = generate(urdf, conventions(), version)
    assert [(closure.name, closure.type, closure.frames) for closure in generation.found.closures] == [
        ("closing_pin", "3d", ("closing_pin_1", "closing_pin_2")),
        ("closing_pin_z", "3d", ("closing_pin_1_z", "closing_pin_2_z")),
    ]
    assert generation.found.warnings == ()
    assert 'extended_urdf: "2.1"' not in generation.text
    (note,) = generation.notes
    assert note.startswith("'closing_pin' and 'closing_pin_z' ")


@pytest.mark.parametrize(("given_", "count"), [("3d", 2), ("6d", 1)])
def test_user_can_set_all_closure_types(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], given_: str, count: int
) -> None:
    file = tmp_path / "leg.urdf"
    file.write_text(urdf_text(*LEG[:3], *HINGE), encoding="utf-8")
    assert main(["generate", str(file), "--type", given_]) == 0
    out, err = capsys.readouterr()
    assert [closure["type"] for closure in yaml.safe_load(out)["closures"]] == [given_] * count
    assert "note:" not in err
    file.write_text(urdf_text(*LEG).replace("closedloop1_", "closedloop6D_1_"), encoding="utf-8")
    assert main(["generate", str(file), "--type", given_]) == 0
    assert yaml.safe_load(capsys.readouterr().out)["closures"][0]["type"] == given_


def test_link_is_preferred_to_its_fixed_joint() -> None:
    assert generated(*LEG).found.closures[0].frames == ("closedloop1_A", "closedloop1_B")


def test_loops_are_sorted_by_number() -> None:
    rows = [f"j{n}{s} revolute base closedloop{n}_{s}" for n in (10, 2, 1) for s in "AB"]
    assert [closure.name for closure in generated(*rows).found.closures] == [
        "closedloop1",
        "closedloop2",
        "closedloop10",
    ]


@pytest.mark.parametrize(
    ("rows", "closures", "frames", "said"),
    [
        (
            ("j1 fixed base closedloop1_A",),
            [],
            [],
            r"'closedloop1_A' has no other side: a closure has two frames; left out",
        ),
        (
            HINGE[:3],
            [],
            [("closing_pin_1", "closing_pin_2")],
            "'closing_pin_1_z' has no other side: a closure has two frames; left out",
        ),
        (
            ("j1 fixed base loop_A", "j2 fixed base closedloop1_A", "j3 fixed loop_A closedloop1_B"),
            [],
            [],
            "'closedloop1_A' and 'closedloop1_B' are fixed to each other",
        ),
        ([f"j{side} revolute base loop1_{side}" for side in "ABC"], ["(?P<loop>loop.)_(?P<side>.)"], [], "3 sides"),
        (
            LEG[3:],
            [PUBLISHED_CLOSURE, r"(?P<loop>closed)loop1_(?P<side>.)_frame"],
            [("closedloop1_A_frame", "closedloop1_B_frame")],
            "already",
        ),
        (
            ("j1 fixed shin closedloop1_A", "closedloop1_A_frame revolute base other", "j2 fixed base closedloop1_B"),
            [],
            [("closedloop1_A", "closedloop1_B")],
            "side A of loop 'closedloop1' is taken to be 'closedloop1_A'; it might be 'closedloop1_A_frame'",
        ),
    ],
    ids=["half a pair", "half an axis", "one body", "three sides", "duplicate", "two frames of a side"],
)
def test_what_makes_no_closure_is_reported(
    rows: list[str], closures: list[str], frames: list[tuple[str, str]], said: str
) -> None:
    found = generated(*LEG[:3], *rows, closures=closures).found
    assert [closure.frames for closure in found.closures] == frames
    (warning,) = found.warnings
    assert said in warning


def test_user_pattern_gives_sides_loops_and_types() -> None:
    rows = ("hip revolute base thigh", "j1 fixed thigh rod7_top_3D", "j2 fixed base rod7_bottom_3D")
    found = generated(
        *rows, closures=[r"(?P<loop>rod\d+)_(?P<side>top|bottom)_(?P<type>.[dD])"], motors=["^hip$"]
    ).found
    assert [(closure.name, closure.type, closure.frames) for closure in found.closures] == [
        ("rod7", "3d", ("rod7_bottom_3D", "rod7_top_3D"))
    ]
    assert found.motors == ("hip",)


@pytest.mark.parametrize(
    "name",
    [
        "closedloop" * 20_000 + "xa",
        "closing_" * 20_000 + "1",
        "closedloop" + "9" * 100_000 + "_a",
        "closedloop" + "_a_3" * 50_000,
        "closing_" + "_1_z" * 50_000,
    ],
)
def test_names_of_any_length_are_fast(name: str) -> None:
    for pattern in conventions().closures:
        pattern.fullmatch(name)
    for joint in (name, "left_" * 50_000 + "x", "_mot" * 50_000 + "x"):
        for pattern in conventions().motors:
            pattern.search(joint)
    find(read(urdf_text(f"j1 revolute base {name}", f"j2 revolute base {name}2")), conventions())


# -- joints -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    ["mot", "motor", "mot1", "mot1_rod2", "motor_knee", "Motor-knee", "motor3", "left_motor", "left_motor_4barlink1",
     "front_left_motor_hip", "FL_motor_hip", "l_mot1", "knee_motor", "left_knee_motor_2", "ankle_motor_joint"],
)  # fmt: skip
def test_motor_name_begins_or_ends_with_word(name: str) -> None:
    assert generated(f"{name} revolute base thigh").found.motors == (name,)


@pytest.mark.parametrize(
    "name",
    ["moteur_rod", "motion", "free_motor_holder", "knee", "free_motor", "frame_motor_knee", "passive_motor", "remotor",
     "hip_part_motor_part_rev0", "holder_hip_rotation_motor_4_rev0", "spherical_transmission_motor_hip1"],
)  # fmt: skip
def test_word_inside_name_is_no_motor(name: str) -> None:
    assert generated(f"{name} revolute base thigh", "motor revolute base other").found.motors == ("motor",)


def test_revolutes_of_a_ball_mate_are_no_motors() -> None:
    # As disney_like of the published robots: the part that turns about the ball is called motor_link.
    ball = [f"motor_link_thigh_rev{joint[3:]}" for joint in BALL]
    made = generated("motor_hip revolute base hip", *ball)
    assert made.found.motors == ("motor_hip",)
    assert list(made.merges) == ["motor_link_thigh_rev2"]
    assert generated(*ball[:2]).found.motors == ("motor_link_thigh_rev0", "motor_link_thigh_rev1")
    assert len(generated(*ball, motors=["_rev"]).found.motors) == 3


@pytest.mark.parametrize("version", ["1", "2"])
def test_user_pattern_gives_universal_joints(version: Literal["1", "2"]) -> None:
    urdf = read(urdf_text("motor revolute base thigh", "spherical_knee revolute thigh shin", "heel fixed shin foot"))
    made = generate(urdf, conventions(universals=["zx=knee|heel"]), version)
    assert made.found.universals == {"spherical_knee": "zx"}
    assert made.found.sphericals == ()
    assert "'heel' is named as universal, but is fixed" in made.found.warnings[0]
    assert made.mechanism is not None
    (knee,) = [each for each in with_universal_joints(made.mechanism).joints if each.name == "spherical_knee"]
    assert knee.type == "universal"
    assert knee.axes == ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0))


def test_missing_closures_or_motors_give_hints() -> None:
    urdf = read(urdf_text("knee revolute base thigh", "the.moteur revolute thigh shin", "j1 fixed shin rod_tip0"))
    found = find(urdf, conventions())
    closure, motor = hints(urdf, found, conventions())
    assert closure.startswith("no two links or joints are named as the frames of a closure: name them closedloop1_A")
    assert "'(?P<loop>rod\\d+)_(?P<side>top|bottom)'" in closure
    assert closure.endswith("such frames perhaps: 'rod_tip0'")
    assert "--motor '^the\\.moteur$'" in motor
    assert motor.endswith("the joints that move: 'knee', 'the.moteur'")
    # The hints can be followed.
    assert find(urdf, conventions(motors=[r"^the\.moteur$"])).motors == ("the.moteur",)
    assert hints(urdf, generated(*LEG).found, conventions()) == ()


@pytest.mark.parametrize("joint", ["motor_weld fixed base thigh", None], ids=["a fixed joint", "no joint"])
def test_robot_without_moving_joint_gives_hint(joint: str | None) -> None:
    urdf = read(urdf_text(joint) if joint else '<robot name="r"><link name="base"/></robot>')
    *_, motor = hints(urdf, find(urdf, conventions()), conventions())
    assert motor == "no joint can be actuated: each is fixed or mimics another; change its type in the URDF"


def test_undrivable_motors_are_reported_and_skipped() -> None:
    found = generated("motor_a revolute base a", "motor_b revolute a b x motor_a", "motor_c fixed b c").found
    assert found.motors == ("motor_a",)
    assert found.warnings == (
        "joint 'motor_b' is named as a motor, but mimics 'motor_a': left out",
        "joint 'motor_c' is named as a motor, but is fixed: left out",
    )


def test_spherical_joints_are_recognized_by_name() -> None:
    found = generated("spherical_hip revolute base a", "ball_spherical fixed a b", "x-spherical revolute b c").found
    assert found.sphericals == ("spherical_hip",)
    assert len(found.warnings) == 2
    assert "only a revolute joint becomes spherical" in found.warnings[0]


def test_motors_are_not_merged() -> None:
    generation = generated(*BALL, motors=["rev"])
    assert generation.merges == {}
    assert generation.mechanism is not None
    assert generation.mechanism.actuators == ("rev0", "rev1", "rev2")


@pytest.mark.parametrize(
    ("patterns", "said"),
    [
        ({"closures": ["loop(1"]}, r"'loop\(1' is not a regular expression: .* at position 4"),
        ({"motors": ["*"]}, "'\\*' is not a regular expression: nothing to repeat"),
        ({"closures": ["loop_(A|B)"]}, r"'loop_\(A\|B\)' has no group 'side'"),
        ({"universals": ["knee"]}, "'knee' states no axes"),
        ({"universals": ["xx=knee"]}, "'xx=knee' states no axes"),
    ],
)
def test_bad_pattern_is_reported(patterns: dict[str, list[str]], said: str) -> None:
    with pytest.raises(BadPattern, match=said):
        conventions(**patterns)


# -- text ---------------------------------------------------------------------------------------------------------

LEG_TEXT = """\
extended_urdf: "2.0"
urdf: robot.urdf
closures:
  - name: closedloop1
    type: 3d
    frames: [closedloop1_A, closedloop1_B]
actuators: [motor_hip]
"""


def test_version_1_is_written_too() -> None:
    generation = generate(read(urdf_text(*LEG)), conventions(), "1")
    assert generation.text == ("closed_loop: [[closedloop1_A, closedloop1_B]]\ntype: [3d]\nname_mot: [motor_hip]\n")


NOT_XML = (*range(9), 11, 12, *range(14, 32), 0xFFFE, 0xFFFF)

#: Characters that XML allows in a name.
xml_text = st.text(
    st.characters(exclude_categories=["Cs"], exclude_characters=[chr(code) for code in NOT_XML]), min_size=1
)
nasty = st.sampled_from(
    ["no", "On", "y", "NULL", "~", "1e3", "1e-3", "0x1F", "0o7", "012", "1_000", "12:30", "2001-12-14", ".inf", ".NaN",
     "+.INF", "-", "- a", "a: b", "a #b", "#a", "a:", ":a", "? a", "&a", "*a", "!a", "|", ">", "%a", "@a", "`a",
     "'", '"', "'a'", '"a"', "[", "]", "{a}", "a,b", ", a", " a", "a ", "a  b", "\t", "a\nb", "a\r\nb", "a\\nb", "...",
     "---", "--- a", "<<", "=", "true", "False", "\x7f", "\x85", "\u2028", "\ufeff", "\xa0", "é", "\U0001f916", "x-a",
     "3d", "1.", ".5", "1.e5", "0b11", "0.", "+1", "a/b", "e5", "_", "n", "a" * 2000, "é: " * 500]
)  # fmt: skip


def read_back(text: str) -> Any:
    return read_yaml(Source("", text, text.encode())).data


@pytest.mark.slow
@settings(max_examples=300, deadline=None, derandomize=True)
@given(name=xml_text | nasty)
def test_names_survive_round_trip_everywhere(name: str) -> None:
    text = "\n".join(
        [
            *lines_of(name + "k", name),
            *lines_of("flow", [name, [name], {name: name, "k": [name]}]),
            *lines_of("block", [name, {name: [name] * 60}]),
            *lines_of("last", name),
            "",
        ]
    )
    expected = {
        name + "k": name,
        "flow": [name, [name], {name: name, "k": [name]}],
        "block": [name, {name: [name] * 60}],
        "last": name,
    }
    assume(len(expected) == 4)
    assert read_back(text) == expected
    # Readers of YAML 1.1 see the same.
    assert yaml.safe_load(text) == expected


@given(st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False))
@settings(max_examples=100, deadline=None, derandomize=True)
@example(1e-05)
@example(-0.0)
def test_numbers_survive_round_trip(value: float | bool | None) -> None:
    text = f"k: {scalar(value)}\n"
    assert repr(read_back(text)["k"]) == repr(value)
    assert repr(yaml.safe_load(text)["k"]) == repr(value)  # to parsers of YAML 1.1 too


def named(loop: str, motor: str, ball: str) -> str:
    """A URDF with these words in its names."""
    base = "base\x7f"
    joints: list[tuple[str, str, str, str, list[str]]] = [
        (f"motor_{motor}", "revolute", base, "rod", []),
        (f"spherical {ball}", "revolute", base, "other", []),
        ("fix1", "fixed", "rod", f"closedloop{loop}_A", []),
        ("fix2", "fixed", "other", f"closedloop{loop}_B", []),
    ]
    links = [base, "rod", "other", f"closedloop{loop}_A", f"closedloop{loop}_B"]
    return _written(etree.Element("robot", name="r"), links, joints)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(st.lists(xml_text | nasty, unique=True, min_size=3, max_size=3), st.sampled_from(["1", "2"]))
def test_any_names_can_be_described(names: list[str], version: Literal["1", "2"]) -> None:
    loop, motor, ball = names
    generation = generate(read(named(loop, motor, ball)), conventions(), version)
    assert generation.mechanism is not None, list(generation.diagnostics)
    (closure,) = generation.mechanism.closures
    assert (closure.a.frame, closure.b.frame) == (f"closedloop{loop}_A", f"closedloop{loop}_B")
    assert generation.mechanism.actuators == (f"motor_{motor}",)
    assert generation.found.sphericals == (f"spherical {ball}",)


# -- the command --------------------------------------------------------------------------------------------------


@pytest.fixture
def leg(tmp_path: Path) -> Path:
    file = tmp_path / "leg.urdf"
    file.write_text(urdf_text(*LEG), encoding="utf-8")
    return file


def test_command_writes_to_standard_output(leg: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", str(leg)]) == 0
    out, err = capsys.readouterr()
    assert out == LEG_TEXT.replace("robot.urdf", "leg.urdf")
    assert "1 closure: closedloop1 (closedloop1_A, closedloop1_B, 3d)\n1 motor: motor_hip\n" in err


def test_root_can_float(leg: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", str(leg), "--root", "floating"]) == 0
    assert "\nroot: floating\n" in capsys.readouterr().out
    assert main(["generate", str(leg), "--root", "floating", "--version", "1"]) == 2
    assert "version 1 cannot state a floating root" in capsys.readouterr().err


def test_version_1_cannot_name_its_urdf(leg: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", str(leg), "--version", "1"]) == 0
    assert "'leg.urdf'" in capsys.readouterr().err


def test_patterns_are_repeatable(leg: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", str(leg), "--motor", "hip", "--motor", "knee"]) == 0
    assert "actuators: [motor_hip, free_knee]" in capsys.readouterr().out


def test_contradicting_names_write_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = tmp_path / "ball.urdf", tmp_path / "ball.yaml"
    file.write_text(urdf_text(*BALL), encoding="utf-8")
    # Version 1 merges the three by itself, and then two of them cannot be actuated.
    assert main(["generate", str(file), "--version", "1", "--motor", "rev", "-o", str(out)]) == 1
    assert "actuator-merged" in capsys.readouterr().err
    assert not out.exists()
    assert main(["generate", str(file), "--motor", "rev", "-o", str(out)]) == 0


def test_urdf_with_errors_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bad.urdf"
    file.write_text("<robot name='r'><link name='a'/><link name='b'/></robot>", encoding="utf-8")
    assert main(["generate", str(file)]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert "urdf-two-roots" in err
    assert main(["generate", str(tmp_path / "none.urdf")]) == 2


def test_json_contains_text_and_notes(leg: Path, capsys: pytest.CaptureFixture[str]) -> None:
    leg.write_text(urdf_text(*LEG, "j9 fixed rod closedloop9_A"), encoding="utf-8")
    assert main(["generate", str(leg), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["closures"] == [{"name": "closedloop1", "type": "3d", "frames": ["closedloop1_A", "closedloop1_B"]}]
    assert answer["motors"] == ["motor_hip"]
    assert "closedloop9_A" in answer["warnings"][0]
    assert read_back(answer["text"])["actuators"] == ["motor_hip"]
    assert answer["notes"][0].startswith("'closedloop1' is 3d: the loops close")
    assert answer["hints"] == []


def test_python_generates_the_text_of_the_command(leg: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["generate", str(leg), "--universal", "xy=knee", "--motor", "hip", "--root", "floating"]) == 0
    made = eurdf.generate(leg, universals="xy=knee", motors=["hip"], root="floating")
    assert made.text == capsys.readouterr().out
    robot = eurdf.load(made.text, leg, geometry=False)
    assert robot.mechanism == made.mechanism
    assert repr(made) == "<Generation: version 2, 1 closures, 1 motors>"


def test_python_refuses_contradicting_names(tmp_path: Path) -> None:
    with pytest.raises(eurdf.InvalidRobot, match=r"contradict each other\n.*actuator-merged"):
        eurdf.generate(urdf_text(*BALL), version="1", motors="rev")
    with pytest.raises(eurdf.InvalidRobot, match="urdf-two-roots"):
        eurdf.generate("<robot name='r'><link name='a'/><link name='b'/></robot>")
    assert eurdf.generate(urdf_text(*LEG), urdf_path="../leg.urdf").text.splitlines()[1] == "urdf: ../leg.urdf"


# -- files of unusual names, line ends or encodings ---------------------------------------------------------------


def actuators_of_generated(folder: Path, data: bytes, urdf: str = "robot.urdf", *options: str) -> tuple[str, ...]:
    """The actuators of the robot that is written for a URDF, once the check finds nothing wrong with it."""
    (folder / urdf).write_bytes(data)
    assert main(["generate", str(folder / urdf), "-o", str(folder / "out.yaml"), *options]) == 0
    robot = read_robot(folder / "out.yaml")
    assert robot.mechanism is not None, list(robot.diagnostics)
    return robot.mechanism.actuators


@pytest.mark.parametrize("version", ["1", "2"])
@pytest.mark.parametrize("name", ["no", "膝", "a: b", "x\ny"], ids=ascii)
def test_file_of_any_names_survives_round_trip(tmp_path: Path, name: str, version: str) -> None:
    data = named(name, name, name).encode()
    motor = f"motor_{name}"
    assert actuators_of_generated(tmp_path, data, "robot.urdf", "--version", version, "--schema", "robot") == (motor,)
    schema = json.loads((tmp_path / "out.schema.json").read_text(encoding="utf-8"))
    assert motor in schema["$defs"]["UrdfJointName"]["enum"]


@pytest.mark.parametrize(("start", "end"), [("", "\r\n"), ("", "\r"), ("\ufeff", "\n")], ids=ascii)
def test_line_ends_of_urdf_do_not_matter(tmp_path: Path, start: str, end: str) -> None:
    text = start + named("é", "é", "é").replace("><", f">{end}<")
    assert actuators_of_generated(tmp_path, text.encode()) == ("motor_é",)
    written = (tmp_path / "out.yaml").read_bytes()
    assert b"\r" not in written
    assert b"motor_\xc3\xa9" in written


@pytest.mark.parametrize("encoding", ["latin-1", "utf-16"])
def test_other_encoding_is_refused_without_writing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], encoding: str
) -> None:
    (tmp_path / "robot.urdf").write_bytes(named("é", "é", "é").encode(encoding))
    assert main(["generate", str(tmp_path / "robot.urdf"), "-o", str(tmp_path / "out.yaml")]) == 1
    assert "file-not-utf8" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["robot.urdf"]


def test_default_loop_name_is_common_part() -> None:
    rows = ("hip revolute base thigh", "j1 fixed thigh top_of_rod", "j2 fixed base bottom_of_rod")
    assert generated(*rows, closures=["(?P<side>top|bottom)_of_.*"]).found.closures[0].name == "of_rod"


def test_unmatched_user_pattern_gives_hint() -> None:
    given_ = conventions(closures=["(?P<side>top|bottom)_rod"], motors=["drive"])
    urdf = read(urdf_text("knee revolute base thigh"))
    closure, motor = hints(urdf, find(urdf, given_), given_)
    assert closure.startswith("no two names match a --closure pattern")
    assert motor.startswith("no joint that can move matches a --motor pattern")


def test_three_intersecting_revolutes_are_merged() -> None:
    generation = generated(*BALL)
    assert generation.merges == {"rev2": ("rev0", "rev1", "rev2")}
    assert "  rev2: {type: spherical, merges: [rev0, rev1, rev2]}\n" in generation.text
    assert generation.mechanism is not None
    assert [joint.type for joint in generation.mechanism.joints] == ["fixed", "fixed", "spherical"]


@pytest.mark.parametrize(
    "urdf", ["no.urdf", "a: b.urdf", "my robot #1.urdf", "膝.urdf", "'x'.urdf", "1e3.urdf", "-x.urdf", "[a].urdf"]
)
def test_urdf_of_any_file_name_is_named(tmp_path: Path, urdf: str) -> None:
    actuators_of_generated(tmp_path, urdf_text(*LEG).encode(), urdf)
    assert yaml.safe_load((tmp_path / "out.yaml").read_text(encoding="utf-8"))["urdf"] == urdf


def test_missing_closures_or_motors_give_hints_of_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(urdf_text("knee revolute base thigh"), encoding="utf-8")
    assert main(["generate", str(file)]) == 0
    told = capsys.readouterr().err
    assert "0 closures\n0 motors\n" in told
    assert re.findall("^hint: (.{18})", told, re.MULTILINE) == ["no two links or jo", "no joint is named "]
    assert main(["generate", str(file), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["hints"]) == 2
