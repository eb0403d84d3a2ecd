"""What the oracle reads from descriptions of both versions, and says in the canonical description."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

from eurdf_conformance.oracle import NotRead, OracleRobot
from eurdf_conformance.protocol.message import CanonicalJoint
from written import chain, joint, link, robot, two

LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/><dynamics damping="5" friction="6"/>'


def canonical_joint(kind: str, entry: str, more: str = "") -> CanonicalJoint:
    found = robot(chain(joint("j", kind, "base", "end", more=LIMIT)), two(f"joints: {{j: {entry}}}\n{more}"))
    return found.canonical().joints[0]


def position(found: OracleRobot, frame: str, q: dict[str, list[float]] | None = None) -> Any:
    return found.evaluate(q or {}, [frame], ["poses"]).poses[frame].translation  # type: ignore[index]


@pytest.mark.parametrize(
    ("kind", "entry", "lower", "upper"),
    [
        ("revolute", "{type: universal, axes: xy}", [-1, -1], [2, 2]),
        ("continuous", "{type: universal, axes: xy}", [None, None], [None, None]),
        ("revolute", "cylindrical", [None, -1], [None, 2]),
        ("prismatic", "cylindrical", [-1, None], [2, None]),
        ("revolute", "spherical", [], []),
        ("revolute", "{type: helical, pitch: 0.5}", [-1], [2]),
        ("prismatic", "{type: helical, pitch: 0.5}", [-4 * pi], [8 * pi]),
        ("prismatic", "{type: helical, pitch: -0.5}", [-8 * pi], [4 * pi]),
        ("prismatic", "{type: helical, pitch: -0.5, limits: {upper: 7}}", [-8 * pi], [7]),
        ("revolute", "{type: universal, axes: xy, limits: {lower: [-3, -4], upper: 5}}", [-3, -4], [5, 5]),
        ("prismatic", "{limits: {upper: 1.5}}", [-1], [1.5]),
    ],
)
def test_stated_position_limits_replace_those_of_the_urdf(
    kind: str, entry: str, lower: list[float], upper: list[float]
) -> None:
    found = canonical_joint(kind, entry)
    assert (found.lower, found.upper) == (pytest.approx(lower), pytest.approx(upper))


@pytest.mark.parametrize(
    ("entry", "expected"),
    [
        ("spherical", [[3, 3, 3], [4, 4, 4], [5, 5, 5], [6, 6, 6], [0, 0, 0]]),
        (
            "{type: universal, axes: xy, limits: {velocity: 9}, damping: [7, 8]}",
            [[9, 9], [4, 4], [7, 8], [6, 6], [0, 0]],
        ),
        ("{armature: 0.5, friction: 0, limits: {effort: 1}}", [[3], [1], [5], [0], [0.5]]),
    ],
)
def test_stated_joint_properties_replace_those_of_the_urdf(entry: str, expected: list[list[float]]) -> None:
    found = canonical_joint("revolute", entry)
    assert [found.velocity, found.effort, found.damping, found.friction, found.armature] == expected


def test_properties_of_a_helical_joint_are_converted_to_its_angle() -> None:
    found = canonical_joint("prismatic", f"{{type: helical, pitch: {-4 * pi}, limits: {{effort: 7}}}}")  # |h| / 2π = 2
    numbers = [found.lower, found.upper, found.velocity, found.effort, found.damping, found.friction]
    assert numbers == [pytest.approx([value]) for value in (-1, 0.5, 1.5, 7, 20, 12)]


def test_a_planar_joint_takes_no_properties_from_the_urdf() -> None:
    found = canonical_joint("planar", "{damping: [1, 2, 3]}")
    assert (found.velocity, found.effort, found.friction, found.lower) == ([None] * 3, [None] * 3, [0] * 3, [])
    assert found.damping == [1, 2, 3]


def test_only_configurations_can_name_the_root_joint() -> None:
    elements = chain(joint("j", "revolute", "base", "end"))
    floating = two("root: floating\nconfigurations: {q: {root_joint: [1, 2, 3, 0, 0, 0, 2]}}\n")
    found = robot(elements, floating)
    assert found.canonical().configurations == {"q": {"root_joint": [1, 2, 3, 0, 0, 0, 1]}}
    assert [joint.name for joint in found.canonical().joints] == ["j"]
    for more in ("actuators: [root_joint]", "frames: [{name: f, joint: root_joint}]"):
        with pytest.raises(NotRead):
            robot(elements, floating + more)


@pytest.mark.parametrize(("entry", "armature"), [("cylindrical", [200.0, 200.0]), ("{armature: 0}", [0.0])])
def test_a_stated_armature_replaces_the_reflected_rotor_inertia(entry: str, armature: list[float]) -> None:
    actuators = "actuators: [{joint: j, gear_ratio: -10, rotor_inertia: 2}]"
    assert canonical_joint("revolute", entry, actuators).armature == armature


BALL = (
    joint("rx", "revolute", "base", "x", (1, 0, 0), (1, 0, 0), more=LIMIT),
    joint("ry", "revolute", "x", "y", (0, -2, 0), (0, 2, 0), more=LIMIT.replace("3", "33")),
    joint("rz", "revolute", "y", "end", (0, 0, 3), (0, -2, 3), (0, 0, pi / 2), more=LIMIT.replace("3", "333")),
)


def test_merged_joints_rotate_about_their_center_and_keep_names() -> None:
    found = robot(chain(*BALL), two("joints: {ball: {type: spherical, merges: [rx, ry, rz]}}"))
    assert found.velocities == [("ball", 0), ("ball", 1), ("ball", 2)]
    quarter_turn_about_y_of_the_frame = {"ball": [0, 1, 0, 1]}  # which is −x of the base
    for frame, place in {
        "rx": (1, 0, 0),
        "x": (1, 0, 0),
        "ry": (1, 2, 0),
        "end": (1, 3, 0),
        "rz": (1, 3, 0),
        "ball": (1, 3, 0),
    }.items():
        np.testing.assert_allclose(position(found, frame, quarter_turn_about_y_of_the_frame), place, atol=1e-12)
    ball = found.canonical().joints[0]
    assert (ball.parent, ball.child, ball.lower) == ("base", "end", [])
    # x of the frame is y of the base.
    assert ball.velocity == [33, 3, 333]
    assert found.bodies == [["base", "x", "y"], ["end"]]


def test_the_center_of_merged_axes_is_the_least_squares_point() -> None:
    # Squares: y² + z², x² + (z − d)², x² + (y − 2d)². The carried link is at (0, 2d, up).
    half_turn_about_x = position(crossing(d := 6e-5, up := 0.1), "end", {"rz": [1, 0, 0, 0]})
    np.testing.assert_allclose(half_turn_about_x, [0, 0, d - up], atol=1e-12)


def test_axes_that_meet_next_to_the_last_origin_meet_there() -> None:
    half_turn_about_x = position(crossing(d := 6e-5, 0.0), "end", {"rz": [1, 0, 0, 0]})
    np.testing.assert_allclose(half_turn_about_x, [0, 2 * d, 0], atol=1e-12)


def crossing(d: float, up: float) -> OracleRobot:
    """Axes through (0, 0, 0), (0, 0, d) and (0, 2d, up), along x, y and z, as one joint."""
    return robot(
        chain(
            joint("rx", "revolute", "base", "x", (1, 0, 0)),
            joint("ry", "revolute", "x", "y", (0, 1, 0), (0, 0, d)),
            joint("rz", "revolute", "y", "end", (0, 0, 1), (0, 2 * d, up - d)),
        ),
        two("joints: {rz: {type: spherical, merges: [rx, ry, rz]}}"),
    )


ONE_BALL = chain(
    joint("rx", "revolute", "base", "x", (1, 0, 0)),
    joint("ry", "revolute", "x", "y", (0, 1, 0)),
    joint("rz", "revolute", "y", "end", (0, 0, 1)),
    joint("other", "revolute", "base", "far", xyz=(1, 0, 0)),
)


def test_version_1_names_a_merged_joint_by_the_last() -> None:
    found = robot(ONE_BALL, "name_mot: [rz]")
    assert found.velocities == [("rz", 0), ("rz", 1), ("rz", 2), ("other", 0)]
    assert found.canonical().actuators[0].gear_ratio == [1, 1, 1]


@pytest.mark.parametrize(
    ("before", "after", "yaml"),
    [
        ('<link name="x"/>', link("x", 1e-5), "note: 1"),
        ('name="ry" type="revolute"', 'name="ry" type="continuous"', "note: 1"),
        ('xyz="0.0 1.0 0.0"', 'xyz="1.0 5e-7 0.0"', "note: 1"),
        (
            '<joint name="rz" type="revolute"><origin xyz="0.0',
            '<joint name="rz" type="revolute"><origin xyz="2.1e-4',
            "",
        ),
        ('<link name="x"/>', '<link name="x"/><link name="tool"/>' + joint("t", "fixed", "x", "tool"), "note: 1"),
        ("", "", "joint_name: [ry]\njoint_type: [SPHERICAL]"),
        ("", "", "closed_loop: [[x, far]]"),
        ("", "", "closed_loop: [[far, ry]]"),
    ],
)
def test_version_1_merges_nothing_where_one_condition_fails(before: str, after: str, yaml: str) -> None:
    elements = "".join(ONE_BALL).replace(before, after, 1)
    kinds = [found.type for found in robot([elements], yaml or "note: 1").canonical().joints]
    assert kinds.count("spherical") == yaml.count("SPHERICAL")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('<axis xyz="1.0 0.0 0.0"/>', '<axis xyz="1 0 0"/><mimic joint="other"/>'),
        ('<parent link="base"/><child link="far"/>', '<parent link="base"/><child link="far"/><mimic joint="nobody"/>'),
    ],
)
def test_version_1_ignores_mimics(before: str, after: str) -> None:
    elements = "".join(ONE_BALL)
    assert elements.count(before) == 1
    found = robot([elements.replace(before, after)], "name_mot: [other]").canonical()
    assert [(joint.name, joint.type, joint.mimic) for joint in found.joints] == [
        ("rz", "spherical", None),
        ("other", "revolute", None),
    ]


def test_the_mimic_of_a_fixed_joint_has_no_effect() -> None:
    text = joint("weld", "fixed", "far", "tool", more='<mimic joint="other" multiplier="2"/>')
    found = robot([*ONE_BALL, '<link name="tool"/>', text], two("actuators: [other]")).canonical()
    assert [joint.mimic for joint in found.joints] == [None] * 4


def test_the_first_three_of_four_revolutes_are_merged() -> None:
    axes = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)]
    row = [joint(f"j{i}", "revolute", f"l{i}", f"l{i + 1}", axis) for i, axis in enumerate(axes)]
    found = robot(chain(*row[::-1]), "{}")
    assert [joint.name for joint in found.canonical().joints] == ["j2", "j3"]


def test_version_1_splits_a_universal_joint_in_axis_order() -> None:
    found = robot(
        chain(joint("j", "revolute", "base", "end", xyz=(0, 0, 1), more=LIMIT)),
        "joint_name: [j]\njoint_type: [UJOINT_ZX]\nname_mot: [j_X]\nclosed_loop: [[base, j]]\ntype: [3D]",
    )
    assert found.velocities == [("j_Z", 0), ("j_X", 0)]
    first, second = found.canonical().joints
    assert (first.parent, first.child, second.child) == ("base", second.parent, "end")
    assert first.child not in found.urdf.links
    assert (first.lower, second.upper, second.damping) == ([-1], [2], [5])
    rotation = found.evaluate({"j_Z": [pi / 2], "j_X": [pi / 2]}, ["j"], ["poses"]).poses["j"].rotation  # type: ignore[index]
    np.testing.assert_allclose(rotation, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-12)
    assert found.canonical().closures[0].model_dump() == {"name": "closure_1", "type": "3d", "a": "base", "b": "end"}
    with pytest.raises(NotRead):
        robot(chain(joint("j", "revolute", "base", "end")), "joint_name: [j]\njoint_type: [UJOINT_ZX]\nname_mot: [j]")


def test_version_1_defaults_to_6d_and_a_fixed_root() -> None:
    found = robot(ONE_BALL, "closed_loop: [[end, far]]").canonical()
    assert (found.closures[0].type, found.version, found.root) == ("6d", "1", "fixed")


def test_user_data_is_stored_by_pointer() -> None:
    elements = chain(joint("j", "revolute", "base", "end"))
    own = "x-a/b~: {x-inner: 1}\njoints: {x-note: no, j: {armature: 1, x-c: [1]}}\nactuators: [{joint: j, x-d: null}]"
    assert robot(elements, two(own)).canonical().own == {
        "/x-a~1b~0": {"x-inner": 1},
        "/joints/x-note": "no",
        "/joints/j/x-c": [1],
        "/actuators/0/x-d": None,
    }
    assert robot(elements, "gait: {x-a: 0o14}\nx-b: 12:30\ntype: []").canonical().own == {
        "/gait": {"x-a": 12},
        "/x-b": "12:30",
    }


def test_configurations_are_lists_with_quaternions_of_unit_length() -> None:
    elements = chain(joint("j", "revolute", "base", "a"), joint("k", "prismatic", "base", "b"))
    yaml = "joints: {j: spherical}\nconfigurations: {q: {k: 1, j: [0, 0.6000001, 0, 0.8]}, x-own: 1}"
    q = robot(elements, two(yaml)).canonical().configurations["q"]
    assert q["k"] == [1.0]
    assert np.linalg.norm(q["j"]) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    "yaml",
    [
        'extended_urdf: "2.2"',
        "extended_urdf: 2.0",
        "root: fixed",
        two("rooot: fixed"),
        two("urdf:"),
        two("joints: {k: spherical}"),
        two("joints: {j: {type: universal}}"),
        two("joints: {j: {type: helical}}"),
        two("joints: {j: {damping: [1, 2]}}"),
        two("joints: {j: {armature: true}}"),
        two("joints: {end: {type: spherical, merges: [j, k, l]}}"),
        two("closures: [{name: a, type: 4d, frames: [base, end]}]"),
        two("closures: [{name: a, type: 3d, frames: [base, tip]}]"),
        two("closures: [{name: a, type: 3d, frames: [base, {link: base, joint: j}]}]"),
        two("frames: [{name: a, link: j}]"),
        two("actuators: [j, j]"),
        two("configurations: {q: {k: 1}}"),
        two("configurations: {q: {j: [1, 2]}}"),
        "closed_loop: [[base, end]]\ntype: [3d, 3d]",
        "joint_name: [j]\njoint_type: [UJOINT_XX]",
        "[]",
    ],
)
def test_the_oracle_does_not_read_doubtful_files(yaml: str) -> None:
    with pytest.raises(NotRead):
        robot(chain(joint("j", "revolute", "base", "end")), yaml)


@pytest.mark.parametrize(
    "element",
    [
        '<link name="base"/>',
        '<link name="loose"/>',
        joint("k", "revolute", "end", "base"),
        joint("k", "ball", "base", "new") + '<link name="new"/>',
        joint("k", "revolute", "base", "new", (0, 0, 0)) + '<link name="new"/>',
        joint("k", "revolute", "base", "new", more="") + '<link name="new"/>',
        joint("k", "revolute", "base", "new").replace('xyz="0.0 0.0 0.0"', 'xyz="0 0 1_0"') + '<link name="new"/>',
        joint("k", "revolute", "base", "new").replace('xyz="0.0 0.0 0.0"', 'xyz="0 0"') + '<link name="new"/>',
        "<link/>",
        "</robot><robot>",
    ],
)
def test_oracle_refuses_a_doubtful_urdf(element: str) -> None:
    with pytest.raises(NotRead):
        robot([*chain(joint("j", "revolute", "base", "end")), element], two(""))


def test_prefix_hides_the_name_of_an_element() -> None:
    elements = chain(joint("j", "revolute", "base", "end"))
    found = robot([*elements, '<drake:link name="base" xmlns:drake="urn:d"/>', "<gazebo><link name='base'/></gazebo>"])
    assert list(found.urdf.links) == ["base", "end"]
