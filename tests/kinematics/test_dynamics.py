"""Dynamics of closed mechanisms: forward, inverse, and in time."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.errors import (
    InconsistentMotion,
    NotClosable,
    SimulationDiverged,
    UnderactuatedMotion,
    UndeterminedMotion,
)
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.dynamics import achievable_acceleration, forward_dynamics, inverse_dynamics
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.simulation import simulate
from support.described import LIMITED, body, load, mass_matrix
from support.linkage import (
    Linkage,
    X,
    Y,
    Z,
    bennett,
    closure,
    drift_by_differences,
    loop,
    n_bar,
    sarrus,
    slider_crank,
    spherical_four_bar,
    stewart,
    swapped,
    translation,
    weighted,
)
from support.plain_urdf import joint_element
from support.plain_urdf import robot as urdf_of

seeds = st.integers(0, 2**32 - 1)
ROBOTS = ("four_bar", "digit_leg")
TILT = pin.exp3(np.array([0.3, -0.5, 0.2]))


def tilted(count: int, **options: Any) -> Linkage:
    """A planar linkage of so many bars, all its pins joints, their axes to and fro, and in no plane of the world's."""
    angles = 0.3 + 2.0 * np.pi * np.arange(count) / count
    corners = [TILT @ np.array([(1.0 + 0.05 * i) * np.cos(a), np.sin(a), 0.0]) for i, a in enumerate(angles)]
    return loop([("R", corner, (-1.0) ** i * TILT @ np.array(Z)) for i, corner in enumerate(corners)], **options)


LINKAGES = {
    "five-bar in 3d": lambda: n_bar(5, "3d", actuated=("j0", "j3")),
    "five-bar in 6d": lambda: n_bar(5, "6d", actuated=("j0", "j4")),
    "five-bar in 6d, with frames A and B exchanged": lambda: swapped(n_bar(5, "6d", actuated=("j0", "j4"))),
    "slider-crank": slider_crank,
    "sarrus": sarrus,
    "bennett": bennett,
    "spherical four-bar": spherical_four_bar,
    "stewart platform": stewart,
    "five-bar with rounded axes": lambda: tilted(5, decimals=6, actuated=("j0", "j4")),
}


def assert_same(found: Any, expected: Any) -> None:
    """Equal but for rounding, which a solve of some thousand operations multiplies by the condition of its matrix."""
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max(initial=1.0))


def closed_state(robot: Any, random: np.random.Generator, reach: float = 0.2) -> tuple[Any, Any]:
    """A closed configuration near the assembled one, and a velocity there that keeps it closed."""
    model = robot.model
    first = assemble(robot)
    assert first.closes
    while True:
        q = assemble(robot, pin.integrate(model, first.q, random.uniform(-reach, reach, model.nv)))
        if q.closes:
            return q.q, free_part(robot, q.q, random.uniform(-1.0, 1.0, model.nv))


def free_part(robot: Any, q: Any, v: Any) -> Any:
    """v less what K sees of it; what is below 1e-4 of K is the rounding of files."""
    K = residual_and_jacobian(robot, q)[1]
    return v - np.linalg.pinv(K, rcond=1e-4) @ (K @ v)


def possible(robot: Any, q: Any, v: Any, random: np.random.Generator) -> Any:
    """Some acceleration that keeps the closures closed, after finite differences."""
    K, some = residual_and_jacobian(robot, q)[1], random.uniform(-3.0, 3.0, robot.model.nv)
    return some - np.linalg.pinv(K, rcond=1e-4) @ (K @ some + drift_by_differences(robot, q, v))


def stacked(forces: Any) -> Any:
    return np.concatenate(forces) if forces else np.zeros(0)


def robot_named(name: str) -> Any:
    return eurdf.load(name, geometry=False) if name in ROBOTS else weighted(LINKAGES[name]())


every_robot = pytest.mark.parametrize("name", [*ROBOTS, *LINKAGES])


