"""Finding a configuration in which every loop is closed."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.residual import residual
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.pose import Pose
from support.linkage import (
    Linkage,
    Z,
    bennett,
    closure,
    four_bar,
    loop,
    n_bar,
    pulled_apart,
    sarrus,
    scissors,
    slider_crank,
    spherical_four_bar,
    translation,
)
from support.wild import FACTS, WILD, needs_wild

OPEN = {
    "four-bar in 6d": lambda: n_bar(4, away=0.7),
    "four-bar in 3d": lambda: n_bar(4, "3d", away=0.7),
    "five-bar in 6d": lambda: n_bar(5, away=-0.9),
    "twenty bars": lambda: n_bar(20, away=0.2),
    "slider-crank": lambda: slider_crank(away=0.5),
    "spherical four-bar": lambda: spherical_four_bar(away=(0.3, 0.2, -0.3, 0.4)),
    "Sarrus": lambda: sarrus(away=(0.3, -0.2, 0.4, 0.1, 0.2, 0.3)),
    "Bennett": bennett,
}


def sized(pose: Pose, size: float) -> Pose:
    x, y, z = pose.xyz
    return replace(pose, xyz=(size * x, size * y, size * z))


@pytest.mark.parametrize("build", OPEN.values(), ids=OPEN.keys())
@pytest.mark.parametrize("size", [1.0, 1000.0, 0.01])
def test_open_linkage_closes_at_any_size(build: Callable[[], Linkage], size: float) -> None:
    linkage = build()
    for joint in range(1, linkage.model.njoints):
        linkage.model.jointPlacements[joint].translation *= size
    (end,) = linkage.constraints
    assert isinstance(end, Closure)
    a, b = (replace(frame, pose=sized(frame.pose, size)) for frame in end.anchors)
    linkage = replace(linkage, constraints=[replace(end, a=a, b=b)])
    assert np.linalg.norm(residual(linkage, pin.neutral(linkage.model))) > 1e-3
    assembly = assemble(linkage)
    assert assembly.converged
    assert assembly.closes
    r = residual(linkage, assembly.q)
    # Evaluated in another order than assembly does: up to 20 bars of this size, each rounded to 1e-16 of it.
    rounding = 1e-13 * max(size, 1.0)
    assert np.abs(r).max() <= 1e-10 + rounding
    assert assembly.residual == pytest.approx(np.linalg.norm(r), abs=max(1e-12, rounding))
    assert assembly.iterations < 60


@pytest.mark.parametrize("angle", [-2.0, -0.5, 0.3, 1.0, 2.5])
def test_held_crank_closes_at_circle_intersection(angle: float) -> None:
    crank, coupler, rocker, ground = 1.0, 3.0, 2.5, 2.8  # the crank turns all round: 1 + 3 < 2.5 + 2.8
    linkage = four_bar(crank, coupler, rocker, ground)
    assembly = assemble(linkage, np.array([angle, 0.5, 0.5]), hold=["j0"])
    assert assembly.converged
    assert assembly.q[0] == angle
    pin_a = crank * np.array([np.cos(angle), np.sin(angle)])
    across = np.array([ground, 0.0]) - pin_a
    distance = np.linalg.norm(across)
    along = (coupler**2 - rocker**2 + distance**2) / (2.0 * distance)
    height = np.sqrt(coupler**2 - along**2)
    heading = angle + assembly.q[1]
    reached = pin_a + coupler * np.array([np.cos(heading), np.sin(heading)])
    normal = np.array([-across[1], across[0]]) / distance
    meetings = [pin_a + along * across / distance + sign * height * normal for sign in (1.0, -1.0)]
    assert min(np.linalg.norm(reached - meeting) for meeting in meetings) < 1e-9


def test_straight_start_with_zero_gradient_closes() -> None:
    linkage = four_bar(1.0, 3.0, 2.0, 3.5)  # all pins on one line: no joint moves the end along it
    assembly = assemble(linkage)
    assert assembly.converged
    assert np.abs(assembly.q).max() > 0.1


def test_impossible_loop_is_left_least_open() -> None:
    linkage = four_bar(1.0, 3.0, 2.0, 9.0)  # 6 m of bars for 9 m of ground
    assembly = assemble(linkage, np.array([0.4, -0.8, 0.5]))
    assert not assembly.converged
    assert not assembly.closes
    assert assembly.residual == pytest.approx(3.0, abs=1e-6)
    (opening,) = assembly.open
    assert opening.name == "end"
    assert opening.position == pytest.approx(3.0, abs=1e-6)
    assert opening.angle == 0.0
    assert assembly.iterations < 500


def test_held_joints_stay_and_can_keep_loop_open() -> None:
    linkage = four_bar(1.0, 3.0, 2.0, 5.5)
    q0 = np.array([np.pi, 0.3, -0.2])  # the crank points away: 5 m of bars for 6.5 m
    assembly = assemble(linkage, q0, hold=["j0"])
    assert assembly.q[0] == np.pi
    assert assembly.residual == pytest.approx(1.5, abs=1e-6)
    assert assemble(linkage, q0).converged
    nothing = assemble(linkage, q0, hold=["j0", "j1", "j2"])
    np.testing.assert_array_equal(nothing.q, q0)
    assert not nothing.closes


def moved_leg(seed: int) -> tuple[eurdf.Robot, np.ndarray, np.ndarray]:
    """Digit's leg, and two configurations; at the second one its loops are open."""
    robot, random = eurdf.load("digit_leg", geometry=False), np.random.default_rng(seed)
    first = eurdf.assemble(robot).q
    one, other = (pin.integrate(robot.model, first, random.uniform(-0.2, 0.2, robot.model.nv)) for _ in range(2))
    return robot, eurdf.assemble(robot, one).q, other


