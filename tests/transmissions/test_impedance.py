"""Gains at the joints as gains at the motors, and back."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eurdf
from support.transmissions import DRIVEN, posed, slider_crank


def torque_of_drives(robot: Any, joints: tuple[str, ...], q: Any, q_J: Any, K_m: Any, tau_m: Any) -> Any:
    """τ_J at the joint positions q_J, where the motors have the stiffness K_m around q."""
    names = eurdf.transmission(robot, joints, q).motors
    found = eurdf.transmissions.actuator_values(robot, dict(zip(joints, q_J, strict=True)), q)
    moved = [found.values[name] - robot.joint_positions(q)[name][0] for name in names]
    return eurdf.transmission(robot, joints, found.q).joint_torque(tau_m - K_m @ np.array(moved))


@pytest.mark.parametrize("name", DRIVEN)
def test_stiffness_is_the_derivative_of_the_torque(name: str) -> None:
    robot, q = posed(name)
    joints, n = DRIVEN[name], len(DRIVEN[name])
    K_J, C_J, tau_J = np.diag(np.linspace(150.0, 60.0, n)), np.linspace(3.0, 1.0, n), np.linspace(20.0, -9.0, n)
    found = eurdf.transmissions.impedance_map(robot, joints, q, K_J, damping=C_J, tau=tau_J)
    h, at = 1e-5, np.array([robot.joint_positions(q)[joint][0] for joint in joints])
    columns = []
    for unit in h * np.eye(n):
        ahead, behind = (
            torque_of_drives(robot, joints, q, at + by, found.motor_stiffness, found.motor_torque)
            for by in (unit, -unit)
        )
        columns.append(-(ahead - behind) / (2 * h))
    np.testing.assert_allclose(np.array(columns).T, K_J, atol=1e-4 * 150.0)
    G = eurdf.transmission(robot, joints, q).G
    np.testing.assert_allclose(G.T @ found.motor_damping @ G, np.diag(C_J), atol=1e-9)
    back = eurdf.transmissions.impedance_map(
        robot, joints, q, found.motor_stiffness, damping=found.motor_damping, tau=found.motor_torque, side="motors"
    )
    np.testing.assert_allclose(back.joint_stiffness, K_J, atol=1e-8)
    np.testing.assert_allclose(back.joint_damping, np.diag(C_J), atol=1e-9)
    np.testing.assert_allclose(back.geometric_stiffness, found.geometric_stiffness, atol=1e-9)


def test_independent_drives_lose_what_is_off_the_diagonal() -> None:
    robot, q = posed("unitree_g1_ankle")
    joints = DRIVEN["unitree_g1_ankle"]
    found = eurdf.transmissions.impedance_map(robot, joints, q, [100.0, 50.0], damping=[2.0, 1.0], tau=[15.0, -4.0])
    assert np.abs(found.motor_stiffness[0, 1]) > 1.0  # a full matrix
    G = eurdf.transmission(robot, joints, q).G
    made = G.T @ np.diag(found.drive_stiffness) @ G + found.geometric_stiffness
    np.testing.assert_allclose(found.joint_stiffness_of_drives, made, atol=1e-9)
    np.testing.assert_allclose(found.joint_damping_of_drives, G.T @ np.diag(found.drive_damping) @ G, atol=1e-12)

    def missed(k: Any) -> float:
        off = (G.T @ np.diag(k) @ G + found.geometric_stiffness - np.diag([100.0, 50.0])) / [10.0, 50.0**0.5]
        return float(np.sum((off.T / [10.0, 50.0**0.5]) ** 2))

    least = missed(found.drive_stiffness)
    assert least > 1e-3
    for change in ([0.1, 0.0], [-0.1, 0.0], [0.0, 0.1], [0.0, -0.1]):
        assert missed(found.drive_stiffness + change) > least
    # Gains that drives can have come back as they were.
    set_gains = eurdf.transmissions.impedance_map(
        robot, joints, q, [40.0, 30.0], damping=[1.0, 0.5], tau=[3.0, -2.0], side="motors"
    )
    np.testing.assert_allclose(set_gains.drive_stiffness, [40.0, 30.0], rtol=1e-9)
    np.testing.assert_allclose(set_gains.drive_damping, [1.0, 0.5], rtol=1e-9)
    np.testing.assert_allclose(set_gains.joint_stiffness_of_drives, set_gains.joint_stiffness, rtol=1e-9)
    # A stiffness that no positive gain makes better leaves a drive at zero.
    hard = eurdf.transmissions.impedance_map(robot, joints, q, [[10.0, 40.0], [40.0, 10.0]])
    assert (hard.drive_stiffness >= 0.0).all()
    assert hard.drive_stiffness.min() == 0.0


def test_wrong_gains_are_refused() -> None:
    robot, q = posed("unitree_g1_ankle")
    joints = DRIVEN["unitree_g1_ankle"]
    with pytest.raises(ValueError, match="stiffness is not a symmetric matrix"):
        eurdf.transmissions.impedance_map(robot, joints, q, [[1.0, 2.0], [0.0, 1.0]])
    with pytest.raises(ValueError, match=r"damping has the shape \(3,\)"):
        eurdf.transmissions.impedance_map(robot, joints, q, [1.0, 2.0], damping=[1.0, 2.0, 3.0])
    with pytest.raises(ValueError, match="side is 'serial'; use 'joints' or 'motors'"):
        eurdf.transmissions.impedance_map(robot, joints, q, [1.0, 2.0], side="serial")  # type: ignore[arg-type]
    stretched, q = slider_crank(0.05, 0.13, 0.0)
    with pytest.raises(eurdf.errors.NoTransmission, match="singular"):
        eurdf.transmissions.impedance_map(stretched, "slide", q, [1.0])
