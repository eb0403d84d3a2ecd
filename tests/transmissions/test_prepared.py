"""The transmission prepared for control loops, in Python and in generated C."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.pinocchio.robot import build_robot
from support.compiled import NOT_CLOSED, NOT_FINITE, OK, SINGULAR, TOO_FAR, Compiled
from support.mechanisms import one_loop
from support.transmissions import DRIVEN, OF_TWO_JOINTS, with_properties

ANKLE = ("free_pitch", "free_roll")
FAST = ("unitree_g1_ankle", "digit_leg")


def loop(*types: str, closure: str, seed: int, slow: bool = True, **options: bool) -> Any:
    title = ", ".join((*types, *options)) + f" in {closure}"
    return pytest.param((types, closure, seed, options), id=title, marks=[pytest.mark.slow] if slow else [])


@pytest.mark.parametrize(
    "described",
    [
        loop("revolute", "helical", "planar", "cylindrical", closure="6d", seed=1, slow=False),
        loop("continuous", "prismatic", "spherical", "universal", closure="6d", seed=16),
        loop("revolute", "continuous", "spherical", "revolute", closure="hinge", seed=3, slow=False),
        loop("universal", "revolute", "revolute", "revolute", closure="3d", seed=4),
        loop("cylindrical", "revolute", "revolute", "prismatic", closure="3d", seed=14),
        loop("revolute", "revolute", closure="distance", seed=6, slow=False),
        loop("revolute", "revolute", "floating", closure="6d", seed=7, coupled=True),
        loop("revolute", "revolute", "spherical", "universal", closure="6d", seed=23, follower=True),
    ],
)
def test_every_joint_and_constraint_agrees_with_c(described: Any, tmp_path: Path) -> None:
    types, closure, seed, options = described
    robot = one_loop(types, closure, seed, **options)
    slot = robot.slots["j0"]
    start = np.array(robot.mechanism.configurations["assembled"]["j0"])
    ranges = dict(zip(eurdf.transmission(robot, "j0").joints, np.stack((start - 0.05, start + 0.05), 1), strict=True))
    prepared = eurdf.transmissions.prepare_transmission(robot, ["j0"], ranges=ranges)
    compiled = Compiled(prepared, tmp_path)
    along = np.array([0.03, -0.02])[: slot.nv]
    for k in range(40):
        point = start + np.sin(0.1 * k) * along
        motors, G = prepared.at_joints(point)
        assert np.abs(eurdf.residual(robot, prepared.q)).max() < 1e-11
        status, c_motors, c_G = compiled.at_joints(point)
        assert (status, c_motors) == (OK, pytest.approx(motors, abs=1e-9))
        assert c_G == pytest.approx(G, abs=1e-9, rel=1e-9)
        h = 1e-6
        for column, unit in enumerate(h * np.eye(slot.nv)):
            ahead, behind = prepared.at_joints(point + unit).positions, prepared.at_joints(point - unit).positions
            assert G[:, column] == pytest.approx((ahead - behind) / (2.0 * h), rel=1e-5, abs=1e-6)


def test_long_motions_follow_the_path() -> None:
    robot = eurdf.load("unitree_g1_ankle", geometry=False)
    prepared = eurdf.transmissions.prepare_transmission(robot, ANKLE)
    far = prepared.at_joints([-0.8, 0.02]).positions
    near = eurdf.transmissions.prepare_transmission(robot, ANKLE)
    for pitch in np.linspace(0.0, -0.8, 81):
        found = near.at_joints([pitch, 0.02]).positions
    assert far == pytest.approx(found, abs=1e-9)
    joints, B = near.at_motors(found)
    assert joints == pytest.approx([-0.8, 0.02], abs=1e-9)
    assert pytest.approx(np.eye(2), abs=1e-9) == B @ near.at_joints(joints)[1]


def status_in_python(call: Callable[[Any], object], positions: Any) -> int:
    """The status of C that stands for what a call raises."""
    try:
        call(positions)
    except eurdf.errors.TooFar:
        return TOO_FAR
    except eurdf.errors.NotClosable:
        return NOT_CLOSED
    except eurdf.errors.NoTransmission:
        return SINGULAR
    return OK


def beyond_limits(robot: eurdf.Robot, names: Sequence[str], count: int) -> Any:
    """Random positions of joints within their limits, at most 1.5 (rad, m) to each side, and 15 % beyond."""
    ends = []
    for name in names:
        properties = robot.slots[name].joint.properties
        (lower,), (upper,) = properties.lower or (-1.5,), properties.upper or (1.5,)
        lower, upper = max(lower, -1.5), min(upper, 1.5)
        ends.append((lower - 0.15 * (upper - lower), upper + 0.15 * (upper - lower)))
    return np.random.default_rng(1).uniform(*np.transpose(ends), (count, len(names)))


@pytest.mark.parametrize(
    ("name", "joints", "statuses"),
    [
        ("slider_crank", ("free_slider",), {OK, NOT_CLOSED}),
        ("unitree_g1_ankle", ANKLE, {OK, NOT_CLOSED}),
        ("tesla_optimus_ankle", ANKLE, {OK, NOT_CLOSED}),
        ("talos_leg", DRIVEN["talos_leg"], {OK}),
        ("digit_leg", DRIVEN["digit_leg"], {OK, NOT_CLOSED}),
        pytest.param("kangaroo_leg", DRIVEN["kangaroo_leg"], {OK, NOT_CLOSED}, marks=pytest.mark.slow),
    ],
)
def test_statuses_in_c_are_errors_in_python(
    name: str, joints: tuple[str, ...], statuses: set[int], tmp_path: Path
) -> None:
    robot = eurdf.load(name, geometry=False)
    prepared = eurdf.transmissions.prepare_transmission(robot, joints)
    compiled = Compiled(prepared, tmp_path)
    found = set()
    for side, start, at, c_start, c_at in (
        ("joints", prepared.start_at_joints, prepared.at_joints, compiled.start_at_joints, compiled.at_joints),
        ("motors", prepared.start_at_motors, prepared.at_motors, compiled.start_at_motors, compiled.at_motors),
    ):
        for positions in beyond_limits(robot, getattr(prepared, side), 40):
            kept, c_kept = prepared.q, compiled.pose.copy()
            status = c_start(positions)
            assert status == status_in_python(start, positions), (side, positions.tolist())
            found.add(status)
            if status != OK:
                assert np.array_equal(prepared.q, kept)
                assert np.array_equal(compiled.pose, c_kept)
                compiled.start()
                assert c_at(positions)[0] == TOO_FAR
                continue
            assert np.abs(eurdf.residual(robot, prepared.q)).max() < 1e-9
            status, values, derivative = c_at(positions)
            expected = at(positions)
            assert (status, values) == (OK, pytest.approx(expected[0], abs=1e-9))
            assert derivative == pytest.approx(expected[1], rel=1e-6, abs=1e-6)
            compiled.start()
            status, values, _ = c_at(positions)
            assert status == TOO_FAR or (status, values) == (OK, pytest.approx(expected[0], abs=1e-6))
    assert statuses <= found


@pytest.mark.parametrize(
    ("name", "joints"),
    [
        pytest.param(*case, marks=[] if case[0] in ("unitree_g1_ankle", "digit_leg") else pytest.mark.slow)
        for case in OF_TWO_JOINTS
    ],
)
def test_a_call_in_the_workspace_has_no_history(name: str, joints: tuple[str, ...], tmp_path: Path) -> None:
    robot = eurdf.load(name, geometry=False)
    space = eurdf.transmissions.workspace(robot, joints, grid=9)
    motors = space.selections[1]
    poses = np.concatenate((space.q, [point.q for point in space.boundary]))
    positions = np.concatenate((space.positions, [point.position for point in space.boundary]))
    prepared = eurdf.transmissions.prepare_transmission(robot, joints)
    double, single = (Compiled(prepared, tmp_path, real=real, substeps=1) for real in ("double", "float"))
    for k in np.random.default_rng(0).permutation(len(poses)):
        by_joints, r = prepared.at_joints(positions[k]), eurdf.residual(robot, prepared.q)
        by_motors = prepared.at_motors(by_joints.positions)
        assert np.abs([r, eurdf.residual(robot, prepared.q)]).max() < 1e-9
        assert by_joints.positions == pytest.approx(motors.read(poses[k]), abs=1e-7)
        assert by_motors.positions == pytest.approx(positions[k], abs=1e-9)
        G, B = eurdf.transmission(robot, joints, prepared.q).G, by_motors.B
        assert pytest.approx(by_joints.G, rel=1e-6, abs=1e-8) == G
        for compiled, exact, derivative in ((double, 1e-9, 1e-7), (single, 2e-5, 1e-3)):
            of_joints = positions[k], compiled.all_at_joints, compiled.start_at_joints, by_joints.positions, G, B
            of_motors = by_joints.positions, compiled.all_at_motors, compiled.start_at_motors, positions[k], B, G
            for given, at, start_at, expected, D, inverse in (of_joints, of_motors):
                compiled.pose[:] = np.nan
                status, found, c_D, c_inverse = at(given)
                assert (status, found) == (OK, pytest.approx(expected, abs=exact))
                assert c_D == pytest.approx(D, rel=derivative, abs=derivative)
                assert c_inverse == pytest.approx(inverse, rel=derivative, abs=derivative)
                assert start_at(given) == OK


@pytest.mark.slow
def test_three_joints_start_at_the_nearest_stored_pose(tmp_path: Path) -> None:
    name, robot = "kangaroo_leg", eurdf.load("kangaroo_leg", geometry=False)
    space = eurdf.transmissions.workspace(robot, DRIVEN[name], grid=5)
    prepared = eurdf.transmissions.prepare_transmission(robot, DRIVEN[name])
    compiled = Compiled(prepared, tmp_path)
    for k in np.random.default_rng(0).permutation(len(space.q)):
        motors = space.selections[1].read(space.q[k])
        assert prepared.at_joints(space.positions[k]).positions == pytest.approx(motors, abs=1e-7)
        for at, given, expected in (
            (compiled.at_joints, space.positions[k], motors),
            (compiled.at_motors, motors, space.positions[k]),
        ):
            compiled.pose[:] = np.nan
            status, found, _ = at(given)
            assert (status, found) == (OK, pytest.approx(expected, abs=1e-7))


def test_a_reset_changes_the_branch() -> None:
    robot = eurdf.load("four_bar", geometry=False)
    prepared = eurdf.transmissions.prepare_transmission(
        robot, "free_rocker", {"free_rocker": -0.4, "motor_crank": -1.0}
    )
    here = prepared.at_joints([-0.4])
    prepared.reset(eurdf.forward_kinematics(robot, {"motor_crank": 2.5}))
    there = prepared.at_joints([-0.4])
    assert np.abs(eurdf.residual(robot, prepared.q)).max() < 1e-10
    assert np.sign(there.G) == -np.sign(here.G)
    for position in (-0.7, -0.1, -0.4):
        assert np.sign(prepared.at_joints([position]).G) == np.sign(there.G)


def test_redundant_rows_may_contradict_by_rounding(tmp_path: Path) -> None:
    mechanism, random = eurdf.load("bennett", geometry=False).mechanism, np.random.default_rng(0)
    joints = [
        replace(
            joint, placement=replace(joint.placement, xyz=tuple(joint.placement.xyz + random.uniform(-2e-8, 2e-8, 3)))
        )
        for joint in mechanism.joints
    ]
    robot = build_robot(replace(mechanism, joints=tuple(joints)), geometry=False)
    assert eurdf.assemble(robot).reason == "rounding"
    prepared = eurdf.transmissions.prepare_transmission(robot, "free_b")
    compiled = Compiled(prepared, tmp_path)
    for angle in (0.1, 1.0, 2.0):
        status, motor, _ = compiled.at_joints(np.array([angle]))
        assert (status, motor) == (OK, pytest.approx(prepared.at_joints([angle]).positions, abs=1e-9))


def test_an_error_keeps_the_pose(tmp_path: Path) -> None:
    robot = eurdf.load("slider_crank", geometry=False)
    prepared = eurdf.transmissions.prepare_transmission(robot, ["free_slider"])
    compiled = Compiled(prepared, tmp_path)
    q, pose = prepared.q, compiled.pose.copy()
    with pytest.raises(eurdf.errors.NotClosable, match="cannot be closed at free_slider 5: closures stay open"):
        prepared.at_joints([5.0])
    with pytest.raises(ValueError, match="not finite"):
        prepared.at_joints([np.nan])
    with pytest.raises(ValueError, match="not finite"):
        prepared.start_at_joints([np.nan])
    assert np.array_equal(prepared.q, q)
    assert compiled.at_joints(np.array([5.0]))[0] == TOO_FAR
    assert compiled.at_joints(np.array([np.nan]))[0] == NOT_FINITE
    assert compiled.start_at_joints(np.array([5.0])) == NOT_CLOSED
    assert compiled.start_at_joints(np.array([np.nan])) == NOT_FINITE
    assert np.array_equal(compiled.pose, pose)


def test_turns_of_a_motor_are_counted(tmp_path: Path) -> None:
    robot = eurdf.load("bennett", geometry=False)
    prepared = eurdf.transmissions.prepare_transmission(robot, ["free_b"])
    compiled = Compiled(prepared, tmp_path)
    start = prepared.at_joints([0.0]).positions
    for angle in np.linspace(0.0, 4.0 * np.pi, 200):
        motor, G = prepared.at_joints([angle])
        status, c_motor, _ = compiled.at_joints(np.array([angle]))
        assert (status, c_motor) == (OK, pytest.approx(motor, abs=1e-9))
    assert motor - start == pytest.approx(np.sign(G[0]) * 4.0 * np.pi, abs=1e-9)
    prepared.start_at_motors([7.0])
    assert compiled.start_at_motors(np.array([7.0])) == OK
    joint = prepared.at_motors([7.0]).positions
    assert compiled.at_motors(np.array([7.0]))[1] == pytest.approx(joint, abs=1e-9)
    assert prepared.at_joints(joint).positions == pytest.approx([7.0], abs=1e-9)
    assert compiled.at_joints(joint)[1] == pytest.approx([7.0], abs=1e-9)


def test_one_substep_refuses_long_motions(tmp_path: Path) -> None:
    prepared = eurdf.transmissions.prepare_transmission(eurdf.load("bennett", geometry=False), "free_b")
    goal = prepared.at_motors([0.0]).positions + 1.0
    assert Compiled(prepared, tmp_path).at_joints(goal)[0] == OK
    compiled = Compiled(prepared, tmp_path, substeps=1)
    assert compiled.at_joints(goal)[0] == TOO_FAR
    assert compiled.at_joints(goal - 0.9)[0] == OK
    assert compiled.start_at_joints(goal) == OK
    with pytest.raises(ValueError, match="substeps is 0; it must be a positive integer"):
        prepared.c_source(substeps=0)
    with pytest.raises(ValueError, match="real is 'half'; it must be 'double' or 'float'"):
        prepared.c_source(real="half")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="ranges has 'free_c', which is none of the joints"):
        eurdf.transmissions.prepare_transmission("bennett", "free_b", ranges={"free_c": (-1.0, 1.0)})


@pytest.mark.parametrize(
    ("name", "joints", "message"),
    [
        (
            "unitree_g1_ankle",
            ["free_pitch"],
            "do not determine the motors: .* add 'free_roll' to the joints",
        ),
        ("unitree_g1_ankle", ["free_pich"], "did you mean 'free_pitch'"),
        ("unitree_g1_ankle", ["motor_a", "motor_b", "free_pitch"], "cannot move independently"),
        ("digit_leg", ["ball_rod1_end"], "is spherical"),
        ("unitree_g1_ankle", [], "empty"),
    ],
)
def test_joints_that_do_not_fit_are_named(name: str, joints: list[str], message: str) -> None:
    robot = eurdf.load(name, geometry=False)
    with pytest.raises(ValueError, match=message):
        eurdf.transmissions.prepare_transmission(robot, joints)


def test_motors_in_the_chain_are_their_own() -> None:
    robot = eurdf.load("talos_leg", geometry=False)
    prepared = eurdf.transmissions.prepare_transmission(robot, ["motor_knee", "free_ankle"])
    motors, G = prepared.at_joints([0.4, 0.1])
    assert prepared.motors[0] == "motor_knee"
    assert (motors[0], G[0].tolist()) == (0.4, [1.0, 0.0])


def test_springs_that_no_motor_controls_are_held(tmp_path: Path) -> None:
    robot = one_loop(["revolute"] * 5, "3d", 31)
    robot = with_properties(robot, {"j4": {"stiffness": (10.0,), "rest": (0.0,)}})
    prepared = eurdf.transmissions.prepare_transmission(robot, "j0")
    compiled = Compiled(prepared, tmp_path)
    at = robot.slots["j4"].idx_q
    start, deflection = prepared.at_joints(robot.mechanism.configurations["assembled"]["j0"]), prepared.q[at]
    for step in range(20):
        point = np.array(robot.mechanism.configurations["assembled"]["j0"]) + 0.005 * step
        motors, G = prepared.at_joints(point)
        assert prepared.q[at] == pytest.approx(deflection, abs=1e-12)
        assert pytest.approx(eurdf.transmission(robot, "j0", prepared.q).G, abs=1e-9) == G
        status, c_motors, c_G = compiled.at_joints(point)
        assert (status, c_motors) == (OK, pytest.approx(motors, abs=1e-9))
        assert c_G == pytest.approx(G, abs=1e-9)
    assert abs(motors - start.positions) > 1e-3