def test_closure_force_holds_body_of_frame_b() -> None:
    model = pin.Model()
    slider = model.addJoint(0, pin.JointModelPZ(), pin.SE3.Identity(), "slider")
    model.inertias[slider] = pin.Inertia(2.0, np.zeros(3), np.eye(3))
    turned = pin.SE3(pin.exp3(np.array([np.pi / 2.0, 0.0, 0.0])), np.zeros(3))  # its y axis is up
    for kind, force in (("3d", [0.0, 19.62, 0.0]), ("6d", [0.0, 19.62, 0.0, 0.0, 0.0, 0.0])):
        hung = Linkage(model, [closure(model, 0, turned, slider, turned, kind)])
        found = forward_dynamics(hung, np.zeros(1), np.zeros(1))
        np.testing.assert_allclose(found.forces[0], force, atol=1e-12)
        assert abs(found.a[0]) < 1e-12
        other = forward_dynamics(swapped(hung), np.zeros(1), np.zeros(1))
        np.testing.assert_allclose(other.forces[0], -np.array(force), atol=1e-12)


# --- what holds of every robot -------------------------------------------------------------------------------------


@every_robot
@given(seed=seeds)
@settings(max_examples=5, deadline=None)
def test_acceleration_satisfies_both_equations(name: str, seed: int) -> None:
    random = np.random.default_rng(seed)
    robot = robot_named(name)
    model, S = robot.model, robot.actuation.selection
    q, v = closed_state(robot, random)
    u, tau = random.uniform(-5.0, 5.0, S.shape[1]), random.uniform(-1.0, 1.0, model.nv)
    a, forces = forward_dynamics(robot, q, v, u, tau=tau)
    K = residual_and_jacobian(robot, q)[1]
    force = pin.rnea(model, model.createData(), q, v, a) - S @ u - tau - K.T @ stacked(forces)
    assert np.abs(force).max() < 1e-8 * (1.0 + np.abs(K.T @ stacked(forces)).max())
    open_by = K @ a + drift_by_differences(robot, q, v)
    rounding = 1e-3 if "rounded" in name else 1e-8  # what rounded rows contradict each other by
    assert np.abs(open_by).max() < rounding * (1.0 + np.abs(a).max())


@every_robot
@given(seed=seeds)
@settings(max_examples=5, deadline=None)
def test_inverse_dynamics_recovers_torques(name: str, seed: int) -> None:
    random = np.random.default_rng(seed)
    robot = robot_named(name)
    S = robot.actuation.selection
    q, v = closed_state(robot, random)
    u = random.uniform(-5.0, 5.0, S.shape[1])
    a, forces = forward_dynamics(robot, q, v, u)
    found = inverse_dynamics(robot, q, v, a)
    scale = 1.0 + np.abs(stacked(forces)).max()
    np.testing.assert_allclose(found.u, u, atol=1e-7 * scale)
    np.testing.assert_allclose(stacked(found.forces), stacked(forces), atol=1e-7 * scale)


@every_robot
@given(seed=seeds)
@settings(max_examples=5, deadline=None)
def test_forward_dynamics_recovers_acceleration(name: str, seed: int) -> None:
    random = np.random.default_rng(seed)
    robot = robot_named(name)
    S = robot.actuation.selection
    q, v = closed_state(robot, random)
    wanted = possible(robot, q, v, random)
    a = achievable_acceleration(robot, q, v, wanted)
    np.testing.assert_allclose(S.T @ a, S.T @ wanted, atol=1e-8 * (1.0 + np.abs(a).max()))
    found = forward_dynamics(robot, q, v, inverse_dynamics(robot, q, v, a).u)
    np.testing.assert_allclose(found.a, a, atol=1e-6 * (1.0 + np.abs(a).max()))


