"""The state of the viewer: what a slider does, where it stops and why."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics.evaluate import frames
from eurdf.kinematics.position_limit import position_limits
from eurdf.mechanism.joint_types import JointType
from eurdf.pinocchio.robot import build_robot
from eurdf.viewing.session import MotionStop, Session
from support.described import STRUT, load, strut
from support.plain_urdf import joint_element, link_element, robot


def index_of(session: Session, joint: str) -> int:
    return next(index for index, slider in enumerate(session.sliders) if slider.joint == joint)


def test_passive_joints_follow_on_the_branch() -> None:
    """In small steps and in one, a slider leads to the same configuration: that of forward kinematics."""
    robot = eurdf.load("stewart_platform")
    session = Session(robot)
    assert session.move(0, 0.4) is None
    once = session.q
    assert session.residual < 1e-12
    assert session.value(0) == pytest.approx(0.4, abs=1e-12)
    actuated = robot.actuation.idx_q
    expected = eurdf.forward_kinematics(robot, once[actuated], session.first)
    assert once == pytest.approx(expected, abs=1e-7)
    session.reset()
    for value in np.linspace(0.0, 0.4, 15):
        assert session.move(0, value) is None
    assert session.q == pytest.approx(once, abs=1e-7)


def test_other_actuators_stay() -> None:
    robot = eurdf.load("kangaroo_leg")
    session = Session(robot)
    length = index_of(session, "motor_leg_length")
    session.move(length, 0.05)
    others = [k for k in robot.actuation.idx_q if k != robot.tree.coordinate("motor_leg_length").idx_q]
    assert (session.q[others] == session.first[others]).all()
    assert session.residual < 1e-12


def test_slider_stops_at_its_limit() -> None:
    session = Session(eurdf.load("digit_leg"))
    knee = index_of(session, "motor_knee")
    upper = session.sliders[knee].upper
    stop = session.move(knee, upper + 1.0)
    assert stop == MotionStop("limit", "motor_knee", upper)
    assert session.value(knee) == pytest.approx(upper, abs=1e-12)
    assert session.residual < 1e-12


def test_slider_stops_at_limit_of_passive_joint() -> None:
    robot = eurdf.load("unitree_g1_ankle")
    session = Session(robot)
    stop = session.move(0, session.sliders[0].upper)
    assert stop is not None
    assert (stop.reason, stop.joint) == ("passive limit", "free_roll")
    roll = session.q[robot.tree.coordinate("free_roll").idx_q]
    assert roll == pytest.approx(stop.value, abs=1e-8)
    assert str(stop) == f"passive joint 'free_roll' is at its position limit {stop.value:.6g}"
    assert session.move(0, session.sliders[0].upper) == stop  # it stays there
    assert session.move(0, 0.0) is None  # and can go back
    assert session.residual < 1e-12


def without_limits(name: str) -> eurdf.Robot:
    """A robot of the collection whose joints have no position limits."""
    mechanism = eurdf.load(name, geometry=False).mechanism
    joints = [replace(joint, properties=replace(joint.properties, lower=(), upper=())) for joint in mechanism.joints]
    free = [replace(joint, type=JointType.CONTINUOUS) if joint.type == "revolute" else joint for joint in joints]
    return build_robot(replace(mechanism, joints=tuple(free)), geometry=False)


def test_pose_at_a_passive_limit_is_within_the_tolerance_of_files() -> None:
    session = Session(eurdf.load("kangaroo_leg", geometry=False))
    limits = position_limits(session.robot)
    stops = []
    for index, slider in enumerate(session.sliders):
        stops.append(session.move(index, slider.upper))
        values = session.q[limits.coordinates]
        beyond = np.maximum(values - limits.upper, limits.lower - values)
        assert beyond.max() < 1e-9  # which `eurdf check` allows
        session.show(session.first)
    assert sum(stop is not None and stop.reason == "passive limit" for stop in stops) >= 3


def test_passive_joint_is_at_its_limit_where_the_slider_stops() -> None:
    """On the way, a step ends beyond the limit by a part of the tolerance again and again."""
    session = Session(eurdf.load("tello", geometry=False))
    index = next(index for index, each in enumerate(session.sliders) if each.joint == "left_motor_hip_1")
    stop = session.move(index, session.sliders[index].upper)
    assert stop is not None
    assert (stop.reason, stop.joint) == ("passive limit", "left_free_hip_x")
    at = session.robot.joint_positions(session.q)["left_free_hip_x"][0]
    assert at == pytest.approx(stop.value, abs=2e-9)


def test_springs_press_passive_joints_against_their_limits() -> None:
    """The fingers of the gripper move parallel: the springs hold both couplers at their upper limit, 0."""
    robot = eurdf.load("robotiq_2f85", geometry=False)
    session = Session(robot)
    for goal in (0.4, 0.7, 0.4):
        assert session.move(0, goal) is None
        held = {"motor": goal, "left_coupler_joint": 0.0, "right_coupler_joint": 0.0}
        np.testing.assert_allclose(session.q, eurdf.forward_kinematics(robot, held), atol=1e-9)
        assert session.residual < 1e-12


def test_slider_stops_at_dead_point() -> None:
    """A five-bar linkage stretches out: the distance of the two elbows is then the sum of the two outer links."""
    session = Session(without_limits("five_bar"))
    stop = session.move(0, math.pi)
    assert stop is not None
    assert stop.reason == "dead point"
    assert session.residual < 1e-12
    at = session.value(0)
    assert stop.value == pytest.approx(at, abs=1e-9)
    # From there it does not go on, but back, to the same branch.
    session.move(0, math.pi)
    assert session.value(0) == pytest.approx(at, abs=0.01)
    assert session.move(0, 0.0) is None
    assert session.q == pytest.approx(session.first, abs=1e-6)


def test_full_turn_of_a_crank_returns() -> None:
    session = Session(eurdf.load("four_bar"))
    for value in (math.pi, 0.0, -math.pi, 0.0):
        assert session.move(0, value) is None
        assert abs(math.remainder(session.value(0) - value, 2.0 * math.pi)) < 1e-9
    assert session.q == pytest.approx(session.first, abs=1e-7)


def test_dependent_actuators_follow() -> None:
    """With both ends of a four-bar linkage actuated, neither moves with the other one held."""
    mechanism = eurdf.load("four_bar", geometry=False).mechanism
    passive = next(joint.name for joint in mechanism.joints if joint.name not in mechanism.actuators)
    both = replace(mechanism, actuators=("motor_crank", passive))
    session = Session(build_robot(both, geometry=False))
    assert session.analysis.dependent == 1
    assert session.sliders[0].follow == (passive,)
    assert session.move(0, 0.5) is None
    assert session.value(0) == pytest.approx(0.5, abs=1e-12)
    assert session.residual < 1e-12


def test_robot_that_cannot_close_is_moved_open() -> None:
    """Without closed loops a slider moves its joint alone, and the state says so."""
    robot = eurdf.load("four_bar")
    session = Session(robot)
    session.show(robot.tree.integrate(session.q, np.full(robot.tree.nv, 0.3)))
    assert not session.is_closed
    before = robot.joint_positions(session.q)
    assert session.move(0, session.value(0) + 0.2) is None
    after = robot.joint_positions(session.q)
    assert {name for name in after if after[name] != pytest.approx(before[name], abs=1e-12)} == {"motor_crank"}
    assert session.assemble().closes
    assert session.is_closed


def test_robot_without_actuators_has_sliders_for_its_joints() -> None:
    links = [link_element(name) for name in "abc"]
    turn = joint_element("turn", "revolute", "a", "b", '<limit lower="-1" upper="2" effort="1" velocity="1"/>')
    slide = joint_element("slide", "prismatic", "b", "c", '<limit lower="0" upper="0.5" effort="1" velocity="1"/>')
    session = Session(load(robot(*links, turn, slide)))
    assert [(slider.label, slider.unit, slider.lower, slider.upper) for slider in session.sliders] == [
        ("turn", "rad", -1.0, 2.0),
        ("slide", "m", 0.0, 0.5),
    ]
    assert session.move(1, 0.3) is None
    assert session.q == pytest.approx([0.0, 0.3])


def test_drag_brings_frame_to_target_with_loops_closed() -> None:
    robot = eurdf.load("digit_leg")
    session = Session(robot)
    q = eurdf.forward_kinematics(robot, session.q[robot.actuation.idx_q] + 0.1, session.q)
    foot = frames(robot, ["foot"], few=True)
    target = foot.poses(foot.at(q[None]))[1][0, 0]
    assert session.drag("foot", target) is None
    assert foot.poses(foot.at(session.q[None]))[1][0, 0] == pytest.approx(target, abs=2e-6)
    assert session.residual < 1e-9
    why = session.drag("foot", target + np.array((0.0, 0.0, 10.0)))
    assert why is not None
    assert "'foot' by" in why
    assert session.residual < 1e-9


def test_configuration_is_carried_to_changed_robot() -> None:
    session = Session(eurdf.load("digit_leg"))
    session.move(index_of(session, "motor_knee"), 0.3)
    other = eurdf.load("digit_leg", root="floating")
    q = session.carried_to(other)
    assert other.joint_positions(q)["motor_knee"] == pytest.approx((0.3,))
    assert np.abs(eurdf.residual(other, q)).max() < 1e-9


@pytest.mark.parametrize(
    ("kind", "units", "goals"),
    [
        ("planar", ["m", "m", "rad"], (0.2, -0.3, 0.7)),
        ("spherical", ["rad"] * 3, (0.3, -0.4, 0.9)),
        ("floating", ["m"] * 3 + ["rad"] * 3, (0.2, -0.3, 0.1, 0.3, -0.4, 0.9)),
    ],
)
def test_sliders_of_a_pose_move_the_passive_joints(kind: str, units: list[str], goals: tuple[float, ...]) -> None:
    """The length of a strut to the body is that of the pose the sliders show."""
    moved = strut(kind)
    session = Session(moved)
    assert [slider.unit for slider in session.sliders] == units
    for index, goal in enumerate(goals):
        assert session.move(index, goal) is None
        assert session.residual < 1e-12
    assert [session.value(index) for index in range(len(goals))] == pytest.approx(goals, abs=1e-8)
    if kind == "planar":
        tip = np.array((goals[0] + math.cos(goals[2]), goals[1] + math.sin(goals[2]), 0.0))
    else:
        tip = pin.exp3(np.array(goals[-3:])) @ (1.0, 0.0, 0.0) + np.array((*goals[:-3], 0.0, 0.0, 0.0)[:3])
    length = np.linalg.norm(tip - (1.0, 0.0, -1.0))
    assert moved.joint_positions(session.q)["slide"] == pytest.approx((length - STRUT,), abs=1e-8)


def test_slider_of_a_pose_stops_at_limit_of_passive_joint() -> None:
    """The strut is 1.3 m long where sin a + cos a = 1.5 - 1.3² / 2, turned about y by a."""
    session = Session(strut("spherical", reach=0.3))
    session.move(0, 0.2)
    session.move(0, 0.0)
    stop = session.move(1, -2.0)
    assert stop is not None
    assert (stop.reason, stop.joint, stop.value) == ("passive limit", "slide", 0.3)
    angle = session.value(1)
    assert math.sin(angle) + math.cos(angle) == pytest.approx(1.5 - 1.3**2 / 2.0, abs=1e-5)
    assert [session.value(0), session.value(2)] == pytest.approx([0.0, 0.0], abs=1e-8)
    assert session.residual < 1e-12
    assert session.move(1, 0.0) is None


def test_rotation_vector_is_at_most_half_a_turn() -> None:
    ball = joint_element("ball", "continuous", "a", "b", '<axis xyz="0 0 1"/>')
    urdf = robot(link_element("a"), link_element("b"), ball)
    session = Session(load(urdf, "joints:\n  ball: spherical\nactuators: [ball]\n"))
    assert session.move(0, 2.0) is None
    stop = session.move(2, -3.0)
    assert stop is not None
    assert stop.reason == "half turn"
    assert [session.value(index) for index in range(3)] == pytest.approx([2.0, 0.0, stop.value], abs=1e-5)
    assert math.hypot(2.0, stop.value) == pytest.approx(math.pi, abs=1e-5)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_value_that_is_no_number_is_refused(value: float) -> None:
    session = Session(eurdf.load("four_bar"))
    with pytest.raises(ValueError, match="motor_crank"):
        session.move(0, value)
    assert (session.q == session.first).all()
