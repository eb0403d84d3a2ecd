"""Robots against what their makers published: constraints, poses, ratios and lengths."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.pinocchio.frames import body_frame_ids

#: Angles of Tello's own in the pose that is drawn, where they are not 0 (rad).
HIP_CRANK, ANKLE_CRANK = 0.15685349478899657, -4.583900721089e-05


def hip(y: complex, roll: complex, pitch: complex, side: float) -> complex:
    """Constraint of a hip motor as ``derive_tello_hip_differential.m`` of generalized_rbda 45fa7c4 has it, m²."""
    s, c = cmath.sin, cmath.cos
    return (
        57 / 2500 * s(y)
        - 49 / 5000 * c(roll)
        - side * 399 / 20000 * s(roll)
        - 8 / 625 * c(y) * c(pitch)
        - 57 / 2500 * c(roll) * s(pitch)
        - side * 7 / 625 * s(y) * s(roll)
        + side * 7 / 625 * s(roll) * s(pitch)
        - 8 / 625 * c(roll) * s(y) * s(pitch)
        + 3021 / 160000
    )


def ankle(crank: complex, ankle: complex) -> complex:
    """That of the ankle as ``derive_tello_knee_ankle_differential.m`` has it, m²; half the difference is -crank."""
    s, c, pi = cmath.sin, cmath.cos, math.pi
    return (
        21 / 6250 * c(-crank + 1979 * pi / 4500)
        - 13 / 625 * c(-crank + 493 * pi / 1500)
        - 273 / 12500 * c(pi / 9)
        - 7 / 2500 * s(-crank + ankle + 231 * pi / 500)
        + 91 / 5000 * s(ankle + 2 * pi / 15)
        - 147 / 50000 * s(ankle + pi / 45)
        + 163349 / 6250000
    )


def derivative(function: Callable[..., complex], *at: float) -> list[float]:
    """The partial derivatives, by complex steps: exact to the last bits."""
    step = 1e-30
    return [function(*(x + 1j * step * (n == k) for n, x in enumerate(at))).imag / step for k in range(len(at))]


def test_constraints_are_those_of_the_derivation_at_any_pose() -> None:
    robot = eurdf.load("tello", root="fixed", geometry=False)
    at = robot.slots
    rows = {constraint.name: row for row, constraint in enumerate(robot.constraints)}
    random = np.random.default_rng(11)
    for _ in range(5):
        values = {name: [random.uniform(-0.8, 0.8)] for name in at}
        q = robot.configuration(values)
        r, K = eurdf.residual_and_jacobian(robot, q)
        angle = {name: value for name, (value,) in values.items()}
        expected = {
            f"left_hip_rod_{number}": (
                lambda y, roll, pitch, side=side: hip(y + HIP_CRANK, roll, pitch, side),
                (f"left_motor_hip_{number}", "left_free_hip_x", "left_free_hip_y"),
                0.155,
            )
            for number, side in ((1, 1.0), (2, -1.0))
        } | {
            "left_ankle_rod": (
                lambda crank, foot: ankle(crank + ANKLE_CRANK, foot),
                ("left_free_crank", "left_free_ankle"),
                0.2146,
            )
        }
        for name, (function, joints, length) in expected.items():
            row, coordinates = rows[name], [angle[joint] for joint in joints]
            distance = r[row] + length
            np.testing.assert_allclose(distance**2 - length**2, function(*coordinates).real, atol=1e-14)
            gradient = np.zeros(robot.model.nv)
            gradient[[at[joint].idx_v for joint in joints]] = derivative(function, *coordinates)
            np.testing.assert_allclose(2.0 * distance * K[row], gradient, atol=1e-14)


def test_knee_is_the_mean_of_its_motors() -> None:
    robot = eurdf.load("tello", geometry=False)
    for name in ("bent", "wide"):
        q = robot.configurations[name]
        angle = {joint: q[slot.idx_q] for joint, slot in robot.slots.items()}
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        for side in ("left", "right"):
            one, two = (angle[f"{side}_motor_knee_{number}"] for number in (1, 2))
            np.testing.assert_allclose(angle[f"{side}_free_knee"], (one + two) / 2, atol=1e-14)
            np.testing.assert_allclose(angle[f"{side}_free_crank"], (two - one) / 2, atol=1e-14)


# -- The corner of a car: what its springs decide, and how the wheel moves


def test_wheel_leans_and_steers_as_the_page_says() -> None:
    robot = eurdf.load("double_wishbone", geometry=False)
    wheel, drawn = robot.model.getFrameId("wheel_center"), 0.31
    for name, up, lean, turn in (("bump", 105, 4.1, -1.0), ("droop", -106, -1.9, 0.4), ("left_turn", -4, -2.7, 31.8)):
        q = robot.configurations[name]
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        pin.framesForwardKinematics(robot.model, robot.data, q)
        pose = robot.data.oMf[wheel]
        R = pose.rotation
        assert (pose.translation[2] - drawn) * 1e3 == pytest.approx(up, abs=0.6)
        angles = np.degrees((np.arcsin(R[2, 1]), np.arctan2(R[1, 0], R[0, 0])))
        np.testing.assert_allclose(angles, (lean, turn), atol=0.06)


def test_hanging_wheel_drops_until_the_spring_is_at_rest() -> None:
    robot = eurdf.load("double_wishbone", geometry=False)
    q = eurdf.forward_kinematics(robot, {"motor_rack": 0.0})
    assert robot.joint_positions(q)["spring_strut"] == pytest.approx((0.075,))
    assert np.abs(eurdf.residual(robot, q)).max() < 1e-12


# -- Five-bar robots: their named configurations against plane geometry


@pytest.mark.parametrize(
    ("name", "length", "swing"),
    [
        ("assembled", 0.17, 0.0),
        ("retracted", 0.08, 0.0),
        ("extended", 0.25, 0.0),
        ("step", 0.17, 0.4),
        ("upside_down", 0.17, np.pi),
    ],
)
def test_foot_of_doggo_is_where_its_page_says(name: str, length: float, swing: float) -> None:
    robot = eurdf.load("doggo_leg", geometry=False)
    q = robot.configurations[name]
    assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
    pin.framesForwardKinematics(robot.model, robot.data, q)
    foot = robot.data.oMf[robot.model.getFrameId("foot")].translation
    np.testing.assert_allclose(foot, length * np.array([np.sin(swing), 0.0, -np.cos(swing)]), atol=1e-12)


def test_dextar_has_its_tip_at_one_point_in_four_working_modes() -> None:
    robot = eurdf.load("dextar", geometry=False)
    found = {}
    for name in ("assembled", "elbows_in", "elbows_left", "elbows_right"):
        q = robot.configurations[name]
        assert np.abs(eurdf.residual(robot, q)).max() < 1e-12
        pin.framesForwardKinematics(robot.model, robot.data, q)
        tip = robot.data.oMf[robot.model.getFrameId("tool_tip")].translation
        np.testing.assert_allclose(tip, (0.0, 0.12, 0.05), atol=1e-12)
        links = (robot.data.oMf[robot.model.getFrameId(f"distal_{leg}")].rotation for leg in (1, 2))
        found[name] = tuple(round(float(np.arctan2(R[1, 0], R[0, 0])), 6) for R in links)
    assert found["elbows_left"] == (found["assembled"][0], found["elbows_in"][1])
    assert found["elbows_right"] == (found["elbows_in"][0], found["assembled"][1])
    assert len(set(found.values())) == 4


# -- Reachy Mini: the pose of its head


#: Angles of the body and of the six cranks, rad, and the pose of the head: those at which the published model
#: (mjcf/reachy_mini.xml of pollen-robotics/reachy_mini 70a7c0b) is closed to 1e-13 m, found by SciPy with MuJoCo.
PUBLISHED = [
    ((0.0, 0.3, -0.3, 0.3, -0.3, 0.3, -0.3), (0.0, 0.0, 0.1624160521), np.eye(3)),
    (
        (0.5, 0.5, -0.2, 0.1, -0.4, 0.2, 0.3),
        (-0.012439776, 0.020114699, 0.152479336),
        [
            [0.725902087, -0.52668705, 0.442342528],
            [0.665035007, 0.701555833, -0.256023148],
            [-0.175483904, 0.480021003, 0.859526169],
        ],
    ),
]


@pytest.mark.parametrize(("angles", "position", "rotation"), PUBLISHED, ids=["lifted", "turned"])
def test_head_is_where_the_published_model_has_it(
    angles: tuple[float, ...], position: tuple[float, ...], rotation: np.ndarray
) -> None:
    robot = eurdf.load("reachy_mini", geometry=False)
    motors = dict(zip(["yaw_body", *(f"motor_{crank}" for crank in range(1, 7))], angles, strict=True))
    q = eurdf.forward_kinematics(robot, motors | {"left_antenna": 0.0, "right_antenna": 0.0})
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    head = data.oMf[robot.model.getFrameId("head_middle")]
    # The published figures are rounded to 6 digits.
    np.testing.assert_allclose(head.translation, position, atol=5e-6)
    np.testing.assert_allclose(head.rotation, rotation, atol=5e-5)


# -- The gripper against an import of the joints of its source


def finger(side: str, turn: str) -> str:
    """The joints of a finger, as robotiq_2f85/2f85.xml of MuJoCo Menagerie ec98278 has them."""
    y = 0.0306011 if side == "right" else -0.0306011
    z = 0.0132 if side == "right" else -0.0132
    mass = '<inertial mass="0.01" pos="0 0 0" diaginertia="1e-6 1e-6 1e-6"/>'
    return f"""
      <body name="{side}_driver" pos="0 {y} 0.054904" {turn}>{mass}
        <joint name="{side}_driver_joint" axis="1 0 0" range="0 0.8"/>
        <body name="{side}_coupler" pos="0 0.0315 -0.0041">{mass}
          <joint name="{side}_coupler_joint" axis="1 0 0" range="-1.57 0"/>
        </body>
      </body>
      <body name="{side}_spring_link" pos="0 {z} 0.0609" {turn}>{mass}
        <joint name="{side}_spring_link_joint" axis="1 0 0" range="-0.297 0.8"/>
        <body name="{side}_follower" pos="0 0.055 0.0375">{mass}
          <joint name="{side}_follower_joint" axis="1 0 0" pos="0 -0.018 0.0065" range="-0.872664 0.872664"/>
          <body name="{side}_pad" pos="0 -0.0189 0.01352">{mass}</body>
        </body>
      </body>"""


SOURCE = f"""
<mujoco model="source">
  <compiler angle="radian" autolimits="true"/>
  <worldbody>
    <body name="base">{finger("right", "")}{finger("left", 'quat="0 0 0 1"')}</body>
  </worldbody>
  <equality>
    <connect anchor="0 0 0" body1="right_follower" body2="right_coupler"/>
    <connect anchor="0 0 0" body1="left_follower" body2="left_coupler"/>
    <joint joint1="right_driver_joint" joint2="left_driver_joint" polycoef="0 1 0 0 0"/>
  </equality>
  <actuator><motor joint="left_driver_joint"/></actuator>