@pytest.mark.parametrize("seed", range(3))
def test_joints_are_held_where_another_configuration_has_them(seed: int) -> None:
    robot, at, q0 = moved_leg(seed)
    hold = ["motor_knee", "ball_rod1_end", "motor_hip_x"]
    mixed = robot.configuration(robot.joint_positions(q0) | {name: robot.joint_positions(at)[name] for name in hold})
    found = eurdf.assemble(robot, q0, hold=hold, hold_at=at)
    assert found.closes
    np.testing.assert_allclose(found.q, eurdf.assemble(robot, mixed, hold=hold).q, atol=1e-9)
    for slot in (robot.slots[name] for name in hold):
        here = slice(slot.idx_q, slot.idx_q + slot.nq)
        np.testing.assert_array_equal(found.q[here], at[here])
    knee = eurdf.assemble(robot, q0, hold=hold, hold_at={"motor_knee": 0.5}).q
    assert robot.joint_positions(knee)["motor_knee"] == (0.5,)
    assert robot.joint_positions(knee)["motor_hip_x"] == robot.joint_positions(q0)["motor_hip_x"]


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("axes", ["z", "xy"])
def test_ball_is_held_about_axes_of_its_own(axes: str, seed: int) -> None:
    robot, at, q0 = moved_leg(seed)
    slot = robot.slots["ball_rod1_end"]

    def turn(q: np.ndarray) -> np.ndarray:
        from_, to = (pin.Quaternion(x[slot.idx_q : slot.idx_q + 4]).toRotationMatrix() for x in (at, q))
        return np.array(pin.log3(from_.T @ to))[["xyz".index(axis) for axis in axes]]

    found = eurdf.assemble(robot, q0, hold=["motor_knee", (slot.joint.name, axes)], hold_at=at)
    assert found.converged
    assert np.abs(turn(eurdf.assemble(robot, q0).q)).max() > 1e-2
    np.testing.assert_allclose(turn(found.q), 0.0, atol=1e-8)
    assert found.q[robot.slots["motor_knee"].idx_q] == at[robot.slots["motor_knee"].idx_q]
    assert [opening.name for opening in found.open[3:]] == [f"ball_rod1_end about {axis}" for axis in axes]
    np.testing.assert_allclose(eurdf.residual(robot, found.q), 0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("hold", "reason"),
    [
        ([("ball_rod1_end", "w")], "the axes of 'ball_rod1_end' are 'w'; expected one or two of x, y and z"),
        ([("ball_rod1_end", "zz")], "are 'zz'"),
        ([("motor_knee", "z")], "'motor_knee' is no spherical joint"),
        ([("ball_rod1_ent", "z")], "did you mean 'ball_rod1_end'"),
    ],
)
def test_axes_that_cannot_be_held_are_refused(hold: list[tuple[str, str]], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        eurdf.assemble("digit_leg", hold=hold)
    with pytest.raises(ValueError, match="hold_at: 'knee' is not a joint"):
        eurdf.assemble("digit_leg", hold="motor_knee", hold_at={"knee": 0.1})
    with pytest.raises(ValueError, match="hold names no joint"):
        eurdf.inverse_kinematics("digit_leg", {}, hold_at={"motor_knee": 0.1})


def test_joints_outside_loops_stay() -> None:
    linkage = n_bar(4, away=0.7)
    model = linkage.model
    model.addJoint(0, pin.JointModelFreeFlyer(), translation(1.0, 2.0, 3.0), "beside")
    model.addJoint(1, pin.JointModelRX(), pin.SE3.Identity(), "on the crank")
    q0 = pin.integrate(model, pin.neutral(model), np.arange(model.nv) * 0.1)
    assembly = assemble(linkage, q0)
    assert assembly.converged
    for name in ("beside", "on the crank"):
        joint = model.joints[model.getJointId(name)]
        part = slice(joint.idx_q, joint.idx_q + joint.nq)
        np.testing.assert_allclose(assembly.q[part], q0[part], atol=1e-12)


def test_unknown_held_joint_is_refused_with_nearest_name() -> None:
    model = pin.Model()
    parent = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "motor_knee")
    linkage = Linkage(model, [closure(model, 0, pin.SE3.Identity(), parent, pin.SE3.Identity())])
    with pytest.raises(ValueError, match=r"no joint 'motor_kne'; did you mean 'motor_knee'\?"):
        assemble(linkage, hold=["motor_kne"])


