"""The map between motors and joints: against differences, dynamics and closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import eurdf
from support.described import body, load
from support.linkage import described, n_bar
from support.plain_urdf import joint_element
from support.plain_urdf import robot as urdf
from support.transmissions import DRIVEN, posed, slider_crank, with_properties

G1 = "unitree_g1_ankle", DRIVEN["unitree_g1_ankle"]


def values(robot: Any, q: Any, names: tuple[str, ...]) -> Any:
    found = robot.joint_positions(q)
    return np.array([found[name][0] for name in names])


def moved(robot: Any, q: Any, motors: tuple[str, ...], by: Any) -> Any:
    return eurdf.forward_kinematics(robot, dict(zip(motors, values(robot, q, motors) + by, strict=True)), q)


@pytest.mark.parametrize("name", DRIVEN)
def test_identities_hold(name: str) -> None:
    robot, q = posed(name)
    at = eurdf.transmission(robot, DRIVEN[name], q)
    n = len(at.joints)
    assert (at.G.shape, at.B_J.shape) == ((n, n), (n, n))
    np.testing.assert_allclose(at.B_J @ at.G, np.eye(n), atol=1e-12)

    # B_J against differences of forward kinematics, which follows the loops.
    h = 1e-5
    for k, unit in enumerate(h * np.eye(n)):
        ahead, behind = (values(robot, moved(robot, q, at.motors, by), at.joints) for by in (unit, -unit))
        scale = np.abs(at.B_J).max()
        np.testing.assert_allclose((ahead - behind) / (2 * h), at.B_J[:, k], atol=1e-4 * scale)

    # A joint torque and the motor torques that balance it leave the acceleration of the whole robot as it is.
    tau_J, v_J = np.arange(1.0, n + 1.0), np.linspace(0.3, -0.4, n)
    tau_m, v_m = at.motor_torque(tau_J), at.motor_velocity(v_J)
    u, tau, still = np.zeros(len(robot.actuation.joints)), np.zeros(robot.model.nv), np.zeros(robot.model.nv)
    u[[robot.actuation.joints.index(motor) for motor in at.motors]] = -tau_m
    tau[at.joint_index] = tau_J
    one = eurdf.forward_dynamics(robot, q, still, u, tau=tau).a
    other = eurdf.forward_dynamics(robot, q, still).a
    np.testing.assert_allclose(one, other, atol=1e-8 * (1.0 + np.abs(other).max()))

    assert tau_m @ v_m == pytest.approx(tau_J @ v_J, rel=1e-12)
    np.testing.assert_allclose(at.joint_torque(tau_m), tau_J, rtol=1e-12)
    np.testing.assert_allclose(at.joint_velocity(v_m), v_J, rtol=1e-12)

    # Ġ against differences of G along the motion.
    h = 1e-4
    ahead, behind = (
        eurdf.transmission(robot, DRIVEN[name], moved(robot, q, at.motors, by)) for by in (h * v_m, -h * v_m)
    )
    change = (ahead.G - behind.G) / (2 * h)
    np.testing.assert_allclose(at.rate(v_J), change, atol=1e-5 * (np.abs(at.G).max() + np.abs(change).max()))
    np.testing.assert_allclose(at.bias(v_J), change @ v_J, atol=1e-5 * (np.abs(at.G).max() + np.abs(change).max()))
    np.testing.assert_array_equal(at.hessian, np.swapaxes(at.hessian, 1, 2))


def test_slider_crank_obeys_its_closed_form() -> None:
    crank, rod, angle = 0.05, 0.13, 0.8
    robot, q = slider_crank(crank, rod, angle)
    sine, cosine = math.sin(angle), math.cos(angle)
    root = math.sqrt(rod**2 - (crank * sine) ** 2)
    first = -crank * sine - crank**2 * sine * cosine / root  # dx/dθ
    second = -crank * cosine - crank**2 * (cosine**2 - sine**2) / root - crank**4 * (sine * cosine) ** 2 / root**3
    at = eurdf.transmission(robot, "slide", q)
    assert at.B_J[0, 0] == pytest.approx(first, rel=1e-9)
    # θ(x) is the inverse function: θ'' = -x''/x'³.
    assert at.hessian[0, 0, 0] == pytest.approx(-second / first**3, rel=1e-9)


def test_differential_of_couplings_has_its_matrix() -> None:
    limit = '<axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="4" velocity="3"/>'
    tree = (
        ("motor_1", "base", "gear_1"),
        ("motor_2", "base", "gear_2"),
        ("pitch", "base", "cross"),
        ("roll", "cross", "foot"),
    )
    joints = [joint_element(name, "revolute", parent, child, limit) for name, parent, child in tree]
    text = urdf(body("base"), *(body(child) for _, _, child in tree), *joints)
    yaml = (
        'extended_urdf: "2.1"\nactuators: [motor_1, motor_2]\ncouplings:\n'
        "  - {name: sum, joints: {pitch: 2, motor_1: -1, motor_2: -1}}\n"
        "  - {name: difference, joints: {roll: 4, motor_1: -1, motor_2: 1}}\n"
    )
    robot = load(text, yaml)
    at = eurdf.transmission(robot, ["pitch", "roll"])
    np.testing.assert_allclose(at.G, [[1.0, 2.0], [1.0, -2.0]], atol=1e-12)
    np.testing.assert_array_equal(at.hessian, 0.0)
    limits = eurdf.transmissions.serial_limits(robot, ["pitch", "roll"])
    np.testing.assert_allclose(limits.torque_axes[:, 1], [8.0, 16.0])  # 4 N·m each
    np.testing.assert_allclose(limits.torque_box, [4.0, 8.0])
    found = eurdf.transmissions.actuator_values(robot, {"pitch": 0.3, "roll": -0.1})
    assert found.values == pytest.approx({"motor_1": 0.1, "motor_2": 0.5})


def test_dead_points_leave_the_map_that_exists() -> None:
    crank, rod = 0.05, 0.13
    robot, q = slider_crank(crank, rod, 0.0)  # stretched: the slider is at its farthest
    at = eurdf.transmission(robot, "slide", q)
    assert at.G is None
    assert at.condition is None
    assert (at.rank_motors, at.rank_joints) == (1, 0)
    assert "singular" in at.reason
    assert "'motor' can move while the joints are still" in at.reason
    assert at.joint_velocity([2.0]) == pytest.approx([0.0], abs=1e-12)
    assert at.motor_torque([100.0]) == pytest.approx([0.0], abs=1e-9)  # a straight rod bears any force
    for ask in (at.motor_velocity, at.joint_torque, at.rate):
        with pytest.raises(eurdf.errors.NoTransmission, match="singular"):
            ask([1.0])

    # Driven by the slider, the same pose is a dead point of the motor.
    at = eurdf.transmission(robot, "motor", q, motors="slide")
    assert at.B_J is None
    assert "dead point" in at.inverse_reason
    assert at.undetermined == ("motor",)
    assert at.motor_velocity([2.0]) == pytest.approx([0.0], abs=1e-12)
    with pytest.raises(eurdf.errors.NoTransmission, match="dead point"):
        at.joint_velocity([1.0])


def test_missing_and_undetermined_joints_are_named() -> None:
    robot = eurdf.load("kangaroo_leg", geometry=False)
    at = eurdf.transmission(robot, ["free_ankle_y", "free_ankle_x"])
    assert at.G is None
    assert at.motors == ("motor_leg_length", "motor_ankle_outer", "motor_ankle_inner")
    assert at.missing == ("free_knee",)
    assert "add 'free_knee'" in at.reason
    assert at.B_J.shape == (2, 3)  # it still answers
    assert eurdf.transmission(robot, [*at.joints, *at.missing]).G is not None
    # The knee alone does not depend on the motors of the ankle, which are in its loops.
    assert eurdf.transmission(robot, "free_knee").motors == ("motor_leg_length",)

    robot, q = posed(G1[0])
    at = eurdf.transmission(robot, G1[1], q, motors="motor_a")
    assert at.B_J is None
    assert at.undetermined == G1[1]
    assert "can move while the motors are still" in at.inverse_reason
    np.testing.assert_allclose(at.G, eurdf.transmission(robot, G1[1], q).G[:1], atol=1e-12)


def test_dependent_velocities_are_refused() -> None:
    robot, q = posed(G1[0])
    at = eurdf.transmission(robot, [*G1[1], "universal_rod_a"], q)
    assert at.joints == (*G1[1], "universal_rod_a[0]", "universal_rod_a[1]")
    assert at.rank_joints == 2
    v_J = at.joint_velocity([0.3, -0.2])
    np.testing.assert_allclose(at.motor_velocity(v_J), [0.3, -0.2], atol=1e-12)
    with pytest.raises(eurdf.errors.DependentVelocities, match="do not allow") as raised:
        at.motor_velocity(v_J + np.array([0.0, 0.0, 0.1, 0.0]))
    np.testing.assert_allclose(at.motor_velocity(raised.value.nearest), at.G @ raised.value.nearest)
    with pytest.raises(eurdf.errors.NoTransmission, match="leave out"):
        at.rate(v_J)


def test_redundant_motors_share_a_torque() -> None:
    robot = load(*described(n_bar(4, actuated=["j0", "j3"])))
    at = eurdf.transmission(robot, "j1")
    assert at.motors == ("j0", "j3")
    tau = at.motor_torque([1.0])
    assert at.joint_torque(tau) == pytest.approx([1.0])
    assert at.internal.shape == (2, 1)
    assert at.joint_torque(at.internal[:, 0]) == pytest.approx([0.0], abs=1e-12)
    assert tau @ at.internal[:, 0] == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(eurdf.errors.DependentVelocities):
        at.joint_velocity(at.motor_velocity([1.0]) + at.internal[:, 0])


def sprung(robot: Any, joint: str, rest: float = 0.0) -> Any:
    return with_properties(robot, {joint: {"stiffness": (50.0,), "rest": (rest,)}})


def test_springs_hold_what_no_motor_decides() -> None:
    free = load(*described(n_bar(5)))  # one motor, two motions
    at = eurdf.transmission(free, "j4")
    assert at.undetermined == ("j4",)
    robot = sprung(free, "j2")
    q = eurdf.assemble(robot).q
    at = eurdf.transmission(robot, "j4", q)
    assert at.held == ("j2",)
    h, first = 1e-5, values(robot, q, ("j0",))[0]
    ahead, behind = (eurdf.forward_kinematics(robot, {"j0": first + by}, q) for by in (h, -h))
    differences = (values(robot, ahead, ("j4",)) - values(robot, behind, ("j4",))) / (2 * h)
    assert at.B_J[0] == pytest.approx(differences, rel=1e-6)
    ahead, behind = (eurdf.transmission(robot, "j4", each).G[0, 0] for each in (ahead, behind))
    rate = (ahead - behind) / (2 * h)
    assert at.rate(at.joint_velocity([1.0]))[0, 0] == pytest.approx(rate, rel=1e-4)

    # A deflected spring has no power, so that the torques are static ones.
    deflected = sprung(free, "j2", rest=0.3)
    at = eurdf.transmission(deflected, "j4", q)
    assert np.abs(eurdf.springs.spring_force(deflected, q)).max() > 10.0
    np.testing.assert_allclose(at.motions.T @ eurdf.springs.spring_force(deflected, q), 0.0, atol=1e-9)

    # Two springs on one motion: one of them would deflect.
    with pytest.raises(ValueError, match="the springs of j2, j3 cannot all be held while the motors move"):
        eurdf.transmission(sprung(robot, "j3"), "j4", q)
    many = eurdf.transmission(sprung(robot, "j3"), "j4", q[None])
    assert many.reason == many.inverse_reason == ("springs block",)
    assert np.isnan(many.G).all()

    # A spring beside the motors holds nothing.
    ankle, q = posed(G1[0])
    beside = eurdf.transmission(sprung(ankle, "free_pitch"), G1[1], q)
    assert beside.held == ()
    np.testing.assert_array_equal(beside.G, eurdf.transmission(ankle, G1[1], q).G)


def test_many_configurations_equal_single_ones() -> None:
    robot, first = posed(G1[0])
    qs = np.array([first, posed(G1[0], 1)[1], robot.tree.integrate(first, np.full(robot.model.nv, 0.1))])
    many = eurdf.transmission(robot, G1[1], qs)
    assert len(many) == 3
    assert many.reason == (None, None, "loops open")
    assert many.exists.tolist() == [True, True, False]
    assert np.isnan(many.G[2]).all()
    for each in range(2):
        one = many[each]
        np.testing.assert_allclose(many.G[each], one.G, atol=1e-12)
        np.testing.assert_allclose(many.B_J[each], one.B_J, atol=1e-12)
        assert many.condition[each] == pytest.approx(one.condition)
    with pytest.raises(eurdf.errors.NotClosable, match="assemble first"):
        many[2]
    stretched, q = slider_crank(0.05, 0.13, 0.0)
    many = eurdf.transmission(stretched, "slide", q[None])
    assert many.reason == ("singular",)
    assert many.inverse_reason == (None,)
    assert np.isnan(many.condition[0])


@pytest.mark.parametrize(
    ("joints", "motors", "message"),
    [
        ("free_pich", None, "did you mean 'free_pitch'"),
        ([], None, "name at least one joint"),
        (["free_pitch", "free_pitch"], None, "twice"),
        ("free_pitch", "motor_c", "did you mean 'motor_"),
        ("free_pitch", [], "motors is empty"),
    ],
)
def test_wrong_names_are_refused(joints: Any, motors: Any, message: str) -> None:
    robot = eurdf.load(G1[0], geometry=False)
    with pytest.raises(ValueError, match=message):
        eurdf.transmission(robot, joints, motors=motors)


def test_joints_without_motors_are_refused() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    with pytest.raises(ValueError, match="is spherical"):
        eurdf.transmission(robot, "ball_rod1_end")
    robot = load(*described(n_bar(5, actuated=[])))
    with pytest.raises(ValueError, match="no actuator moves 'j4'"):
        eurdf.transmission(robot, "j4")
