"""What the oracle reads from descriptions of both versions, and says in the canonical description."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

from eurdf_conformance.oracle import NotRead, OracleRobot
from written import chain, joint, robot, two

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