@pytest.mark.parametrize("name", [*ROBOTS, *(name for name in LINKAGES if "rounded" not in name)])
@pytest.mark.parametrize("factor", [1e-9, 1e9])
def test_scaling_mass_keeps_acceleration(name: str, factor: float) -> None:
    robot = robot_named(name)
    q, v = closed_state(robot, np.random.default_rng(7))
    model, u = robot.model, np.ones(robot.actuation.selection.shape[1])
    expected = forward_dynamics(robot, q, v, u)
    for joint in range(1, model.njoints):
        inertia = model.inertias[joint]
        model.inertias[joint] = pin.Inertia(factor * inertia.mass, inertia.lever, factor * inertia.inertia)
    model.armature = factor * model.armature
    found = forward_dynamics(robot, q, v, factor * u)
    np.testing.assert_allclose(found.a, expected.a, atol=1e-6 * (1.0 + np.abs(expected.a).max()))
    largest = np.abs(stacked(expected.forces)).max()
    np.testing.assert_allclose(stacked(found.forces) / factor, stacked(expected.forces), atol=1e-5 * (1.0 + largest))


# --- redundant rows, followers, missing inertia ---------------------------------------------------------------------


def test_rounding_does_not_lock_redundant_loop() -> None:
    exact = weighted(tilted(5, actuated=("j0",)), 2)
    rounded = weighted(tilted(5, actuated=("j0",), decimals=6), 2)
    singular = np.linalg.svd(residual_and_jacobian(rounded, assemble(rounded).q)[1], compute_uv=False)
    assert 1e-8 < singular[3] < 1e-5  # of three that count
    still, zero = np.ones(1), np.zeros(5)
    for u in (still, 20.0 * still):
        a = forward_dynamics(exact, zero, zero, u).a
        np.testing.assert_allclose(forward_dynamics(rounded, zero, zero, u).a, a, atol=1e-2 * np.abs(a).max())


PIN = """closures: [{name: pin, type: 3d, frames: [{link: base, xyz: [0.7, 0, 0.4]}, {link: tip, xyz: [0.6, 0, 0]}]}]
actuators: [a]
"""

ALONG_Y = LIMITED.format("0 1 0")
MIMIC = '<mimic joint="a" multiplier="-1.5" offset="0.3"/>'
AT = '<origin xyz="0.4 0 0"/>'
FOLLOWING = (
    *(body(name) for name in ("base", "upper", "middle", "lower")),
    joint_element("a", "revolute", "base", "upper", ALONG_Y),
    joint_element("b", "revolute", "upper", "middle", ALONG_Y + MIMIC, '<origin xyz="0.5 0 0"/>'),
    joint_element("c", "revolute", "middle", "lower", ALONG_Y, AT),
)


def test_late_leader_is_named_in_errors() -> None:
    robot = load(urdf_of(*FOLLOWING).replace(MIMIC, '<mimic joint="c" multiplier="-1.5"/>'))
    assert "c/coordinate" in list(robot.model.names)
    with pytest.raises(eurdf.errors.UnderactuatedMotion) as refused:
        inverse_dynamics(robot, np.zeros(2), np.zeros(2), np.ones(2))
    assert set(refused.value.missing) == {"a", "c"}


def test_loop_with_mimic_joint_is_solved() -> None:
    tip = joint_element("d", "revolute", "lower", "tip", ALONG_Y, AT)
    robot = load(urdf_of(*FOLLOWING, body("tip"), tip), PIN)
    random = np.random.default_rng(0)
    q, v = closed_state(robot, random)
    M, K = mass_matrix(robot.model, q), residual_and_jacobian(robot, q)[1][[0, 2]]
    h = pin.rnea(robot.model, robot.data, q, v, np.zeros(3))
    right = np.concatenate([[2.0, 0.0, 0.0] - h, -drift_by_differences(robot, q, v)[[0, 2]]])
    expected = np.linalg.solve(np.block([[M, -K.T], [K, np.zeros((2, 2))]]), right)
    found = forward_dynamics(robot, q, v, np.array([2.0]))
    np.testing.assert_allclose(found.a, expected[:3], rtol=1e-7)
    np.testing.assert_allclose(found.forces[0], [expected[3], 0.0, expected[4]], rtol=1e-7, atol=1e-9)
    motion = simulate(robot, q, v, duration=0.1)
    assert motion.energy_error < 1e-6 * motion.energy_exchanged


