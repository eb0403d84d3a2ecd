"""The inertia that joints feel: against the dynamics of the closed mechanism, and MuJoCo."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from support.transmissions import DRIVEN, posed, slider_crank, with_properties


@pytest.mark.parametrize("name", DRIVEN)
def test_joint_torque_accelerates_the_inertia(name: str) -> None:
    found, q = posed(name)
    armature = {motor: 0.01 * (index + 1) for index, motor in enumerate(found.actuation.joints)}
    armature[DRIVEN[name][0]] = 0.02  # of a passive joint too
    robot = with_properties(found, {name: {"armature": (value,)} for name, value in armature.items()})
    inertia = eurdf.transmissions.reflected_inertia(robot, DRIVEN[name], q)
    others = [motor for motor in robot.actuation.joints if motor not in inertia.motors]
    alone = eurdf.lock(robot, others, q)
    at, n = q[alone.idx_q], len(inertia.joints)
    index = [alone.slots[joint].idx_v for joint in inertia.joints]
    still = np.zeros(alone.model.nv)
    gravity = eurdf.forward_dynamics(alone, at, still).a
    for tau_J, column in zip(np.eye(n), np.linalg.inv(inertia.total).T, strict=True):
        tau = np.zeros(alone.model.nv)
        tau[index] = tau_J
        a_J = (eurdf.forward_dynamics(alone, at, still, tau=tau).a - gravity)[index]
        np.testing.assert_allclose(a_J, column, atol=1e-8 * np.abs(column).max())
    # With the motors locked, the joints do not move: nothing is left for the torque to accelerate.
    stopped = eurdf.lock(robot, robot.actuation.joints, q)
    free = [stopped.slots[joint].idx_v for joint in inertia.joints if joint in stopped.slots]
    tau = np.zeros(stopped.model.nv)
    tau[free] = 1.0
    still, at = np.zeros(stopped.model.nv), q[stopped.idx_q]
    change = eurdf.forward_dynamics(stopped, at, still, tau=tau).a - eurdf.forward_dynamics(stopped, at, still).a
    np.testing.assert_allclose(change[free], 0.0, atol=1e-6)

    given = dict.fromkeys(inertia.motors, 0.1)
    other = eurdf.transmissions.reflected_inertia(found, DRIVEN[name], q, armature=given)
    G = eurdf.transmission(robot, DRIVEN[name], q).G
    np.testing.assert_allclose(other.rotors, 0.1 * G.T @ G, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(other.linkage, inertia.linkage, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(other.other_armature, 0.0)  # none is stated there


@pytest.mark.parametrize("name", ["unitree_g1_ankle", "tesla_optimus_ankle"])
def test_linkage_has_the_energy_of_its_bodies(name: str) -> None:
    robot, q = posed(name)
    inertia = eurdf.transmissions.reflected_inertia(robot, DRIVEN[name], q)
    v_J = np.array([0.7, -0.4])
    v = eurdf.kinematics.dq_dq_actuated(robot, q) @ eurdf.transmission(robot, DRIVEN[name], q).motor_velocity(v_J)
    model, data = robot.model, robot.model.createData()
    pin.forwardKinematics(model, data, q, v)
    energy = {True: 0.0, False: 0.0}
    for body in robot.mechanism.bodies:
        if body.inertia is not None:
            frame = model.getFrameId(body.name)
            twist = pin.getFrameVelocity(model, data, frame, pin.LOCAL)
            pose = pin.XYZQUATToSE3(np.array([*body.inertia.pose.xyz, *body.inertia.pose.quaternion]))
            xx, xy, xz, yy, yz, zz = body.inertia.moments
            own = pin.Inertia(body.inertia.mass, np.zeros(3), np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
            energy[body.name in inertia.bodies] += 0.5 * twist.vector @ pose.act(own).matrix() @ twist.vector
    assert 0.5 * v_J @ inertia.linkage @ v_J == pytest.approx(energy[True], rel=1e-9)
    assert 0.5 * v_J @ inertia.serial @ v_J == pytest.approx(energy[False], rel=1e-9)


def test_bodies_of_a_linkage_are_those_no_serial_robot_has() -> None:
    robot = eurdf.load("kangaroo_leg", geometry=False)
    bodies = eurdf.transmissions.reflected_inertia(robot, DRIVEN["kangaroo_leg"]).bodies
    assert {"nut", "triangle", "knee_rod", "ankle_inner_crank", "ankle_outer_piston"} <= set(bodies)
    assert not {"hip", "thigh", "shin", "ankle_cross", "foot"} & set(bodies)


def test_many_configurations_equal_single_ones() -> None:
    robot, joints = eurdf.load("unitree_g1_ankle", geometry=False), DRIVEN["unitree_g1_ankle"]
    qs = np.array([posed("unitree_g1_ankle", seed)[1] for seed in range(2)])
    many = eurdf.transmissions.reflected_inertia(robot, joints, qs)
    for index, q in enumerate(qs):
        np.testing.assert_allclose(
            many.total[index], eurdf.transmissions.reflected_inertia(robot, joints, q).total, rtol=1e-12
        )
    assert many.equivalent_armature.shape == (2, 2, 2)


def test_wrong_inertias_are_refused() -> None:
    robot, joints = eurdf.load("unitree_g1_ankle", geometry=False), DRIVEN["unitree_g1_ankle"]
    for armature, message in (
        ({"motor_c": 1.0}, "armature names 'motor_c', which is no motor of these joints: motor_a, motor_b"),
        ({"motor_a": -1.0}, "expected a number of at least 0"),
        ({"motor_a": np.inf}, "not finite"),
    ):
        with pytest.raises(ValueError, match=message):
            eurdf.transmissions.reflected_inertia(robot, joints, armature=armature)
    with pytest.raises(eurdf.errors.NoTransmission, match="add 'free_roll'"):
        eurdf.transmissions.reflected_inertia(robot, "free_pitch")
    stretched, q = slider_crank(0.05, 0.13, 0.0)
    with pytest.raises(eurdf.errors.NoTransmission, match="singular"):
        eurdf.transmissions.reflected_inertia(stretched, "slide", q)
