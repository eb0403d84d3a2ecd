"""Inverse kinematics of frames of the closed mechanism, within its limits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

import eurdf
from eurdf import collection_names
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.bounded_step import bounded_step
from eurdf.kinematics.closing import start
from eurdf.kinematics.forward import forward_kinematics
from eurdf.kinematics.inverse import inverse_kinematics
from eurdf.kinematics.position_limit import position_limits
from eurdf.kinematics.residual import residual
from eurdf.kinematics.sensitivity import actuated_jacobian
from eurdf.kinematics.split import split_configuration
from support.actuated import ROBOTS, actuated, closed_near, robot_called
from support.linkage import Linkage, Z, chain, loop, n_bar, stewart, translation

# For each robot a frame to lead.
LED = {
    "digit_leg": "foot",
    "four_bar": "coupler",
    "wild/5bar_linkage": "effector",
    "wild/5bar_linkage_iso3d": "effector",
    "wild/cassie_like": "foot",
    "wild/digit_like": "foot",
    "wild/talos_like": "foot",
}


def pose(robot: Any, q: Any, frame: str) -> Any:
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, q)
    return data.oMf[next(index for index, found in enumerate(model.frames) if found.name == frame)].copy()


def outside_limits(robot: Any, q: Any) -> float:
    clipped = position_limits(robot).clip(q)
    return float(np.abs(clipped - q).max())


def is_floating(name: str) -> bool:
    return robot_called(name).mechanism.root == "floating"


def reachable(robot: Any, random: Any) -> Any:
    """A closed configuration within the limits, on any branch."""
    limits, q0 = position_limits(robot), assemble(robot, limits=True).q
    while True:
        away = limits.clip(pin.integrate(robot.model, q0, random.uniform(-1.0, 1.0, robot.model.nv)))
        found = assemble(robot, away, limits=True)
        if found.converged:
            return found.q


def arm(*lengths: float, limit: float = np.inf) -> Any:
    """A planar arm without loops, along x at zero, with a frame at its end."""
    model = chain(*lengths)
    model.lowerPositionLimit = np.full(len(lengths), -limit)
    model.upperPositionLimit = np.full(len(lengths), limit)
    return actuated(Linkage(model), ["j0"])


@pytest.mark.parametrize("name", [name for name in LED if name in ROBOTS])
@pytest.mark.parametrize("as_pose", [True, False])
def test_inverse_kinematics_recovers_forward_kinematics(name: str, as_pose: bool) -> None:
    robot, frame = robot_called(name), LED[name]
    random, q0 = np.random.default_rng(0), assemble(robot_called(name), limits=True).q
    found = 0
    for _ in range(8):
        wanted = closed_near(robot, random, 0.5, limits=True)
        q_actuated, _ = split_configuration(robot, wanted)
        reached = forward_kinematics(robot, q_actuated, wanted)
        target = pose(robot, reached, frame)
        answer = inverse_kinematics(robot, {frame: target if as_pose else target.translation}, q0)
        assert np.abs(residual(robot, answer.q)).max() <= 1e-10
        assert max(max(opening.position, opening.angle) for opening in answer.open) <= 1e-9
        assert outside_limits(robot, answer.q) == 0.0
        at = pose(robot, answer.q, frame)
        (error,) = answer.errors
        off = np.linalg.norm(at.translation - target.translation)
        turned = np.linalg.norm(pin.log3(at.rotation.T @ target.rotation)) if as_pose else 0.0
        assert (error.frame, error.position, error.angle) == (frame, pytest.approx(off), pytest.approx(turned))
        assert answer.converged == (max(off, turned) <= 1e-8)
        found += answer.converged
    assert found == 8


@pytest.mark.parametrize("name", ROBOTS)
def test_target_at_current_pose_takes_no_step(name: str) -> None:
    robot = robot_called(name)
    q = assemble(robot).q
    frame = next(found.name for found in robot.model.frames if found.parentJoint == robot.model.njoints - 1)
    answer = inverse_kinematics(robot, {frame: pose(robot, q, frame)}, q)
    assert (answer.converged, answer.iterations, answer.reason, answer.at_limits) == (True, 0, None, ())
    np.testing.assert_array_equal(answer.q, start(robot, q))


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=15, deadline=None)
def test_stewart_legs_are_found_from_platform_pose(seed: int) -> None:
    linkage, random = stewart(), np.random.default_rng(seed)
    model = linkage.model
    carrier = linkage.model.getJointId("ball0")
    model.addFrame(pin.Frame("top", carrier, 0, translation(0.1, 0.0, 0.2), pin.FrameType.OP_FRAME))
    robot = actuated(linkage)
    lengths = random.uniform(-0.1, 0.1, 6)
    target = pose(robot, forward_kinematics(robot, lengths), "top")
    answer = inverse_kinematics(robot, {"top": target})  # limits there are, at 1e308
    assert answer.converged
    np.testing.assert_allclose(split_configuration(robot, answer.q)[0], lengths, atol=1e-7)


def test_foot_trajectory_has_no_jumps() -> None:
    robot = robot_called("digit_leg")
    q = assemble(robot, limits=True).q
    home, steps = pose(robot, q, "foot"), []
    for phase in np.linspace(0.0, 2.0 * np.pi, 25):
        lift = np.array([0.05 * np.sin(phase), 0.0, 0.05 * (1.0 - np.cos(phase))])
        answer = inverse_kinematics(robot, {"foot": pin.SE3(home.rotation, home.translation + lift)}, q)
        assert answer.converged
        steps.append(np.abs(pin.difference(robot.model, q, answer.q)).max())
        q = answer.q
    assert max(steps) < 0.2
    # The motors come back with the foot.
    motors, _ = split_configuration(robot, q)
    np.testing.assert_allclose(motors, split_configuration(robot, assemble(robot, limits=True).q)[0], atol=1e-7)


@pytest.mark.parametrize("name", [name for name in ("digit_leg", "four_bar", "wild/talos_like") if name in ROBOTS])
def test_unreachable_target_ends_nearest_in_bounded_steps(name: str) -> None:
    robot, frame = robot_called(name), LED[name]
    q0 = assemble(robot).q
    target = pose(robot, q0, frame).translation + np.array([0.0, 0.4, -3.0])
    answer = inverse_kinematics(robot, {frame: target}, q0, limits=False)
    assert answer.iterations <= (20 + 2) * 60  # the descents and steps that `inverse_kinematics` states
    assert not answer.converged
    assert np.abs(residual(robot, answer.q)).max() <= 1e-10
    (error,) = answer.errors
    at = pose(robot, answer.q, frame).translation
    assert error.position > 1.0
    assert error.position == pytest.approx(np.linalg.norm(at - target))
    # No motion of the motors brings it nearer: what the frame can do, if anything, is across the line to the target.
    J = actuated_jacobian(robot, frame, answer.q, reference=pin.LOCAL_WORLD_ALIGNED)[:3]
    assert np.abs(J.T @ (at - target)).max() <= 1e-3 * error.position


def test_target_at_edge_of_reach_is_reached() -> None:
    robot = arm(1.0, 0.7)
    answer = inverse_kinematics(robot, {"end": [1.02, 1.36, 0.0]}, np.array([0.3, 0.8]), tolerance=1e-7)
    assert answer.converged


def test_joints_at_limits_are_the_reason() -> None:
    answer = inverse_kinematics(arm(1.0, 1.0, limit=0.5), {"end": [0.0, 2.0, 0.0]}, np.zeros(2))
    assert answer.reason == "joint limits"
    assert [(found.joint, found.side, found.limit) for found in answer.at_limits] == [
        ("j0", "upper", 0.5),
        ("j1", "upper", 0.5),
    ]
    assert "at their limits: 'j0' (upper limit 0.5), 'j1' (upper limit 0.5)" in repr(answer)


def test_irrelevant_joint_at_limit_is_not_the_reason() -> None:
    robot = arm(1.0, limit=0.5)
    answer = inverse_kinematics(robot, {"end": [2.0 * np.cos(0.3), 2.0 * np.sin(0.3), 1.0]}, np.array([0.5]))
    assert answer.q[0] == pytest.approx(0.3, abs=1e-4)
    assert (answer.reason, answer.at_limits) == ("local minimum", ())
    assert "no motion from the configuration found brings the frames nearer" in repr(answer)


@pytest.mark.parametrize(("name", "frame"), [("four_bar", "rocker_pin_a"), ("five_bar", "tip_b")])
def test_result_says_what_was_tried(name: str, frame: str) -> None:
    answer = inverse_kinematics(robot_called(name), {frame: [0.0, 0.0, 9.0]}, restarts=1, tolerance=1e-7)
    assert (answer.reason, answer.at_limits, answer.starts, answer.tolerance) == ("local minimum", (), 1, 1e-7)
    assert "(tolerance 1e-07 m and rad)" in repr(answer)
    assert f"{answer.iterations} iterations from 2 starts" in repr(answer)


def test_folded_start_is_not_the_reason() -> None:
    # All pins of the parallelogram are on a line: there, it has two motions.
    linkage = loop([("R", (0, 0, 0), Z), ("R", (0.5, 0, 0), Z), ("R", (1.5, 0, 0), Z)], "3d", (1.0, 0.0, 0.0))
    for joint in (1, 2):
        frame = pin.Frame(f"bar{joint}", joint, 0, translation(0.3, 0.2, 0.0), pin.FrameType.OP_FRAME)
        linkage.model.addFrame(frame)
    target = translation(0.5, 2.0, 0.0)
    answer = inverse_kinematics(actuated(linkage), {"bar1": target, "bar2": target}, np.zeros(3), restarts=0)
    assert answer.reason == "local minimum"


def test_target_within_rounding_is_a_matter_of_tolerance() -> None:
    robot = robot_called("digit_leg")
    q = assemble(robot, limits=True).q
    target = pose(robot, q, "foot") * translation(0.0, 0.01, 0.0)
    answer = inverse_kinematics(robot, {"foot": target}, q, tolerance=1e-30)
    assert (answer.reason, answer.starts) == ("tolerance", 0)
    assert max(answer.errors[0].position, answer.errors[0].angle) <= 1e-12


# Robots with a floating root reach every target.
@pytest.mark.parametrize("name", [name for name in collection_names() if not is_floating(name)])
def test_reachable_targets_are_reached_or_said_to_be_missed(name: str) -> None:
    robot, random, found = robot_called(name), np.random.default_rng(0), 0
    frame, q0 = robot.mechanism.bodies[-1].name, assemble(robot_called(name), limits=True).q
    for _ in range(8):
        target = pose(robot, reachable(robot, random), frame)
        answer = inverse_kinematics(robot, {frame: target}, q0)
        at = pose(robot, answer.q, frame)
        assert answer.errors[0].position == pytest.approx(np.linalg.norm(at.translation - target.translation))
        assert outside_limits(robot, answer.q) == 0.0
        assert answer.reason in (None, "joint limits", "tolerance", "local minimum")
        found += answer.converged
    assert found >= 7


def test_leaving_the_branch_is_said() -> None:
    # A crank of 1 m, which turns round, a coupler of 3 m and a rocker of 2.5 m: two ways of assembling them, mirrored.
    pins = [("R", (0.0, 0.0, 0.0), Z), ("R", (1.0, 0.0, 0.0), Z), ("R", (2.6875, np.sqrt(9.0 - 1.6875**2), 0.0), Z)]
    linkage = loop(pins, "3d", (3.0, 0.0, 0.0))
    linkage.model.addFrame(pin.Frame("coupler", 2, 0, translation(0.3, 0.2, 0.0), pin.FrameType.OP_FRAME))
    robot, mirrored = actuated(linkage), assemble(linkage, np.array([0.0, -1.947, 4.838])).q
    target = {"coupler": pose(robot, mirrored, "coupler")}
    answer = inverse_kinematics(robot, target, np.zeros(3))
    assert (answer.converged, answer.same_branch) == (True, False)
    assert "perhaps on another branch than q0" in repr(answer)
    near = inverse_kinematics(robot, target, mirrored + 0.05)
    assert (near.converged, near.same_branch, near.starts) == (True, True, 0)


def test_exhausted_steps_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("eurdf.kinematics.inverse_search.MOST_STEPS", 1)
    answer = inverse_kinematics(arm(1.0, 0.7), {"end": [0.0, 1.2, 0.0]}, np.array([0.3, 0.8]), restarts=0)
    assert (answer.converged, answer.reason) == (False, "steps")


def test_loops_kept_open_by_limits_are_the_reason() -> None:
    linkage = n_bar(4, away=0.7)
    linkage.model.lowerPositionLimit, linkage.model.upperPositionLimit = np.full(4, -0.1), np.full(4, 0.2)
    linkage.model.addFrame(pin.Frame("tip", 2, 0, translation(0.1, 0.0, 0.0), pin.FrameType.OP_FRAME))
    answer = inverse_kinematics(actuated(linkage), {"tip": [1.0, 0.0, 0.0]})
    assert (answer.converged, answer.reason) == (False, "closures open")
    assert answer.at_limits
    assert {found.joint for found in answer.at_limits} <= {"j0", "j1", "j2", "j3"}
    assert "closures stay open; open: 'end' by" in repr(answer)


def test_loops_and_limits_hold_together() -> None:
    found = 0
    for seed in range(20):
        random = np.random.default_rng(seed)
        linkage = n_bar(6, away=random.uniform(-0.5, 0.5, 6))
        model = linkage.model
        model.addFrame(pin.Frame("tip", 3, 0, translation(0.4, 0.2, 0.0), pin.FrameType.OP_FRAME))
        closed = assemble(linkage).q
        model.lowerPositionLimit = closed - random.uniform(0.0, 0.4, 6)
        model.upperPositionLimit = closed + random.uniform(0.0, 0.4, 6)
        robot = actuated(linkage)
        wanted = assemble(linkage, random.uniform(model.lowerPositionLimit, model.upperPositionLimit), limits=True).q
        answer = inverse_kinematics(robot, {"tip": pose(robot, wanted, "tip").translation}, closed)
        assert (model.lowerPositionLimit <= answer.q).all()
        assert (answer.q <= model.upperPositionLimit).all()
        assert np.abs(residual(robot, answer.q)).max() <= 1e-10
        found += answer.converged
    assert found >= 19


@pytest.mark.parametrize("seed", range(3))
def test_held_joints_stay_where_they_are_held(seed: int) -> None:
    robot, random = robot_called("digit_leg"), np.random.default_rng(seed)
    q0 = assemble(robot).q
    at = assemble(robot, pin.integrate(robot.model, q0, random.uniform(-0.05, 0.05, robot.model.nv))).q
    hold = ["motor_hip_x", ("ball_rod1_end", "z")]
    found = inverse_kinematics(robot, {"foot": pose(robot, at, "foot")}, q0, hold=hold, hold_at=at, limits=False)
    assert found.converged
    np.testing.assert_allclose(residual(robot, found.q), 0.0, atol=1e-9)
    np.testing.assert_allclose(pin.log6(pose(robot, found.q, "foot").actInv(pose(robot, at, "foot"))), 0.0, atol=1e-7)
    hip, ball = (robot.slots[name] for name in ("motor_hip_x", "ball_rod1_end"))
    assert found.q[hip.idx_q] == at[hip.idx_q] != q0[hip.idx_q]
    R, S = (pin.Quaternion(q[ball.idx_q : ball.idx_q + 4]).toRotationMatrix() for q in (at, found.q))
    assert abs(pin.log3(R.T @ S)[2]) < 1e-8
    # With the hip where it is at the start, another target is out of reach.
    there = pose(robot, at, "foot").translation + np.array([0.0, 0.2, 0.0])
    kept = inverse_kinematics(robot, {"foot": there}, q0, hold="motor_hip_x", restarts=2)
    assert not kept.converged
    assert kept.q[hip.idx_q] == q0[hip.idx_q]


def test_changed_limits_are_respected_while_joints_are_held() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q0, knee = assemble(robot).q, robot.slots["motor_knee"].idx_q
    values = dict(zip(robot.actuation.joints, q0[robot.actuation.idx_q].tolist(), strict=True))
    bent = forward_kinematics(robot, values | {"motor_knee": values["motor_knee"] + 0.1}, q0)
    robot.model.upperPositionLimit[knee] = q0[knee] + 0.01
    target = {"foot": pose(robot, bent, "foot")}
    assert inverse_kinematics(robot, target, q0, hold="motor_hip_x", restarts=1).q[knee] <= q0[knee] + 0.01 + 1e-12
    free = inverse_kinematics(robot, target, q0, hold="motor_hip_x", limits=False)
    assert free.q[knee] == pytest.approx(bent[knee], abs=1e-7)


def test_start_outside_limits_is_clipped() -> None:
    robot = arm(1.0, 1.0, limit=0.5)
    answer = inverse_kinematics(
        robot, {"end": pose(robot, np.array([0.4, 0.1]), "end").translation}, np.array([2.0, -3.0])
    )
    assert answer.converged
    assert np.abs(answer.q).max() <= 0.5


def test_start_is_closed_without_targets() -> None:
    linkage = n_bar(4, away=0.7)
    answer = inverse_kinematics(actuated(linkage), {}, limits=False)
    np.testing.assert_allclose(answer.q, assemble(linkage).q, atol=1e-12)
    assert answer.converged
    assert answer.errors == ()


@pytest.mark.parametrize(
    ("targets", "reason"),
    [
        ({"fooot": [0, 0, 0]}, r"no frame 'fooot'; did you mean 'foot'\?"),
        ({"foot": [0.0, 0.0]}, r"targets\['foot'\] has the shape \(2,\); expected \(3,\), or a pose"),
        ({"foot": [0.0, 0.0, np.nan]}, r"expected finite numbers of shape \(3,\), or a pose"),
        ({"foot": "here"}, r"expected finite numbers of shape \(3,\), or a pose"),
        ({"foot": pin.SE3(2.0 * np.eye(3), np.zeros(3))}, "is not a pose"),
        ({"foot": pin.SE3(-np.eye(3), np.zeros(3))}, "is not a pose"),
        ({"foot": pin.SE3(np.diag([1.0, np.nan, 1.0]), np.zeros(3))}, "is not a pose"),
        ({"foot": pin.SE3(np.eye(3), np.full(3, np.inf))}, "is not a pose"),
    ],
)
def test_invalid_target_is_refused(targets: Any, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        inverse_kinematics(robot_called("digit_leg"), targets)


@given(seed=st.integers(0, 2**32 - 1), size=st.integers(1, 8), count=st.integers(0, 20))
@settings(max_examples=200, deadline=None)
def test_bounded_step_is_optimal_within_bounds(seed: int, size: int, count: int) -> None:
    random = np.random.default_rng(seed)
    A = random.normal(size=(size, size))
    H, g = A @ A.T + 0.1 * np.eye(size), random.normal(size=size)
    G, h = random.normal(size=(count, size)), random.uniform(0.0, 0.5, count) * random.integers(0, 2, count)
    y = bounded_step(H, g, G, h)
    assert (G @ y <= h + 1e-9).all()
    # The conditions of the optimum: the slope is held up by bounds that are met, which push inward only.
    slope, met = H @ y + g, np.flatnonzero(G @ y >= h - 1e-8)
    pressures = np.zeros(0)
    remaining = slope
    if len(met):
        pressures, _ = nnls(G[met].T, -slope)
        remaining = slope + G[met].T @ pressures
    np.testing.assert_allclose(remaining, 0.0, atol=1e-6)