</mujoco>"""


@pytest.mark.slow
def test_pads_move_as_in_the_source(tmp_path: Path) -> None:
    (tmp_path / "source.xml").write_text(SOURCE)
    theirs = eurdf.import_robot(tmp_path / "source.xml").write(tmp_path / "there")
    source, ours = eurdf.load(Path(theirs[0]).parent), eurdf.load("robotiq_2f85")
    assert eurdf.analyze(source).mobility == eurdf.analyze(ours).mobility == 3
    half_turn = pin.SE3(pin.utils.rotate("z", np.pi), np.zeros(3))  # the drawing sees the base from the other side
    for name in ("assembled", "closed", "enveloping"):
        q = ours.configurations[name]
        values = {joint: angle for joint, angle in ours.joint_positions(q).items() if joint != "motor"}
        there = source.configuration(values)
        assert np.abs(eurdf.residual(source, there)).max() < 1e-9
        pin.framesForwardKinematics(source.model, source.data, there)
        pin.framesForwardKinematics(ours.model, ours.data, q)
        for side in ("left", "right"):
            pad = half_turn * source.data.oMf[source.model.getFrameId(f"{side}_pad")]
            expected = pad.act(np.array([0.0, -0.0066, 0.01875]))
            found = ours.data.oMf[ours.model.getFrameId(f"{side}_pad")].translation
            np.testing.assert_allclose(found, expected, atol=1e-9)


# -- ToddlerBot's gears, differential and parallelograms


def test_motors_turn_joints_by_the_published_ratios() -> None:
    robot = eurdf.load("toddlerbot_2legs", root="fixed", geometry=False)
    random = np.random.default_rng(7)
    for _ in range(3):
        motors = {name: random.uniform(-0.5, 0.5) for name in robot.actuation.joints}
        motors |= {f"{side}_knee_act": random.uniform(-1.9, -0.1) for side in ("left", "right")}
        q = eurdf.forward_kinematics(robot, motors)
        at = {name: values[0] for name, values in robot.joint_positions(q).items()}
        # Ratios of config.json and toddlerbot.xml of hshi74/toddlerbot 62cee1b.
        one, two = motors["waist_act_1"], motors["waist_act_2"]
        expected = {
            "neck_yaw_driven": -0.909091 * motors["neck_yaw_drive"],
            "neck_pitch": motors["neck_pitch_act"],
            "waist_roll": -0.29166667 * (one - two),
            "waist_yaw": 0.20833333 * (one + two),
        }
        for side in ("left", "right"):
            expected[f"{side}_hip_yaw_driven"] = -0.857143 * motors[f"{side}_hip_yaw_drive"]
            expected[f"{side}_knee"] = motors[f"{side}_knee_act"]
        assert {name: at[name] for name in expected} == pytest.approx(expected, abs=1e-6)


# -- Unitree's G1: the linkage of its waist as measured, and the serial robot that stands for it


ANKLES = [(f"{side}_ankle_pitch_joint", f"{side}_ankle_roll_joint") for side in ("left", "right")]
WAIST = ("waist_roll_joint", "waist_pitch_joint")


@pytest.fixture(scope="module")
def g1() -> eurdf.Robot:
    return eurdf.load("unitree_g1", geometry=False)


def places(robot: eurdf.Robot, q: np.ndarray) -> dict[str, np.ndarray]:
    """Pose (4, 4) of each body in the world at q (nq,), by name."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return {name: data.oMf[frame].homogeneous for name, frame in body_frame_ids(robot.mechanism).items()}