def test_inertia_is_needed_only_for_free_motions() -> None:
    linkage = weighted(n_bar(4))
    light = weighted(n_bar(4))
    for joint in (3, 4):  # the last two bars: the coupler's pin and what is welded to the ground
        linkage.model.inertias[joint] = pin.Inertia.Zero()
        light.model.inertias[joint] = pin.Inertia(1e-9, np.zeros(3), 1e-9 * np.eye(3))
    q, v = closed_state(light, np.random.default_rng(0))
    found = forward_dynamics(linkage, q, v, np.ones(1))
    np.testing.assert_allclose(found.a, forward_dynamics(light, q, v, np.ones(1)).a, rtol=1e-6)
    assert inverse_dynamics(linkage, q, v, found.a).u == pytest.approx(1.0)


def test_massless_free_motion_is_named() -> None:
    model = weighted(n_bar(4)).model
    spinner = model.addJoint(1, pin.JointModelRX(), translation(0.1, 0.0, 0.0), "spinner")
    linkage = Linkage(model, n_bar(4).constraints, ["j0"])
    assert model.names[spinner] == "spinner"
    zero = np.zeros(5)
    with pytest.raises(UndeterminedMotion) as caught:
        forward_dynamics(linkage, zero, zero)
    assert caught.value.joints == ("spinner",)
    assert "'spinner'" in str(caught.value)
    # At rest, no force is needed.
    a = achievable_acceleration(linkage, zero, zero, zero)
    assert inverse_dynamics(linkage, zero, zero, a).u.shape == (1,)
    with pytest.raises(UnderactuatedMotion) as refused:
        inverse_dynamics(linkage, zero, zero, zero, tau=np.array([0.0, 0.0, 0.0, 0.0, 1.0]))
    assert refused.value.missing == {"spinner": (pytest.approx(-1.0),)}


# --- actuation ------------------------------------------------------------------------------------------------------


def test_redundant_motors_share_least_torque() -> None:
    robot = weighted(n_bar(4, actuated=("j0", "j1", "j2")))
    random = np.random.default_rng(1)
    q, v = closed_state(robot, random)
    a = forward_dynamics(robot, q, v, np.array([2.0, -1.0, 4.0])).a
    K, S = residual_and_jacobian(robot, q)[1], robot.actuation.selection
    free = np.linalg.svd(K)[2][3:]
    required = free @ pin.rnea(robot.model, robot.model.createData(), q, v, a)
    found = inverse_dynamics(robot, q, v, a)
    np.testing.assert_allclose(found.u, np.linalg.pinv(free @ S) @ required, rtol=1e-8)
    weights = np.array([1.0, 100.0, 4.0])
    dear = inverse_dynamics(robot, q, v, a, weights=weights).u
    np.testing.assert_allclose(free @ S @ dear, required, rtol=1e-8)
    # Least: the weighted solution is normal to what changes nothing.
    unseen = np.linalg.svd(free @ S)[2][1:]
    np.testing.assert_allclose(unseen @ (weights * dear), 0.0, atol=1e-8)
    u0 = random.normal(size=3)
    near = inverse_dynamics(robot, q, v, a, weights=weights, u0=u0).u
    np.testing.assert_allclose(unseen @ (weights * (near - u0)), 0.0, atol=1e-8)
    np.testing.assert_allclose(inverse_dynamics(robot, q, v, a, u0=near).u, near, rtol=1e-8)  # it is a solution
    for u in (found.u, dear, near):
        np.testing.assert_allclose(forward_dynamics(robot, q, v, u).a, a, rtol=1e-7, atol=1e-7)
    with pytest.raises(ValueError, match="expected positive numbers"):
        inverse_dynamics(robot, q, v, a, weights=np.array([1.0, 0.0, 1.0]))
    with pytest.raises(ValueError, match="u0 has the shape"):
        inverse_dynamics(robot, q, v, a, u0=np.zeros(2))


