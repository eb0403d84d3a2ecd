"""The regressor against inverse dynamics of models with other inertias."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics import achievable_acceleration, inertial_regressor

#: With redundant rows (bennett, sarrus, screw_press, toddlerbot_2legs), a mimic joint (screw_press), springs.
ROBOTS = (
    "bennett", "delta", "digit_leg_3d", "double_wishbone", "kangaroo_leg", "sarrus", "screw_press",
    "stewart_platform", "tello", "toddlerbot_2legs", "unitree_g1_ankle",
)  # fmt: skip


@pytest.mark.parametrize("name", ROBOTS)
def test_regressor_gives_torques_for_any_inertia(name: str) -> None:
    robot, random = eurdf.load(name, geometry=False), np.random.default_rng(3)
    nv = robot.tree.nv
    q = eurdf.project_configuration(robot, robot.tree.integrate(eurdf.assemble(robot).q, 0.02 * random.normal(size=nv)))
    v = eurdf.project_velocity(robot, q, random.normal(size=nv))
    a = eurdf.project_acceleration(robot, q, v, random.normal(size=nv))
    tau = random.normal(size=nv)
    a = achievable_acceleration(robot, q, v, a, tau=tau, dissipation=True)
    found = inertial_regressor(robot, q, v, a, tau=tau, dissipation=True)
    u = eurdf.inverse_dynamics(robot, q, v, a, tau=tau, dissipation=True).u
    assert found.Y @ found.parameters + found.constant == pytest.approx(u, rel=1e-9, abs=1e-9)

    other = eurdf.load(name, geometry=False)  # its model is changed before anything is computed of it
    for index in range(1, other.model.njoints):
        other.model.inertias[index] = pin.Inertia.Random()
    parameters = np.concatenate([each.toDynamicParameters() for each in list(other.model.inertias)[1:]])
    # The motors cannot leave this motion of the other robot to itself; `tolerance` accepts the torques nevertheless.
    u = eurdf.inverse_dynamics(other, q, v, a, tau=tau, dissipation=True, tolerance=1e9).u
    assert found.Y @ parameters + found.constant == pytest.approx(u, rel=1e-9, abs=1e-9 * (1.0 + np.abs(u).max()))
