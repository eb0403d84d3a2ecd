"""The oracle, against mechanisms that were computed by hand."""

from __future__ import annotations

from math import cos, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eurdf_conformance.oracle import NotRead, OracleRobot, read
from written import UNIT, chain, joint, link, robot, two

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


def test_the_mass_matrix_of_a_two_link_arm_is_right() -> None:
    m1, m2, l1, c1, c2, I1, I2 = 2.0, 1.5, 0.7, 0.3, 0.4, 0.05, 0.02
    found = robot(
        [
            link("base", 5.0),
            link("upper", m1, (c1, 0, 0), (0, 0, I1)),
            link("fore", m2, (c2, 0, 0), (0, 0, I2)),
            joint("shoulder", "revolute", "base", "upper"),
            joint("elbow", "revolute", "upper", "fore", xyz=(l1, 0, 0)),
        ],
        two("joints: {elbow: {armature: 0.25}}"),
    )
    bent = m2 * l1 * c2 * cos(0.8)
    inner = I2 + m2 * c2**2
    M = [[I1 + m1 * c1**2 + m2 * l1**2 + inner + 2 * bent, inner + bent], [inner + bent, inner + 0.25]]
    q = {"shoulder": [0.4], "elbow": [0.8]}
    np.testing.assert_allclose(found.mass_matrix(q), M, rtol=1e-12)
    values = found.evaluate(q, [], ["mass", "center_of_mass"])
    assert values.mass == m1 + m2 + 5.0
    elbow = l1 * np.array([cos(0.4), sin(0.4), 0])
    center = m1 * c1 / l1 * elbow + m2 * (elbow + c2 * np.array([cos(1.2), sin(1.2), 0]))
    np.testing.assert_allclose(values.center_of_mass, center / (m1 + m2 + 5.0), atol=1e-12)  # type: ignore[arg-type]


def test_a_floating_root_has_the_total_inertia_in_its_frame() -> None:
    found = robot([link("body", 3.0, (0, 0, 0.5), (1, 2, 3))], two("root: floating"))
    q = {"root_joint": [1000.0, 0, 0, 0, 0, sqrt(0.5), sqrt(0.5)]}
    M = np.diag([3.0, 3, 3, 1 + 0.75, 2 + 0.75, 3])
    M[0, 4] = M[4, 0] = 1.5
    M[1, 3] = M[3, 1] = -1.5
    np.testing.assert_allclose(found.mass_matrix(q), M, atol=1e-12)
    assert found.evaluate(q, [], ["center_of_mass"]).center_of_mass == [1000.0, 0.0, 0.5]
    assert found.velocities == [("root_joint", i) for i in range(6)]


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