def test_reference_torques_do_not_change_the_only_solution() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q, still = eurdf.assemble(robot).q, np.zeros(robot.model.nv)
    a = eurdf.forward_dynamics(robot, q, still, np.arange(6.0)).a
    for u0 in (None, np.full(6, 100.0)):
        np.testing.assert_allclose(inverse_dynamics(robot, q, still, a, u0=u0).u, np.arange(6.0), atol=1e-7)


def test_motion_without_motor_is_refused_with_joint_names() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    random = np.random.default_rng(0)
    q, v = closed_state(robot, random)
    a = forward_dynamics(robot, q, v, np.ones(6)).a
    spin = free_part(robot, q, np.ones(27) - robot.actuation.selection @ np.ones(6))
    K = np.vstack([residual_and_jacobian(robot, q)[1], robot.actuation.selection.T])
    spin -= np.linalg.pinv(K) @ (K @ spin)  # the rods turn about themselves
    with pytest.raises(UnderactuatedMotion) as caught:
        inverse_dynamics(robot, q, v, a + spin)
    balls = {f"ball_{rod}_{end}" for rod in ("achilles", "rod1", "rod2") for end in ("start", "end")}
    assert set(caught.value.missing) == balls
    assert all(name in str(caught.value) for name in balls)
    np.testing.assert_allclose(caught.value.deviation, np.abs(spin).max(), rtol=1e-6)
    # The forces said to be missing are missing: with them, it is done.
    tau = np.zeros(27)
    for name, force in caught.value.missing.items():
        index = robot.model.joints[robot.model.getJointId(name)].idx_v
        tau[index : index + 3] = force
    u = inverse_dynamics(robot, q, v, a + spin, tau=tau).u
    np.testing.assert_allclose(forward_dynamics(robot, q, v, u, tau=tau).a, a + spin, atol=1e-6)
    np.testing.assert_allclose(achievable_acceleration(robot, q, v, a + spin), a, atol=1e-6)


def test_motion_that_opens_closures_is_refused_with_names() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q, v = closed_state(robot, np.random.default_rng(0))
    a = forward_dynamics(robot, q, v).a
    index = robot.model.joints[robot.model.getJointId("ball_achilles_end")].idx_v
    bent = np.array(a)
    bent[index + 1] += 0.1
    with pytest.raises(InconsistentMotion) as caught:
        inverse_dynamics(robot, q, v, bent)
    assert caught.value.order == "acceleration"
    assert set(caught.value.opening) == {"achilles"}
    np.testing.assert_allclose(
        caught.value.opening["achilles"], (residual_and_jacobian(robot, q)[1] @ (bent - a))[:6], atol=1e-8
    )
    assert "'achilles'" in str(caught.value)
    with pytest.raises(InconsistentMotion) as caught:
        achievable_acceleration(robot, q, v + (bent - a), a)
    assert caught.value.order == "velocity"
    assert inverse_dynamics(robot, q, v, a + 1e-9 * np.ones(27)).u.shape == (6,)


# --- forces from elsewhere ------------------------------------------------------------------------------------------