def test_default_start_is_assembled_configuration() -> None:
    linkage = n_bar(4, away=0.7)
    linkage.configurations["assembled"] = np.full(4, 0.7)
    assembly = assemble(linkage)
    np.testing.assert_array_equal(assembly.q, np.full(4, 0.7))
    assert assembly.iterations == 1
    assert not np.allclose(assemble(linkage, np.zeros(4)).q, 0.7)


def test_other_joints_move_after_some_reach_limits() -> None:
    converged = 0
    for seed in range(40):
        random = np.random.default_rng(seed)
        linkage = n_bar(6, away=random.uniform(-0.8, 0.8, 6))
        closed = assemble(linkage).q
        lower, upper = closed - random.uniform(0.0, 0.5, 6), closed + random.uniform(0.0, 0.5, 6)
        linkage.model.lowerPositionLimit, linkage.model.upperPositionLimit = lower, upper
        assembly = assemble(linkage, random.uniform(lower, upper), limits=True, restarts=0)
        assert ((lower <= assembly.q) & (assembly.q <= upper)).all()
        converged += assembly.converged
    assert converged >= 38  # of 40 with a single descent; 30 if limits were only cut off at


@pytest.mark.parametrize(("off", "closes"), [(0.5e-6, True), (0.7e-6, False)])
def test_opening_is_euclidean_length_of_all_axes(off: float, closes: bool) -> None:
    linkage = loop([("R", (0.0, 0.0, 0.0), Z)], "3d", (0.0, 0.0, 0.3))  # closed on the axis, which moves nothing
    assembly = assemble(pulled_apart(linkage, translation(0.0, 0.0, 0.3) * translation(off, off, off)))
    assert assembly.closes is closes
    assert assembly.open[0].is_open is not closes


