"""Derivatives of the dynamics and of closed motions, against differences of the functions themselves."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics import dq_dq_actuated, dq_dq_actuated_derivative, inverse_dynamics_derivatives
from eurdf.pinocchio.robot import build_robot
from support.differences import near, near_slope, slope

TAU, U = 0.7, 1.3  # scales of forces
STEPS = (3e-3, 3e-4, 3e-5)  # rad and m

#: Robots whose rows agree also where the loops are open; and robots with redundant rows that then contradict.
AGREEING = ("delta", "digit_leg", "double_wishbone", "four_bar", "robotiq_2f85", "tello", "unitree_g1_ankle")
REDUNDANT = ("bennett", "sarrus", "screw_press", "toddlerbot_2legs")


def closed(robot: Any, q: Any) -> Any:
    """The configuration near q at which the loops are closed to rounding."""
    for _ in range(6):
        r, K = eurdf.residual_and_jacobian(robot, q)
        q = robot.tree.normalized(robot.tree.integrate(q, -np.linalg.pinv(K, rcond=1e-4) @ r))
    return q


class Motion:
    """A smooth motion of a robot that stays closed, by a parameter t, with motor torques and forces."""

    def __init__(self, robot: Any, seed: int = 0) -> None:
        self.robot, random, nv = robot, np.random.default_rng(seed), robot.tree.nv
        q = eurdf.assemble(robot).q
        self.q = closed(robot, robot.tree.integrate(q, 0.02 * random.normal(size=nv)))
        self.along = eurdf.project_velocity(robot, self.q, random.uniform(-1.0, 1.0, nv))
        self.v, self.v_rate, self.tau, self.tau_rate = random.normal(size=(4, nv))
        self.u, self.u_rate = U * random.normal(size=(2, len(robot.actuation.idx_v)))

    def at(self, t: float) -> tuple[Any, Any, Any, Any]:
        q = closed(self.robot, self.robot.tree.integrate(self.q, t * self.along))
        v = eurdf.project_velocity(self.robot, q, self.v + t * self.v_rate)
        return q, v, self.u + t * self.u_rate, TAU * (self.tau + t * self.tau_rate)

    def rate(self, step: float = 1e-3) -> tuple[Any, Any]:
        """The rates of q and v at t = 0."""
        q = self.at(0.0)[0]
        return (
            slope(lambda t: self.robot.tree.difference(q, self.at(t)[0]), step),
            slope(lambda t: self.at(t)[1], step),
        )


def robot_called(name: str) -> Any:
    return eurdf.load(name, geometry=False)


def stacked(found: Any) -> Any:
    return np.concatenate((found[0], *found.forces))


@pytest.mark.parametrize("name", [*AGREEING, *REDUNDANT])
def test_forward_derivatives_along_closed_motion(name: str) -> None:
    motion = Motion(robot_called(name))

    def dynamics(t: float) -> Any:
        q, v, u, tau = motion.at(t)
        return stacked(eurdf.forward_dynamics(motion.robot, q, v, u, tau=tau))

    q, v, u, tau = motion.at(0.0)
    found, (q_rate, v_rate) = eurdf.dynamics_derivatives(motion.robot, q, v, u, tau=tau), motion.rate()
    expected, nv = slope(dynamics, 1e-3), len(v)
    tau_rate = TAU * motion.tau_rate
    a = found.a_q @ q_rate + found.a_v @ v_rate + found.a_u @ motion.u_rate + found.a_tau @ tau_rate
    near(a, expected[:nv], 1e-7)
    forces = found.lambda_q @ q_rate + found.lambda_v @ v_rate
    near(forces + found.lambda_u @ motion.u_rate + found.lambda_tau @ tau_rate, expected[nv:], 1e-7)
    near(np.concatenate((found.a, found.lambdas)), dynamics(0.0), 1e-8)


@pytest.mark.parametrize("name", AGREEING)
def test_forward_derivatives_of_open_robot_with_gains_and_damping(name: str) -> None:
    robot, random = robot_called(name), np.random.default_rng(1)
    tree, nv = robot.tree, robot.tree.nv
    q = tree.integrate(eurdf.assemble(robot).q, 1e-3 * random.normal(size=nv))
    v, w, v_rate = random.normal(size=(3, nv))
    options: Any = {"gains": (20.0, 5.0), "dissipation": True}
    found = eurdf.dynamics_derivatives(robot, q, v, **options)

    def dynamics(t: float) -> Any:
        return stacked(eurdf.forward_dynamics(robot, tree.integrate(q, t * w), v + t * v_rate, **options))

    near_slope(found.a_q @ w + found.a_v @ v_rate, lambda t: dynamics(t)[:nv], STEPS, 1e-6)
    near_slope(found.lambda_q @ w + found.lambda_v @ v_rate, lambda t: dynamics(t)[nv:], STEPS, 1e-6)


def test_rows_that_contradict_each_other_are_refused() -> None:
    robot = robot_called("bennett")
    with pytest.raises(ValueError, match=r"redundant rows of K contradict each other, by \S+ \(m/s², rad/s²\)"):
        eurdf.dynamics_derivatives(robot, eurdf.assemble(robot).q, np.ones(robot.tree.nv))


@pytest.mark.parametrize("name", ["digit_leg", "four_bar", "double_wishbone"])
def test_batch_equals_single_ones(name: str) -> None:
    motion = Motion(robot_called(name))
    states = [motion.at(0.01 * index) for index in range(4)]
    q, v, u, tau = (np.array(each) for each in zip(*states, strict=True))
    together = eurdf.batch.dynamics_derivatives(motion.robot, q, v, u, tau=tau, block=3)
    for index, (q_i, v_i, u_i, tau_i) in enumerate(states):
        one = eurdf.dynamics_derivatives(motion.robot, q_i, v_i, u_i, tau=tau_i)
        for alone, each in zip(one, together, strict=True):
            near(each[index], alone, 1e-9)
    with pytest.raises(ValueError, match=r"v has 3 rows; expected 4"):
        eurdf.batch.dynamics_derivatives(motion.robot, q, v[:3])
    assert eurdf.batch.dynamics_derivatives(motion.robot, q[:0], v[:0]).a_q.shape == (0, v.shape[1], v.shape[1])


def with_motors(name: str, *joints: str) -> Any:
    return build_robot(replace(robot_called(name).mechanism, actuators=joints, motors={}), geometry=False)


@pytest.mark.parametrize("name", ["digit_leg", "four_bar", "delta", "robotiq_2f85", "more motors than motions"])
def test_inverse_derivatives_along_closed_motion(name: str) -> None:
    more = name == "more motors than motions"
    robot = with_motors("dextar", *robot_called("dextar").slots) if more else robot_called(name)
    motion = Motion(robot)
    weights = np.random.default_rng(2).uniform(0.5, 2.0, len(motion.u))

    def moving(t: float) -> Any:
        q, v, u, tau = motion.at(t)
        return q, v, eurdf.forward_dynamics(robot, q, v, u, tau=tau).a, tau

    def inverse(t: float) -> Any:
        q, v, a, _ = moving(t)
        return stacked(eurdf.inverse_dynamics(robot, q, v, a, tau=TAU * motion.tau, weights=weights))

    motion.tau_rate = np.zeros_like(motion.tau)  # the derivatives are at constant τ
    q, v, a, tau = moving(0.0)
    found, (q_rate, v_rate) = inverse_dynamics_derivatives(robot, q, v, a, tau=tau, weights=weights), motion.rate()
    a_rate, expected, nu = slope(lambda t: moving(t)[2], 1e-3), slope(inverse, 1e-3), len(motion.u)
    near(found.u_q @ q_rate + found.u_v @ v_rate + found.u_a @ a_rate, expected[:nu], 1e-7)
    near(found.lambda_q @ q_rate + found.lambda_v @ v_rate + found.lambda_a @ a_rate, expected[nu:], 1e-7)


@pytest.mark.parametrize("name", ["delta", "digit_leg", "five_bar", "stewart_platform", "unitree_g1_ankle"])
def test_closed_motions_bend_as_differences(name: str) -> None:
    motion = Motion(robot_called(name))
    D, H = dq_dq_actuated(motion.robot, motion.q), dq_dq_actuated_derivative(motion.robot, motion.q)
    motion.along = D @ motion.u
    near(H @ motion.u, slope(lambda t: dq_dq_actuated(motion.robot, motion.at(t)[0]), 1e-3), 1e-7)


def test_derivatives_without_loops_equal_pinocchio() -> None:
    mechanism = replace(robot_called("digit_leg").mechanism, closures=(), configurations={})
    robot, random = build_robot(mechanism, geometry=False), np.random.default_rng(3)
    model, nv = robot.model, robot.model.nv
    q = pin.integrate(model, pin.neutral(model), random.uniform(-1.0, 1.0, nv))
    v, tau = random.normal(size=(2, nv))
    found = eurdf.dynamics_derivatives(robot, q, v, tau=tau)
    for one, other in zip(
        (found.a_q, found.a_v), pin.computeABADerivatives(model, robot.data, q, v, tau), strict=False
    ):
        near(one, other, 1e-9)
    assert found.lambda_q.shape == (0, nv)


@pytest.mark.parametrize("name", ["digit_leg", "stewart_platform"])
def test_derivatives_of_welds_equal_pinocchio(name: str) -> None:
    motion = Motion(robot_called(name))
    q, v, u, _ = motion.at(0.0)
    model, data, settings = motion.robot.model, motion.robot.data, pin.ProximalSettings(1e-14, 1e-14, 1e-9, 100)
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for each in motion.robot.constraint_models:
        models.append(each)
        datas.append(each.createData())
    pin.initConstraintDynamics(model, data, models, datas)
    pin.constraintDynamics(model, data, q, v, motion.robot.actuation.selection @ u, models, datas, settings)
    pin.computeConstraintDynamicsDerivatives(model, data, models, datas, settings)
    found = eurdf.dynamics_derivatives(motion.robot, q, v, u)
    for one, other in ((found.a_q, data.ddq_dq), (found.a_v, data.ddq_dv), (found.a_tau, data.ddq_dtau)):
        near(one, other, 1e-8)
