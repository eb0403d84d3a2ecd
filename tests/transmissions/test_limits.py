"""Limits of joints from those of their motors: polytopes and boxes."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

import eurdf
from eurdf.mechanism.mechanism import Motor
from eurdf.transmissions.polytope import image_of_box, largest_box, preimage_of_box
from support.transmissions import DRIVEN, posed, slider_crank, with_properties


def motor_ranges(robot: Any, motors: tuple[str, ...]) -> tuple[Any, Any]:
    properties = [robot.slots[motor].joint.properties for motor in motors]
    return np.array([each.effort[0] for each in properties]), np.array([each.velocity[0] for each in properties])


@pytest.mark.parametrize("name", DRIVEN)
def test_polytopes_are_what_the_motors_can_do(name: str) -> None:
    robot, q = posed(name)
    at = eurdf.transmission(robot, DRIVEN[name], q)
    limits = eurdf.transmissions.serial_limits(robot, DRIVEN[name], q)
    effort, fastest = motor_ranges(robot, at.motors)
    random = np.random.default_rng(0)
    tau_m = random.uniform(-1.0, 1.0, (10_000, len(effort))) * effort
    assert limits.torque.contains(tau_m @ at.G).all()
    # Random joint torques are inside exactly if the motors that balance them are within their limits.
    tau_J = random.uniform(-1.5, 1.5, (10_000, len(at.joints))) * np.abs(limits.torque.vertices).max(axis=0)
    within = (np.abs(tau_J @ at.B_J) <= effort).all(axis=1)
    np.testing.assert_array_equal(limits.torque.contains(tau_J), within)
    assert 0 < within.sum() < len(within)
    v_J = random.uniform(-1.5, 1.5, (10_000, len(at.joints))) * np.abs(limits.velocity.vertices).max(axis=0)
    within = (np.abs(v_J @ at.G.T) <= fastest).all(axis=1)
    np.testing.assert_array_equal(limits.velocity.contains(v_J), within)
    assert 0 < within.sum() < len(within)
    for polytope, box, axes in (
        (limits.torque, limits.torque_box, limits.torque_axes),
        (limits.velocity, limits.velocity_box, limits.velocity_axes),
    ):
        assert len(polytope.vertices) == 2 ** len(effort)
        assert polytope.contains(polytope.vertices).all()
        assert not polytope.contains(1.001 * polytope.vertices).any()
        corners = np.array(np.meshgrid(*[(-each, each) for each in box])).reshape(len(box), -1).T
        assert polytope.contains(corners).all()
        assert not polytope.contains(1.001 * corners).all()
        for j, ends in enumerate(axes):
            unit = np.eye(len(box))[j]
            assert polytope.contains(np.outer(ends, unit)).all()
            assert not polytope.contains(1.001 * np.outer(ends, unit)).any()


def test_zonotope_of_more_motors_than_joints_has_its_vertices() -> None:
    random = np.random.default_rng(1)
    G, lower, upper = random.normal(size=(5, 3)), -random.uniform(0.5, 2.0, 5), random.uniform(0.5, 2.0, 5)
    zonotope = image_of_box(G, lower, upper)
    assert len(zonotope.vertices) == 22  # 2 Σ C(4, k), k < 3, for generators in general position
    assert zonotope.contains(random.uniform(lower, upper, (10_000, 5)) @ G).all()
    for direction in random.normal(size=(20, 3)):
        along = G @ direction
        support = np.maximum(along * lower, along * upper).sum()
        assert (zonotope.vertices @ direction).max() == pytest.approx(support, rel=1e-12)

    bound = random.uniform(0.5, 2.0, 5)
    allowed = preimage_of_box(G, bound)
    for direction in random.normal(size=(10, 3)):
        best = linprog(-direction, np.vstack((G, -G)), np.concatenate((bound, bound)), bounds=(None, None))
        assert (allowed.vertices @ direction).max() == pytest.approx(-best.fun, rel=1e-9)

    line = image_of_box(np.array([[2.0], [-1.0]]), np.array([-1.0, -1.0]), np.array([1.0, 3.0]))
    assert line.axes.tolist() == [[-5.0, 3.0]]
    assert sorted(line.vertices[:, 0].tolist()) == [-5.0, 3.0]


def test_largest_box_is_the_largest() -> None:
    # Two motors side by side: each joint gets half of what it would have alone.
    np.testing.assert_allclose(largest_box(np.array([[2.0, 5.0], [2.0, -5.0]]), np.ones(2)), [0.25, 0.1], rtol=1e-12)
    random = np.random.default_rng(2)
    for n, m in ((2, 3), (3, 5), (4, 40)):
        A, b = random.normal(size=(m, n)), random.uniform(0.5, 2.0, m)
        box = largest_box(A, b)
        many = np.vstack([A * (1.0 + 1e-9 * k) for k in range(300)])  # nearly the same configuration, often
        np.testing.assert_allclose(largest_box(many, np.tile(b, 300)), box, rtol=1e-6)
        assert (np.abs(A) @ box <= b * (1.0 + 1e-12)).all()
        rows = {"type": "ineq", "fun": lambda x, A=A, b=b: b - np.abs(A) @ np.exp(x)}
        best = minimize(lambda x: -x.sum(), np.full(n, -3.0), constraints=rows, tol=1e-12, method="SLSQP")
        assert np.log(box).sum() == pytest.approx(-best.fun, abs=1e-7)


def test_common_box_holds_at_every_configuration() -> None:
    name = "unitree_g1_ankle"
    qs = np.array([posed(name, seed)[1] for seed in range(6)])
    robot, joints = posed(name)[0], DRIVEN[name]
    common = eurdf.transmissions.serial_limits(robot, joints, qs)
    one = [eurdf.transmissions.serial_limits(robot, joints, q) for q in qs]
    for kind in ("torque", "velocity"):
        box, bounded_by = getattr(common, f"{kind}_box"), getattr(common, f"{kind}_bounded_by")
        corners = box * np.array([[1.0, 1.0], [1.0, -1.0]])
        for index, each in enumerate(one):
            polytope = getattr(each, kind)
            assert polytope.contains(corners).all()
            assert polytope.contains(1.0001 * corners).all() == (index not in bounded_by)
            np.testing.assert_allclose(getattr(common, f"{kind}_axes")[index], getattr(each, f"{kind}_axes"), rtol=1e-9)
            assert box.prod() <= getattr(each, f"{kind}_box").prod() * (1.0 + 1e-9)
    along = eurdf.transmissions.serial_limits(robot, joints, qs, torque_ratio=[2.0, 1.0])
    assert along.torque_box[0] == pytest.approx(2.0 * along.torque_box[1])
    assert along.torque_box.prod() < common.torque_box.prod()
    np.testing.assert_array_equal(along.velocity_box, common.velocity_box)


def test_control_range_bounds_torques() -> None:
    robot, q = posed("unitree_g1_ankle")
    motors = MappingProxyType({"motor_a": Motor("a", (-10.0, 4.0))})
    narrow = with_properties(robot, {}, version="2.1", motors=motors)
    at = eurdf.transmission(narrow, DRIVEN["unitree_g1_ankle"], q)
    limits = eurdf.transmissions.serial_limits(narrow, DRIVEN["unitree_g1_ankle"], q)
    corners = np.array([at.joint_torque([a, b]) for a in (-10.0, 4.0) for b in (-25.0, 25.0)])
    np.testing.assert_allclose(
        limits.torque.vertices[np.lexsort(limits.torque.vertices.T)], corners[np.lexsort(corners.T)], rtol=1e-9
    )
    tau_m = at.motor_torque([limits.torque_axes[0, 1], 0.0])
    assert np.max(tau_m / [4.0, 25.0]) == pytest.approx(1.0) or np.min(tau_m / [10.0, 25.0]) == pytest.approx(-1.0)


def test_wrong_limits_are_refused() -> None:
    robot, joints = eurdf.load("unitree_g1_ankle", geometry=False), DRIVEN["unitree_g1_ankle"]
    for limits, message in (
        ({"effort": ()}, "'motor_a' has no effort limit; state one"),
        ({"velocity": ()}, "'motor_a' has no velocity limit; state one"),
        (
            {"effort": (0.0,)},
            "'motor_a' has the effort limit 0; state a positive one: effort in the <limit> of joint 'motor_a'",
        ),
        ({"effort": (-0.0,)}, "'motor_a' has the effort limit 0;"),
        ({"effort": (np.nan,)}, "'motor_a' has the effort limit nan;"),
        ({"velocity": (0.0,)}, "'motor_a' has the velocity limit 0; state a positive one: velocity in the <limit>"),
    ):
        with pytest.raises(ValueError, match=message):
            eurdf.transmissions.serial_limits(with_properties(robot, {"motor_a": limits}), joints)
    for control, shown in (
        ((0.0, 4.0), "0 to 4"),
        ((-4.0, -0.0), "-4 to 0"),
        ((1.0, 4.0), "1 to 4"),
        ((4.0, -4.0), "4 to -4"),
    ):
        motors = MappingProxyType({"motor_a": Motor("a", control)})
        pulling = with_properties(robot, {}, version="2.1", motors=motors)
        with pytest.raises(
            ValueError, match=f"'motor_a' has the control range {shown}; state one from below to above zero"
        ):
            eurdf.transmissions.serial_limits(pulling, joints)
    with pytest.raises(ValueError, match=r"torque_ratio is .* expected positive numbers"):
        eurdf.transmissions.serial_limits(robot, joints, torque_ratio=[1.0, -1.0])
    with pytest.raises(ValueError, match="no rows"):
        eurdf.transmissions.serial_limits(robot, joints, np.empty((0, robot.model.nq)))
    stretched, q = slider_crank(0.05, 0.13, 0.0)
    with pytest.raises(eurdf.errors.NoTransmission, match="G at q is not determined: the pose is singular"):
        eurdf.transmissions.serial_limits(stretched, "slide", q)
    with pytest.raises(eurdf.errors.NoTransmission, match=r"G at q\[1\] is not determined"):
        eurdf.transmissions.serial_limits(stretched, "slide", np.array([slider_crank(0.05, 0.13, 0.8)[1], q]))
    with pytest.raises(eurdf.errors.NoTransmission, match="leave out some"):
        eurdf.transmissions.serial_limits(robot, [*joints, "universal_rod_a"])


def test_limits_in_a_workspace_hold_between_its_points() -> None:
    crank, rod = 0.05, 0.13
    robot, q = slider_crank(crank, rod, 0.8)
    space = eurdf.transmissions.workspace(robot, "slide", q, grid=4, ranges={"slide": (0.1, 0.17)})
    limits = eurdf.transmissions.serial_limits(robot, "slide", space)

    def slope(angle: Any) -> Any:  # |dx/dθ|
        return crank * np.sin(angle) + crank**2 * np.sin(angle) * np.cos(angle) / np.sqrt(
            rod**2 - (crank * np.sin(angle)) ** 2
        )

    first, last = (np.arccos((x * x + crank**2 - rod**2) / (2.0 * crank * x)) for x in (0.1, 0.17))
    slopes = slope(np.linspace(last, first, 100_001))
    assert slopes.argmax() not in (0, 100_000)  # inside, and between the points of the grid
    force, velocity = 10.0 / slopes.max(), 3.0 * slopes.min()  # limits of the motor: 10 N·m, 3 rad/s
    assert limits.torque_box[0] == pytest.approx(force, rel=1e-3)
    assert limits.velocity_box[0] == pytest.approx(velocity, rel=1e-6)
    assert eurdf.transmissions.serial_limits(robot, "slide", space.q).torque_box[0] > 1.005 * force
    assert limits.torque_margin is not None
    assert 0.0 <= limits.torque_margin < 1e-2
    with pytest.raises(ValueError, match="the workspace is that of another robot, or of other joints: slide"):
        eurdf.transmissions.serial_limits(robot, "pin", space)
