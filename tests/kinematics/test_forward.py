"""Forward kinematics of the closed mechanism, and how it moves with its motors."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.errors import DependentActuators, EurdfError, NotClosable, TooFar
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.forward import forward_kinematics
from eurdf.kinematics.residual import residual, residual_and_jacobian
from eurdf.kinematics.sensitivity import actuated_jacobian, dq_dq_actuated
from eurdf.kinematics.split import split_configuration
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.robot import build_robot
from support.actuated import ROBOTS, actuated, closed_near, robot_called
from support.linkage import Linkage, X, Z, bennett, four_bar, loop, n_bar, slider_crank, stewart, translation

BUILD = {
    "slider-crank": lambda: actuated(slider_crank()),
    "five-bar": lambda: actuated(n_bar(5), ["j4", "j0"]),
    "five-bar in 3d": lambda: actuated(n_bar(5, "3d"), ["j0", "j1"]),
    "Bennett": lambda: actuated(bennett()),
    "Stewart": lambda: actuated(stewart()),
    **{name: (lambda name=name: robot_called(name)) for name in ROBOTS},  # type: ignore[misc]
}


def crank_and_rocker(ground: float = 2.5) -> Any:
    """Planar: a crank of 1 m, a coupler of 2.5 m, a rocker of 2 m, all along x at zero; the crank goes all around."""
    return actuated(four_bar(1.0, 2.5, 2.0, ground))


def above(ground: float, angle: float) -> float:
    """Height of the coupler's far end over the line from the crank's pin to the ground's: its sign is the branch."""
    across = np.array([ground, 0.0]) - np.array([np.cos(angle), np.sin(angle)])
    distance = np.linalg.norm(across)
    along = (2.5**2 - 2.0**2 + distance**2) / (2.0 * distance)
    return float(np.sqrt(2.5**2 - along**2))


def coupler_end(q: Any) -> Any:
    heading = q[0] + q[1]
    return np.array([np.cos(q[0]) + 2.5 * np.cos(heading), np.sin(q[0]) + 2.5 * np.sin(heading)])


@pytest.mark.parametrize("name", BUILD)
def test_motors_reach_given_coordinates_with_closed_loops(name: str) -> None:
    robot, random = BUILD[name](), np.random.default_rng(0)
    q0 = assemble(robot).q
    for _ in range(3):
        q_actuated, _ = split_configuration(robot, closed_near(robot, random, 0.2))
        q = forward_kinematics(robot, q_actuated, q0)
        np.testing.assert_allclose(split_configuration(robot, q)[0], q_actuated, atol=1e-12)
        assert np.abs(residual(robot, q)).max() <= 1e-10
        assert pin.isNormalized(robot.model, q, 1e-12)


@pytest.mark.parametrize("name", BUILD)
def test_unmoved_motors_keep_configuration(name: str) -> None:
    robot = BUILD[name]()
    q = closed_near(robot, np.random.default_rng(1))
    np.testing.assert_allclose(forward_kinematics(robot, split_configuration(robot, q)[0], q), q, atol=1e-12)