def test_limits_that_keep_loop_open_are_named() -> None:
    linkage = n_bar(4, away=0.7)
    linkage.model.lowerPositionLimit, linkage.model.upperPositionLimit = np.full(4, -0.1), np.full(4, 0.2)
    assembly = assemble(linkage, limits=True)
    assert (assembly.closes, assembly.reason) == (False, "joint limits")
    for found in assembly.at_limits:
        index = int(found.joint.removeprefix("j"))
        assert found.limit == (0.2 if found.side == "upper" else -0.1)
        assert assembly.q[index] == pytest.approx(found.limit, abs=1e-9)
    assert f"at their limits: '{assembly.at_limits[0].joint}' (" in repr(assembly)
    free = assemble(linkage)
    assert (free.reason, free.at_limits) == (None, ())
    assert repr(free).startswith("<Assembly: closed; residual")


def test_impossible_loop_is_not_blamed_on_limits() -> None:
    linkage = four_bar(1.0, 1.0, 1.0, 9.0)
    linkage.model.lowerPositionLimit, linkage.model.upperPositionLimit = np.full(3, -3.0), np.full(3, 3.0)
    assembly = assemble(linkage, limits=True)
    assert (assembly.closes, assembly.reason, assembly.at_limits) == (False, "not closed", ())


def test_equal_limits_lock_unless_both_are_zero() -> None:
    linkage = n_bar(4, away=0.7)
    linkage.model.lowerPositionLimit = linkage.model.upperPositionLimit = np.zeros(4)
    assert assemble(linkage, limits=True).converged
    linkage.model.lowerPositionLimit = linkage.model.upperPositionLimit = np.full(4, 0.1)
    locked = assemble(linkage, limits=True)
    assert (locked.closes, locked.reason) == (False, "joint limits")
    np.testing.assert_array_equal(locked.q, np.full(4, 0.1))
    with pytest.raises(ValueError, match="limits is 'none'; use True or False"):
        assemble(linkage, limits="none")  # type: ignore[arg-type]


def test_contradicting_redundant_rows_are_a_reason() -> None:
    assembly = assemble(sarrus(away=(0.3, -0.2, 0.4, 0.1, 0.2, 0.3), decimals=7))
    assert (assembly.converged, assembly.closes, assembly.reason) == (False, True, "rounding")


def test_limits_do_not_apply_to_balls_and_wheels() -> None:
    model = pin.Model()
    wheel = model.addJoint(0, pin.JointModelRUBZ(), pin.SE3.Identity(), "wheel")
    ball = model.addJoint(wheel, pin.JointModelSpherical(), translation(1.0, 0.0, 0.0), "ball")
    model.lowerPositionLimit = np.full(6, -1.01)
    model.upperPositionLimit = np.full(6, 1.01)
    linkage = Linkage(model, [closure(model, 0, translation(-1.0, 0.0, 0.0), ball, pin.SE3.Identity())])
    assembly = assemble(linkage, pin.integrate(model, pin.neutral(model), np.array([0.5, 0.1, 0.2, 0.3])), limits=True)
    assert assembly.converged
    np.testing.assert_allclose(assembly.q[:2], [-1.0, 0.0], atol=1e-9)


def test_loop_with_mimic_joint_closes() -> None:
    assembly = assemble(scissors(), np.array([0.8, 0.3]), hold=["fold"])
    assert assembly.converged
    np.testing.assert_allclose(assembly.q, [0.8, 2.0 * np.cos(0.8)], atol=1e-9)


def test_robot_with_other_closures_is_assembled_anew() -> None:
    linkage = four_bar(1.0, 3.0, 2.5, 2.8)
    start = np.array([0.3, 0.5, 0.5])
    assert assemble(linkage, start).converged
    moved = pulled_apart(linkage, translation(3.1, 0.0, 0.0))
    assert np.abs(residual(moved, assemble(moved, start).q)).max() <= 1e-10
    assert np.abs(residual(linkage, assemble(linkage, start).q)).max() <= 1e-10


def test_changed_limits_are_used() -> None:
    linkage = four_bar(1.0, 3.0, 2.5, 2.8)
    start = np.array([0.3, 0.5, 0.5])
    assert assemble(linkage, start).converged
    linkage.model.lowerPositionLimit, linkage.model.upperPositionLimit = np.full(3, -1.0), np.full(3, 1.5)
    assert 0.7 < assemble(linkage, start, limits=True).q.max() <= 1.5
    linkage.model.upperPositionLimit = np.full(3, 0.7)
    assert assemble(linkage, start, limits=True).q.max() <= 0.7