@given(seed=seeds)
@settings(max_examples=10, deadline=None)
def test_external_force_acts_at_frame_in_world_axes(seed: int) -> None:
    random = np.random.default_rng(seed)
    robot = eurdf.load("digit_leg", geometry=False)
    model, data = robot.model, robot.data
    q, v = closed_state(robot, random)
    names = [frame.name for frame in model.frames if frame.parentJoint > 0]
    pushes = {name: random.uniform(-5.0, 5.0, 6) for name in random.choice(names, 3, replace=False).tolist()}
    tau = np.zeros(model.nv)
    for name, push in pushes.items():
        J = pin.computeFrameJacobian(model, data, q, model.getFrameId(name), pin.LOCAL_WORLD_ALIGNED)
        tau += J.T @ push
    found = forward_dynamics(robot, q, v, external=pushes)
    expected = forward_dynamics(robot, q, v, tau=tau)
    np.testing.assert_allclose(found.a, expected.a, atol=1e-7 * np.abs(expected.a).max())
    wrapped = {name: pin.Force(push) for name, push in pushes.items()}
    back = inverse_dynamics(robot, q, v, found.a, external=wrapped)
    np.testing.assert_allclose(back.u, 0.0, atol=1e-6)


def test_damping_and_friction_act_on_request() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q, v = closed_state(robot, np.random.default_rng(0))
    model = robot.model
    assert model.damping.any()
    assert model.upperDryFrictionLimit.any()
    tau = -model.damping * v - model.upperDryFrictionLimit * np.sign(v)
    braked = forward_dynamics(robot, q, v, dissipation=True)
    assert_same(braked.a, forward_dynamics(robot, q, v, tau=tau).a)
    free = forward_dynamics(robot, q, v).a
    assert np.abs(braked.a - free).max() > 1.0
    u = inverse_dynamics(robot, q, v, free, dissipation=True).u
    np.testing.assert_allclose(u, -robot.actuation.selection.T @ tau, atol=1e-8)


@pytest.mark.parametrize("name", ["four_bar", "digit_leg", "five-bar in 6d", "five-bar with rounded axes"])
def test_gains_close_open_mechanism(name: str) -> None:
    robot = robot_named(name)
    random = np.random.default_rng(0)
    q, v = closed_state(robot, random)
    kp, kd, nv = 400.0, 40.0, robot.model.nv
    q = pin.integrate(robot.model, q, 1e-6 * random.normal(size=nv))
    v = v + 1e-4 * random.normal(size=nv)
    a = forward_dynamics(robot, q, v, gains=(kp, kd)).a
    r, K = residual_and_jacobian(robot, q)
    values = np.linalg.svd(K, compute_uv=False)
    counted = K @ np.linalg.pinv(K, rcond=1e-4 if "rounded" in name else 1e-9 * values[0])
    left = counted @ (K @ a + drift_by_differences(robot, q, v) + kd * K @ v + kp * r)
    assert np.abs(left).max() < 1e-6 * np.abs(a).max()
    assert all(found.m_baumgarte_parameters.Kp == 0.0 for found in robot.constraint_models)
    for found in robot.constraint_models:
        found.m_baumgarte_parameters.Kp, found.m_baumgarte_parameters.Kd = kp, kd
    assert_same(forward_dynamics(robot, q, v).a, a)


def test_given_data_does_not_change_result() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q, v = closed_state(robot, np.random.default_rng(0))
    data = robot.model.createData()
    pin.computeAllTerms(robot.model, data, pin.neutral(robot.model), np.ones(27))
    alone = forward_dynamics(robot, q, v, np.ones(6))
    for _ in range(2):
        found = forward_dynamics(robot, q, v, np.ones(6), data=data)
        assert_same(found.a, alone.a)
        assert_same(stacked(found.forces), stacked(alone.forces))


# --- in time --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "duration", "step", "bound"), [("four_bar", 1.0, 2.5e-3, 3e-6), ("digit_leg", 0.1, 1e-3, 1e-8)]
)
def test_passive_robot_keeps_energy_and_closure(name: str, duration: float, step: float, bound: float) -> None:
    robot = eurdf.load(name, geometry=False)
    q, v = closed_state(robot, np.random.default_rng(5))
    motion = simulate(robot, q, 2.0 * v, duration=duration, step=step)
    total = motion.kinetic + motion.potential
    assert np.abs(total - total[0]).max() < bound * motion.kinetic.max()
    assert np.abs(pin.difference(robot.model, q, motion.q[-1])).max() > 0.3  # it went somewhere
    for q, v in zip(motion.q, motion.v, strict=True):
        r, K = residual_and_jacobian(robot, q)
        assert np.abs(r).max() < 1e-12
        assert np.abs(K @ v).max() < 1e-12 * (1.0 + np.abs(v).max())