@pytest.mark.parametrize("turns", [0.3, 2.0, -3.0, 2.0 * np.pi, -12.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_large_crank_motion_stays_on_branch(turns: float, side: float) -> None:
    robot = crank_and_rocker(2.5)
    angle, height = 0.4, above(2.5, 0.4)
    q0 = assemble(robot, np.array([angle, 0.7 * side, -1.0 * side]), hold=["j0"]).q
    for begin, at in ((True, angle), (False, angle + turns)):
        q = q0 if begin else forward_kinematics(robot, np.array([at]), q0)
        pin_a = np.array([np.cos(q[0]), np.sin(q[0])])
        across = np.array([2.5, 0.0]) - pin_a
        reached = coupler_end(q) - pin_a
        height = (across[0] * reached[1] - across[1] * reached[0]) / np.linalg.norm(across)
        assert q[0] == at
        assert height == pytest.approx(side * above(2.5, at), abs=1e-8)


def test_joints_are_given_by_name_with_file_coordinates() -> None:
    robot = robot_called("four_bar")
    by_name = forward_kinematics(robot, {"motor_crank": 2.5})
    q_actuated = np.array([2.5]) if len(robot.actuation.idx_q) == 1 else np.array([np.cos(2.5), np.sin(2.5)])
    np.testing.assert_allclose(by_name, forward_kinematics(robot, q_actuated), atol=1e-12)
    np.testing.assert_allclose(by_name, forward_kinematics(robot, {"motor_crank": [2.5]}), atol=1e-12)
    leg = robot_called("digit_leg")
    told = {"free_foot1": 0.1, "ball_rod1_end": [0.0, 0.0, 0.6, 0.8], "motor_knee": -0.2}
    q = forward_kinematics(leg, {"free_foot1": 0.1, "motor_knee": -0.2})
    assert np.abs(residual(leg, q)).max() <= 1e-10
    first = leg.model.joints[leg.model.getJointId("free_foot1")].idx_q
    assert q[first] == 0.1
    with pytest.raises(ValueError, match=r"actuated\['ball_rod1_end'\] has the shape \(3,\); expected \(4,\)"):
        forward_kinematics(leg, {**told, "ball_rod1_end": [0.0, 0.0, 1.0]})


def test_floating_root_stays_unless_given() -> None:
    robot = eurdf.load("four_bar", root="floating", geometry=False)
    q0 = assemble(robot).q
    pose = [1.0, 2.0, 3.0, 0.0, 0.6, 0.0, 0.8]
    q = forward_kinematics(robot, {"motor_crank": 0.5, "root_joint": pose}, q0)
    np.testing.assert_allclose(q[:7], pose, atol=1e-12)
    assert np.abs(residual(robot, q)).max() <= 1e-10
    np.testing.assert_allclose(forward_kinematics(robot, {"motor_crank": 0.5}, q)[:7], pose, atol=1e-12)


def test_unreachable_coordinates_report_open_loops() -> None:
    robot = crank_and_rocker(4.5)  # 4.5 m of bars: the crank cannot point away from the ground pin
    q0 = assemble(robot, np.array([0.3, 0.6, -1.0])).q
    with pytest.raises(
        NotClosable, match=r"cannot be closed at the given coordinates: closures stay open, 'end' by 1 m"
    ) as raised:
        forward_kinematics(robot, np.array([np.pi]), q0)
    assert isinstance(raised.value, EurdfError)
    assert raised.value.openings[0].name == "end"
    assert raised.value.openings[0].position == pytest.approx(1.0, abs=1e-6)


def test_blocked_path_differs_from_open_goal() -> None:
    robot = crank_and_rocker(4.5)
    q0 = assemble(robot, np.array([0.3, 0.6, -1.0])).q
    # The path passes the angle at which the crank points away; the goal is one full turn from a reachable angle.
    with pytest.raises(TooFar, match="not on a straight path"):
        forward_kinematics(robot, np.array([2.0 * np.pi + 0.3]), q0)
    assert forward_kinematics(robot, np.array([-0.3]), q0)[0] == -0.3


def test_start_that_cannot_close_is_refused() -> None:
    robot = crank_and_rocker(9.0)
    with pytest.raises(NotClosable, match="no closed configuration was found near the start"):
        forward_kinematics(robot, np.array([0.1]))


def test_mimic_joint_is_given_through_leader() -> None:
    lead = Joint("lead", JointType.REVOLUTE, "base", "a", axes=(Z,))
    follow = Joint("follow", JointType.REVOLUTE, "a", "b", axes=(X,))
    mimic = dataclasses.replace(follow, mimic=Mimic("lead", 2.0, 0.1))
    mechanism = Mechanism("two", "", "fixed", (Body("base"), Body("a"), Body("b")), (lead, mimic), actuators=("lead",))
    robot = build_robot(mechanism, geometry=False)
    np.testing.assert_array_equal(forward_kinematics(robot, {"lead": 0.4}), [0.4])
    assert dq_dq_actuated(robot, np.array([0.4])).shape == (1, 1)
    assert actuated_jacobian(robot, "b", np.array([0.4])).shape == (6, 1)
    np.testing.assert_allclose(actuated_jacobian(robot, "b", np.array([0.4]))[3:, 0] @ np.array(X), 2.0)
    with pytest.raises(ValueError, match="'follow' is a mimic joint"):
        forward_kinematics(robot, {"follow": 0.4})


@pytest.mark.parametrize("name", BUILD)
def test_sensitivity_is_derivative_of_forward_kinematics(name: str) -> None:
    robot, random = BUILD[name](), np.random.default_rng(2)
    q = closed_near(robot, random, 0.2)
    q = assemble(robot, q, tolerance=1e-13, restarts=0).q
    model, h = robot.model, 1e-3
    D = dq_dq_actuated(robot, q)
    _, K = residual_and_jacobian(robot, q)
    np.testing.assert_allclose(K @ D, 0.0, atol=2e-6)  # numbers in published files are rounded
    np.testing.assert_allclose(robot.actuation.selection.T @ D, np.eye(D.shape[1]), atol=1e-12)
    for column, index in enumerate(robot.actuation.idx_v):
        ways = []
        for step in (h, -h, 2.0 * h, -2.0 * h):
            told = split_configuration(robot, pin.integrate(model, q, step * np.eye(model.nv)[index]))[0]
            ways.append(pin.difference(model, q, forward_kinematics(robot, told, q, tolerance=1e-13)))
        difference = (8.0 * (ways[0] - ways[1]) - ways[2] + ways[3]) / (12.0 * h)
        scale = max(1.0, np.abs(difference).max())
        np.testing.assert_allclose(D[:, column], difference, atol=2e-6 * scale)


@pytest.mark.parametrize(("name", "free"), [("digit_leg", 3), ("four_bar", 0), ("Stewart", 0)])
def test_uncontrolled_motion_is_minimal_in_metric(name: str, free: int) -> None:
    robot, random = BUILD[name](), np.random.default_rng(4)
    q, nv = closed_near(robot, random), robot.model.nv
    A = random.normal(size=(nv, nv))
    metric = A @ A.T + np.eye(nv)
    _, K = residual_and_jacobian(robot, q)
    bound = np.vstack([K, robot.actuation.selection.T])
    _, values, right = np.linalg.svd(bound)
    uncontrolled = right[int((values > 1e-9 * values[0]).sum()) :].T
    assert uncontrolled.shape[1] == free
    for weights, W in ((None, np.eye(nv)), (metric, metric)):
        D = dq_dq_actuated(robot, q, weights=weights)
        np.testing.assert_allclose(bound @ D, np.vstack([np.zeros_like(K @ D), np.eye(D.shape[1])]), atol=1e-9)
        np.testing.assert_allclose(uncontrolled.T @ W @ D, 0.0, atol=1e-8)


def test_dependent_motors_are_named() -> None:
    both = actuated(crank_and_rocker(), ["j0", "j2"])
    q = assemble(both, np.array([0.4, 0.7, -1.0])).q
    with pytest.raises(DependentActuators, match="'j0', 'j2'") as raised:
        dq_dq_actuated(both, q)
    assert isinstance(raised.value, EurdfError)
    assert (raised.value.joints, raised.value.actuated, raised.value.rank) == (("j0", "j2"), 2, 1)
    # A motor beside the loop is free, and not accused.
    model = both.model
    model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "beside")
    three = actuated(Linkage(model, both.constraints), ["beside", "j2", "j0"])
    with pytest.raises(DependentActuators) as raised:
        dq_dq_actuated(three, np.append(q, 0.0))
    assert (raised.value.joints, raised.value.rank) == (("j2", "j0"), 2)


def test_motor_in_rigid_loop_cannot_move() -> None:
    triangle = actuated(loop([("R", (0, 0, 0), Z), ("R", (1, 0, 0), Z), ("R", (0.4, 0.8, 0), Z)]))
    with pytest.raises(DependentActuators) as raised:
        dq_dq_actuated(triangle, np.zeros(3))
    assert (raised.value.joints, raised.value.rank) == (("j0",), 0)


def test_motor_at_dead_point_is_refused() -> None:
    # Driven by the hinge between coupler and rocker, a crank along the ground can turn in either direction.
    robot = actuated(crank_and_rocker(), ["j2"])
    straight = assemble(robot, np.array([0.0, 0.7, -1.0]), hold=["j0"]).q
    with pytest.raises(DependentActuators) as raised:
        dq_dq_actuated(robot, straight)
    assert (raised.value.joints, raised.value.rank) == (("j2",), 0)
    near = assemble(robot, straight + np.array([0.02, 0.0, 0.0]), hold=["j0"]).q
    assert np.abs(dq_dq_actuated(robot, near)).max() > 10.0


def test_frames_are_found_by_name_or_nearest_suggested() -> None:
    robot = robot_called("digit_leg")
    q = assemble(robot).q
    with pytest.raises(ValueError, match=r"no frame 'fooot'; did you mean 'foot'\?"):
        actuated_jacobian(robot, "fooot", q)
    model = pin.Model()
    a = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "a")
    model.addBodyFrame("a", a, pin.SE3.Identity(), model.addJointFrame(a))
    same = actuated(Linkage(model, [], ["a"]))
    np.testing.assert_allclose(actuated_jacobian(same, "a", np.zeros(1)), np.eye(6)[:, 3:4], atol=1e-12)
    model.addFrame(pin.Frame("a", a, 0, translation(1.0, 0.0, 0.0), pin.FrameType.OP_FRAME), False)
    with pytest.raises(ValueError, match="frame name 'a' is ambiguous"):
        actuated_jacobian(actuated(Linkage(model, [], ["a"])), "a", np.zeros(1))


def test_robots_without_loops_or_motors_work() -> None:
    chain = actuated(Linkage(n_bar(4).model), ["j2", "j0"])
    q = forward_kinematics(chain, np.array([0.3, -0.4]), np.arange(4.0))
    np.testing.assert_array_equal(q, [-0.4, 1.0, 0.3, 3.0])
    np.testing.assert_allclose(dq_dq_actuated(chain, q), np.eye(4)[:, [2, 0]], atol=1e-12)
    still = actuated(n_bar(4), [])
    np.testing.assert_array_equal(forward_kinematics(still, np.empty(0)), np.zeros(4))
    assert dq_dq_actuated(still, np.zeros(4)).shape == (4, 0)