def test_cached_assembler_keeps_no_reference_to_robot() -> None:
    linkage = n_bar(5, away=0.3)
    for hold in ([], ["j0"], ["j1"]):
        assert assemble(linkage, hold=hold).converged
    alive = weakref.ref(linkage)
    del linkage
    gc.collect()
    assert alive() is None


def test_chain_of_loops_needs_evaluations_of_slowest_loop() -> None:
    model, constraints = pin.Model(), []
    foot = 0
    for index in range(40):
        parent, name = foot, f"{index}_"
        for bar, length in enumerate((0.0, 1.0, 1.5)):
            parent = model.addJoint(parent, pin.JointModelRZ(), translation(length, 0.0, 0.0), f"{name}{bar}")
        constraints.append(
            closure(model, foot, translation(1.6, 0, 0), parent, translation(1.2, 0, 0), "3d", f"loop{index}")
        )
        foot = parent
    q0 = np.tile([0.9, -0.7, 1.9], 40) + np.random.default_rng(0).uniform(-0.1, 0.1, 120)
    chain = Linkage(model, constraints)
    assembly = assemble(chain, q0)
    assert assembly.converged
    assert assembly.iterations < 10
    assert np.abs(residual(chain, assembly.q)).max() <= 1e-10


def test_robot_without_closures_is_closed() -> None:
    assembly = assemble(Linkage(n_bar(4).model))
    assert assembly.converged
    assert (assembly.residual, assembly.iterations, assembly.open) == (0.0, 0, ())


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=50, deadline=None)
def test_result_is_never_more_open_than_start(seed: int) -> None:
    random = np.random.default_rng(seed)
    linkage = four_bar(*random.uniform(0.2, 2.0, 4))  # half of them cannot close
    q0 = random.uniform(-3.0, 3.0, 3)
    assembly = assemble(linkage, q0, restarts=0)
    assert assembly.residual <= np.linalg.norm(residual(linkage, q0)) + 1e-12


@needs_wild
@pytest.mark.parametrize("name", [name for name, facts in FACTS.items() if facts["closes"]])
def test_published_robots_close_in_few_steps(name: str) -> None:
    robot = eurdf.load(WILD / name, geometry=False)
    assembly = assemble(robot)
    assert assembly.converged
    assert np.abs(residual(robot, assembly.q)).max() <= 1e-10
    assert assembly.iterations < 15


@needs_wild
def test_published_robot_that_cannot_close_ends_in_bounded_steps() -> None:
    robot = eurdf.load(WILD / "kangaroo_like", geometry=False)
    assembly = assemble(robot)
    assert assembly.iterations <= (20 + 2) * (60 + 1)  # the descents and steps that `assemble` states
    assert not assembly.closes
    assert assembly.residual == pytest.approx(FACTS["kangaroo_like"]["residual"], rel=0.05)
    closed = [opening.name for opening in assembly.open if max(opening.position, opening.angle) < 1e-9]
    assert 0 < len(closed) < len(assembly.open)


@given(size=st.floats(-6.5, 4.0), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_closed_loops_are_closed_relative_to_the_size_of_the_robot(size: float, seed: int) -> None:
    linkage = n_bar(4, "3d", away=0.7, size=10.0**size)
    assembly = assemble(linkage, 0.7 + np.random.default_rng(seed).uniform(-0.3, 0.3, 3))
    assert assembly.closes
    assert assembly.open[0].position <= 1e-6 * 10.0**size


@pytest.mark.parametrize("size", [4e-7, 1e-4, 1.0])
def test_loop_that_is_too_short_does_not_close_at_any_size(size: float) -> None:
    bars = [("R", (0.0, 0.0, 0.0), Z), ("R", (1.0, 0.0, 0.0), Z)]
    linkage = loop(bars, "3d", (2.0, 0.0, 0.0), size=size)
    assembly = assemble(pulled_apart(linkage, translation(2.5 * size, 0.0, 0.0)))
    assert (assembly.closes, assembly.converged) == (False, False)