def test_waist_has_the_lengths_of_the_published_parts(g1: eurdf.Robot) -> None:
    at = places(g1, g1.configurations["assembled"])
    for side in ("left", "right"):
        rod, ball, crank = (at[f"{side}_waist_{name}"][:3, 3] for name in ("rod", "rod_b", "crank"))
        assert math.dist(rod, ball) == pytest.approx(0.050, abs=5e-6)
        assert math.dist(ball[1:], crank[1:]) == pytest.approx(0.024, abs=5e-6)  # across the axis of the motor


def test_motors_reach_the_ends_of_pitch_and_roll(g1: eurdf.Robot) -> None:
    waist = eurdf.transmissions.prepare_transmission(g1, WAIST)
    stops = [g1.model.upperPositionLimit[g1.slots[f"{side}_waist_joint"].idx_q] for side in ("left", "right")]
    for pose in ((0.52, 0.0), (-0.52, 0.0), (0.0, 0.52), (0.0, -0.52)):
        assert (np.abs(waist.at_joints(pose).positions) < stops).all(), pose


@pytest.mark.slow
def test_serial_twin_has_the_poses_of_the_robot(g1: eurdf.Robot) -> None:
    twin = g1
    for joints in (WAIST, *ANKLES):
        twin = eurdf.transmissions.serial_twin(twin, joints, limits="fitted", grid=5).robot
    assert twin.constraints == ()
    assert len(twin.actuation.joints) == twin.model.nv - 6 == 29
    random = np.random.default_rng(5)
    for _ in range(5):
        serial = {name: [random.uniform(-0.15, 0.15)] for name in twin.actuation.joints}
        closed = eurdf.assemble(g1, g1.configuration(serial), hold=tuple(serial))
        assert closed.converged
        own = places(g1, closed.q)
        for body, pose in places(twin, twin.configuration(serial)).items():
            assert own[body] == pytest.approx(pose, abs=1e-9), body
