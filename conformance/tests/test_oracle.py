"""The oracle, against mechanisms that were computed by hand."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eurdf_conformance.oracle import NotRead, OracleRobot, read
from eurdf_conformance.oracle.yaml_text import value_of
from written import UNIT, chain, joint, robot, two

ROBOTS = Path(__file__).parents[2] / "robots"

Z = (0, 0, 1)


def pose(found: OracleRobot, q: dict[str, list[float]], frame: str) -> Any:
    M = found.evaluate(q, [frame], ["poses"]).poses[frame]  # type: ignore[index]
    return np.column_stack([M.rotation, M.translation])


def origin(found: OracleRobot, q: dict[str, list[float]], frame: str) -> Any:
    return pose(found, q, frame)[:, 3]


def changed(entry: str, kind: str = "revolute", axis: Any = Z) -> OracleRobot:
    """One joint `j`, as the description changes it; `tip` is at (1, 2, 3) on what it moves, `base` on what does not."""
    frame = "frames: [{name: tip, joint: j, xyz: [1, 2, 3]}]"
    loop = "closures: [{name: loop, type: 3d, frames: [base, tip]}]"
    entry = f"joints: {{j: {entry}}}" if entry else ""
    return robot(chain(joint("j", kind, "base", "end", axis)), two("\n".join([frame, loop, entry])))


#: What j is, its axis in the URDF, coordinates, where the tip (1, 2, 3) then is, and the columns of its velocity there.
TRANSFORMS = [
    ("", "revolute", (0, 0, 2), [pi / 2], (-2, 1, 3), [(-1, -2, 0)]),
    ("", "continuous", (0, 3, 0), [-pi / 2], (-3, 2, 1), [(1, 0, 3)]),
    ("", "prismatic", (0, 0, -5), [0.5], (1, 2, 2.5), [(0, 0, -1)]),
    ("{type: helical, pitch: 0.8}", "revolute", (0, 0, 2), [pi / 2], (-2, 1, 3.2), [(-1, -2, 0.4 / pi)]),
    ("{type: helical, pitch: -0.8}", "prismatic", Z, [-pi / 2], (2, -1, 3.2), [(1, 2, -0.4 / pi)]),
    ("cylindrical", "prismatic", Z, [0.5, pi / 2], (-2, 1, 3.5), [(0, 0, 1), (-1, -2, 0)]),
    ("{type: universal, axes: xy}", "revolute", Z, [pi / 2, pi / 2], (3, 1, 2), [(0, -2, 1), (-1, 3, 0)]),
    ("{type: universal, axes: yx}", "revolute", Z, [pi / 2, pi / 2], (2, -3, -1), [(-1, 0, -2), (-3, -2, 0)]),
    ("{type: universal, axes: [[0, 0, 7], [2, 0, 0]]}", "revolute", Z, [0, pi], (1, -2, -3), [(2, 1, 0), (0, 3, -2)]),
    ("", "planar", Z, [10, 20, pi / 2], (8, 21, 3), [(0, 1, 0), (-1, 0, 0), (-1, -2, 0)]),
    ("spherical", "continuous", Z, [0, 0, 1, 1], (-2, 1, 3), [(3, 0, 2), (0, 3, -1), (-1, -2, 0)]),
    (
        "",
        "floating",
        Z,
        [10, 20, 30, 0, 0, sqrt(0.5), -sqrt(0.5)],
        (12, 19, 33),
        [(0, -1, 0), (1, 0, 0), (0, 0, 1), (-3, 0, 2), (0, -3, -1), (1, 2, 0)],
    ),
]


@pytest.mark.parametrize(("entry", "kind", "axis", "q", "tip", "columns"), TRANSFORMS)
def test_joint_velocities_are_in_the_child_frame(
    entry: str, kind: str, axis: Any, q: list[float], tip: Any, columns: Any
) -> None:
    # The velocity of the tip, which the base sees, as the angular velocity of the child times its distance.
    found = changed(entry, kind, axis)
    np.testing.assert_allclose(origin(found, {"j": q}, "tip"), tip, atol=1e-12)
    np.testing.assert_allclose(found.residual({"j": q}), tip, atol=1e-12)
    np.testing.assert_allclose(found.jacobian({"j": q}).T, columns, atol=1e-12)
    assert found.velocities == [("j", i) for i in range(len(columns))]


def test_a_chain_of_mimic_joints_moves_with_its_first_leader() -> None:
    found = robot(
        chain(
            joint("c", "prismatic", "base", "link_c"),
            joint("b", "revolute", "base", "link_b", more='<mimic joint="c" multiplier="-3" offset="0.2"/>' + UNIT),
            joint("a", "prismatic", "link_b", "link_a", more='<mimic joint="b" multiplier="2" offset="0.1"/>' + UNIT),
        ),
        two("closures: [{name: loop, type: 6d, frames: [base, link_a]}]"),
    )
    assert found.velocities == [("c", 0)]
    # b = 0.2 − 3 c; a = 0.1 + 2 b = 0.5 − 6 c.
    np.testing.assert_allclose(origin(found, {"c": [0.05]}, "link_a"), [0, 0, 0.2], atol=1e-12)
    np.testing.assert_allclose(found.residual({"c": [0.05]}), [0, 0, 0.2, 0, 0, 0.05], atol=1e-12)
    np.testing.assert_allclose(found.jacobian({"c": [0.05]}).T, [[0, 0, -6, 0, 0, -3]], atol=1e-12)
    with pytest.raises(NotRead):
        found.evaluate({"a": [1.0]}, [], ["residuals"])


def test_the_residual_of_a_quarter_turn_is_its_screw() -> None:
    found = robot(
        chain(joint("j", "revolute", "base", "end")),
        two("closures: [{name: loop, type: 6d, frames: [base, {link: end, xyz: [0, -1, 0]}]}]"),
    )
    # About z, V = [[sin φ, cos φ − 1], [1 − cos φ, sin φ]] / φ, and p = (sin φ, −cos φ): so v = φ/2 (1, −cot φ/2).
    np.testing.assert_allclose(found.residual({"j": [pi / 2]}), [pi / 4, -pi / 4, 0, 0, 0, pi / 2], atol=1e-12)
    # dv/dφ = (1/2, −1/2 cot φ/2 + φ/4 / sin² φ/2)
    np.testing.assert_allclose(found.jacobian({"j": [pi / 2]}).T, [[0.5, pi / 4 - 0.5, 0, 0, 0, 1]], atol=1e-12)


def test_the_residual_is_expressed_in_a_moving_frame_a() -> None:
    found = robot(
        chain(joint("j", "revolute", "base", "arm")),
        two("closures: [{name: loop, type: 3d, frames: [arm, {link: base, xyz: [2, 0, 0]}]}]"),
    )
    np.testing.assert_allclose(found.residual({"j": [0.3]}), [2 * cos(0.3), -2 * sin(0.3), 0], atol=1e-12)
    np.testing.assert_allclose(found.jacobian({"j": [0.3]}).T, [[-2 * sin(0.3), -2 * cos(0.3), 0]], atol=1e-12)


def test_ambiguous_frame_name_is_refused() -> None:
    elements = chain(joint("end", "revolute", "base", "end"), joint("base", "revolute", "end", "tip", xyz=(1, 0, 0)))
    found = robot(elements)
    np.testing.assert_allclose(origin(found, {}, "end"), [0, 0, 0])
    with pytest.raises(NotRead, match="two frames"):
        origin(found, {}, "base")


def test_the_robot_size_is_the_largest_distance_between_frames() -> None:
    found = robot(
        chain(joint("j", "prismatic", "base", "end", xyz=(3, 0, 0))),
        two("root: floating\nframes: [{name: tip, link: base, xyz: [0, 4, 0]}]"),
    )
    assert found.size({"root_joint": [9, 9, 9, 0, 0, 0, 1]}) == pytest.approx(5.0)
    assert found.size({"j": [12.0]}) == pytest.approx(13.0)


@pytest.mark.parametrize(
    ("name", "known"),
    {
        "four_bar": (3, 3, 2, 1, 0),
        "bennett": (4, 6, 3, 1, 0),
        "sarrus": (6, 6, 5, 1, 0),
        "planar_3rrr": (7, 6, 4, 3, 0),
        "stewart_platform": (36, 30, 30, 6, 0),
        "delta": (18, 15, 15, 3, 0),
        "digit_leg": (27, 18, 18, 9, 3),
    }.items(),
)
def test_a_mechanism_has_the_dimensions_of_the_textbook(name: str, known: tuple[int, ...]) -> None:
    found = read(ROBOTS / name / "robot.yaml", ROBOTS / name / "robot.urdf")
    closed = found.closed(found.description.configurations["assembled"])
    assert tuple(vars(found.dimensions(closed)).values()) == known


# -- What the oracle reads from descriptions of both versions, and says in the canonical description


LIMIT = '<limit lower="-1" upper="2" velocity="3" effort="4"/><dynamics damping="5" friction="6"/>'


def position(found: OracleRobot, frame: str, q: dict[str, list[float]] | None = None) -> Any:
    return found.evaluate(q or {}, [frame], ["poses"]).poses[frame].translation  # type: ignore[index]


def test_only_configurations_can_name_the_root_joint() -> None:
    elements = chain(joint("j", "revolute", "base", "end"))
    floating = two("root: floating\nconfigurations: {q: {root_joint: [1, 2, 3, 0, 0, 0, 2]}}\n")
    found = robot(elements, floating)
    assert found.canonical().configurations == {"q": {"root_joint": [1, 2, 3, 0, 0, 0, 1]}}
    assert [joint.name for joint in found.canonical().joints] == ["j"]
    for more in ("actuators: [root_joint]", "frames: [{name: f, joint: root_joint}]"):
        with pytest.raises(NotRead):
            robot(elements, floating + more)


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


# -- YAML as the oracle reads it: the core schema of YAML 1.2, whatever its library would make of a scalar


@pytest.mark.parametrize(
    "text",
    [
        ".inf",
        "-.INF",
        ".nan",
        "1e400",
        "9" * 400,
        "9" * 5000,
        "!own 1",
        "!!set {a}",
        "!!timestamp 2001-01-01",
        "!!int 1.0",
        "!!int x",
        "!!float 0x10",
        "!<int> 1",
        "!!map [1]",
        "*a",
        "&a [*a]",
        "[&a 1, &a [*a]]",
        "{a: 1, a: 2}",
        "{a: 1, 'a': 2}",
        "{1: 2}",
        "{null: 2}",
        "{[a]: 2}",
        "[a",
        '"\\ud800"',
        "1\n---\nkey: 2",
        "[" * 70 + "]" * 70,
        "\n - &a [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"
        + "".join(f"\n - &{b} [{', '.join(['*' + a] * 10)}]" for a, b in zip("abcde", "bcdef", strict=True)),
    ],
)
def test_an_invalid_value_is_not_read(text: str) -> None:
    with pytest.raises(NotRead):
        value_of(f"key: {text}")


@pytest.mark.parametrize("source", ["", "# nothing", "%YAML 1.1\n---\na: 1", "%YAML 1.3\n---\na: 1"])
def test_no_document_or_another_yaml_version_is_not_read(source: str) -> None:
    with pytest.raises(NotRead):
        value_of(source)