def test_integrator_is_fourth_order_on_manifold() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q, v = closed_state(robot, np.random.default_rng(1))
    v *= 5.0
    ends = [simulate(robot, q, v, duration=0.04, step=0.04 / count).q[-1] for count in (5, 10, 20)]
    coarse, fine = (np.abs(pin.difference(robot.model, a, b)).max() for a, b in itertools.pairwise(ends))
    assert 11.0 < coarse / fine < 23.0


def test_holding_torques_hold_robot() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q = assemble(robot).q
    zero, idx_v = np.zeros(27), robot.actuation.idx_v
    u = inverse_dynamics(robot, q, zero, achievable_acceleration(robot, q, zero, zero)).u
    times = []

    def hold(t: float, at: Any, v: Any) -> Any:
        times.append(t)
        return u - pin.difference(robot.model, q, at)[idx_v] - 0.01 * v[idx_v]

    motion = simulate(robot, q, duration=0.05, control=hold)
    assert np.abs(pin.difference(robot.model, q, motion.q[-1])[idx_v]).max() < 1e-8
    assert motion.t[-1] == pytest.approx(0.05)
    assert motion.q.shape == (51, 33)
    assert max(times) == pytest.approx(0.05)
    fallen = simulate(robot, q, duration=0.05).q[-1]
    assert np.abs(pin.difference(robot.model, q, fallen)[idx_v]).max() > 1e-3


def test_too_long_steps_raise_simulation_diverged() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q, idx_v = assemble(robot).q, robot.actuation.idx_v

    def stiff(t: float, at: Any, v: Any) -> Any:
        return -1e6 * pin.difference(robot.model, q, at)[idx_v]

    with pytest.raises(SimulationDiverged) as caught:
        simulate(robot, q, duration=10.0, step=0.01, control=stiff)
    assert 0.0 < caught.value.t < 10.0
    assert caught.value.step == 0.01


def test_error_in_control_is_passed_on() -> None:
    robot = eurdf.load("four_bar", geometry=False)

    def singular(t: float, at: Any, v: Any) -> Any:
        return np.linalg.inv(np.zeros((1, 1)))

    with pytest.raises(np.linalg.LinAlgError):
        simulate(robot, assemble(robot).q, duration=0.01, control=singular)

    def overflowing(t: float, at: Any, v: Any) -> Any:
        return 0.0 * np.exp(np.array([1e4]))

    with np.errstate(over="raise"), pytest.raises(FloatingPointError):
        simulate(robot, assemble(robot).q, duration=0.01, control=overflowing)


def test_empty_simulation_returns_projected_start() -> None:
    robot = eurdf.load("four_bar", geometry=False)
    q = assemble(robot).q
    motion = simulate(robot, pin.integrate(robot.model, q, 0.01 * np.ones(3)), np.ones(3), duration=0.0)
    assert motion.t.tolist() == [0.0]
    r, K = residual_and_jacobian(robot, motion.q[0])
    assert np.abs(r).max() < 1e-9
    assert np.abs(K @ motion.v[0]).max() < 1e-12


def test_simulation_of_open_robot_is_refused() -> None:
    model = pin.Model()
    model.addJoint(0, pin.JointModelRZ(), pin.SE3.Identity(), "j0")
    apart = Linkage(model, [closure(model, 0, translation(*X), 1, translation(*(2.0 * np.array(Y))), "3d", "gap")])
    with pytest.raises(NotClosable, match="'gap'"):
        simulate(apart, np.zeros(1), duration=0.1)
