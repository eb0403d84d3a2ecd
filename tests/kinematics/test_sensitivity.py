"""Velocities of the closed mechanism that give a frame a twist, and stay bounded where it is singular."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.residual import residual_and_jacobian
from support.actuated import actuated, closed_near, robot_called
from support.linkage import Linkage, chain, n_bar, translation


def arm(count: int = 2) -> Any:
    """A planar arm along x at zero, of bars of 1 m, with a motor at each joint and a frame at its end."""
    return actuated(Linkage(chain(*[1.0] * count)), [f"j{index}" for index in range(count)])


def five_bar(motors: list[str]) -> Any:
    linkage = n_bar(5)
    linkage.model.addFrame(pin.Frame("end", 2, 0, translation(0.3, 0.1, 0.0), pin.FrameType.OP_FRAME))
    return actuated(linkage, motors)


def twist_by_differences(robot: Any, q: Any, v: Any, frame: str, reference: Any, step: float = 1e-6) -> Any:
    """Twist of the frame from its poses a moment before and after, both closed."""
    model, index = robot.model, robot.model.getFrameId(frame)
    poses = []
    for time in (-step, step, 0.0):
        data = model.createData()
        pin.framesForwardKinematics(model, data, assemble(robot, pin.integrate(model, q, time * v)).q)
        poses.append(pin.SE3(data.oMf[index]))
    before, after, here = poses
    linear = here.rotation.T @ (after.translation - before.translation) / (2.0 * step)
    angular = here.rotation.T @ before.rotation @ pin.log3(before.rotation.T @ after.rotation) / (2.0 * step)
    local = pin.Motion(linear, angular)
    if reference == pin.LOCAL:
        return local.vector
    if reference == pin.WORLD:
        return here.act(local).vector
    return pin.SE3(here.rotation, np.zeros(3)).act(local).vector


@pytest.mark.parametrize("reference", [pin.LOCAL, pin.WORLD, pin.LOCAL_WORLD_ALIGNED])
@pytest.mark.parametrize("name", ["digit_leg", "five-bar", "arm"])
def test_frame_gets_twist_and_loops_stay_closed(name: str, reference: Any) -> None:
    build = {"digit_leg": lambda: robot_called("digit_leg"), "five-bar": lambda: five_bar(["j0", "j4"]), "arm": arm}
    robot, frame = build[name](), "foot" if name == "digit_leg" else "end"
    random = np.random.default_rng(3)
    q = closed_near(robot, random)
    wanted = random.uniform(-1.0, 1.0, 6)
    found = eurdf.differential_inverse_kinematics(robot, frame, q, wanted, reference=reference)
    assert found.rank == len(robot.actuation.idx_v)
    _, K = residual_and_jacobian(robot, q)
    np.testing.assert_allclose(K @ found.v, 0.0, atol=1e-9)
    np.testing.assert_array_equal(found.actuated, found.v[robot.actuation.idx_v])
    np.testing.assert_allclose(found.twist, twist_by_differences(robot, q, found.v, frame, reference), atol=1e-5)
    if name == "digit_leg":
        np.testing.assert_allclose(found.twist, wanted, atol=1e-9)
    again = eurdf.differential_inverse_kinematics(robot, frame, q, found.twist, reference=reference)
    np.testing.assert_allclose(again.twist, found.twist, atol=1e-9)
    np.testing.assert_allclose(again.v, found.v, atol=1e-8)


def test_velocities_stay_bounded_near_singularity() -> None:
    robot = arm(3)  # x, y and heading of its end: straight, it cannot go outward
    outward = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    J = eurdf.actuated_jacobian(robot, "end", np.array([0.0, 1e-13, 0.0]))
    assert np.abs(np.linalg.pinv(J) @ outward).max() > 1e9  # what a rank decision at rounding gives
    for bend in (0.0, 1e-13, 1e-9, 1e-6, 1e-4):
        found = eurdf.differential_inverse_kinematics(robot, "end", np.array([0.0, bend, 0.0]), outward)
        assert found.rank == 2
        assert np.abs(found.v).max() < 1.0
        assert np.abs(found.twist).max() < 1e-3
    bent = eurdf.differential_inverse_kinematics(robot, "end", np.array([0.0, 0.5, 0.0]), outward)
    assert bent.rank == 3
    np.testing.assert_allclose(bent.twist, outward, atol=1e-12)
    assert eurdf.differential_inverse_kinematics(robot, "end", bent.v, outward, singular=0.9).rank == 1


def test_dependent_motors_share_the_motion() -> None:
    robot = five_bar(["j0", "j1", "j4"])  # three motors for two motions
    q = closed_near(robot, np.random.default_rng(1))
    with pytest.raises(eurdf.errors.DependentActuators):
        eurdf.kinematics.dq_dq_actuated(robot, q)
    two = five_bar(["j0", "j4"])
    wanted = eurdf.differential_inverse_kinematics(two, "end", q, np.ones(6)).twist
    found = eurdf.differential_inverse_kinematics(robot, "end", q, wanted)
    assert found.rank == 2
    np.testing.assert_allclose(found.twist, wanted, atol=1e-9)


def test_nothing_moves_without_motors() -> None:
    found = eurdf.differential_inverse_kinematics(five_bar([]), "end", assemble(five_bar([])).q, np.ones(6))
    np.testing.assert_array_equal(found.v, np.zeros(5))
    np.testing.assert_array_equal(found.twist, np.zeros(6))
    assert (found.rank, found.actuated.shape) == (0, (0,))


def test_invalid_frame_or_threshold_is_refused() -> None:
    robot = arm()
    with pytest.raises(ValueError, match="no frame 'emd'; did you mean 'end'"):
        eurdf.differential_inverse_kinematics(robot, "emd", np.zeros(2), np.ones(6))
    for singular in (0.0, 1.0, float("nan")):
        with pytest.raises(ValueError, match="give a number between 0 and 1"):
            eurdf.differential_inverse_kinematics(robot, "end", np.zeros(2), np.ones(6), singular=singular)
