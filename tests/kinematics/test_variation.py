"""How the terms of the equation of motion and of the constraints vary, against differences of the sixth order."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.kinematics.evaluate import evaluator
from eurdf.kinematics.holding import holding
from eurdf.kinematics.residual import acceleration_drift
from eurdf.kinematics.variation import MotionState, Structure, Variation
from eurdf.pinocchio.tree_dynamics import TreeRecursion
from support.differences import near, near_slope
from support.mechanisms import closed_tree

seeds = st.integers(0, 2**32 - 1)
KP, KD = 3.0, 2.0  # 1/s², 1/s
STEPS = (3e-3, 6e-4)  # rad and m


def some_state(robot: Any, q: Any, random: np.random.Generator, dynamics: Any = None) -> tuple[Any, ...]:
    """A state at q with random v, a and λ."""
    nv, m = robot.tree.nv, robot.mechanism.nc
    v, a, lambdas = random.normal(size=nv), random.normal(size=nv), random.normal(size=m)
    known = Structure(robot), dynamics or robot.tree.dynamics(), evaluator(robot, few=True)
    return MotionState(*known, q[None], v[None], a[None]), v, a, lambdas


def variation_of(robot: Any, state: MotionState, lambdas: Any) -> Variation:
    gains = np.tile([KP, KD], (len(robot.constraints), 1))
    return state.variation(lambdas[None], gains, dissipation=True)


def check(robot: Any, q: Any, random: np.random.Generator) -> None:
    """Compare the derivatives along one random motion: a wrong column has a part in it."""
    state, v, a, lambdas = some_state(robot, q, random)
    found, tree, nv = variation_of(robot, state, lambdas), robot.tree, robot.tree.nv
    dynamics, x, w = tree.dynamics(), random.normal(size=nv), random.uniform(-1.0, 1.0, nv)

    def F(q: Any, v: Any, a: Any) -> Any:  # noqa: N802 - the symbol of the module
        _, K = eurdf.residual_and_jacobian(robot, q)
        return dynamics.inverse_dynamics(q, v, a) - tree.springs.force(q, nv) + tree.damping * v - lambdas @ K

    def C(q: Any, v: Any, a: Any) -> Any:  # noqa: N802
        r, K = eurdf.residual_and_jacobian(robot, q)
        return K @ (a + KD * v) + acceleration_drift(robot, q, v) + KP * r

    def jacobian(t: float) -> Any:
        return eurdf.residual_and_jacobian(robot, tree.integrate(q, t * w))[1]

    near(found.K[0], jacobian(0.0), 1e-12)
    near(found.M[0], eurdf.mass_matrix(robot, q), 1e-12)
    for of, by_q, by_v, by_a in ((F, found.F_q, found.F_v, found.M), (C, found.C_q, found.C_v, found.K)):
        near_slope(by_q[0] @ w, partial(_along, of, tree, (q, v, a), (w, 0.0, 0.0)), STEPS)
        near_slope(by_v[0] @ w, partial(_along, of, tree, (q, v, a), (0.0 * w, w, 0.0)), [0.1])
        near_slope(by_a[0] @ w, partial(_along, of, tree, (q, v, a), (0.0 * w, 0.0, w)), [0.1])
    near_slope(state.of_velocity(x[None])[0] @ w, lambda t: jacobian(t) @ x, STEPS)
    near_slope(state.of_forces(lambdas[None])[0] @ w, lambda t: lambdas @ jacobian(t), STEPS)


def _along(of: Any, tree: Any, at: Any, rates: Any, t: float) -> Any:
    (q, v, a), (q_rate, v_rate, a_rate) = at, rates
    return of(tree.integrate(q, t * q_rate), v + t * v_rate, a + t * a_rate)


@pytest.mark.parametrize("name", eurdf.collection_names())
def test_terms_of_open_robot_vary_as_differences(name: str) -> None:
    robot, random = eurdf.load(name, geometry=False), np.random.default_rng(1)
    q = eurdf.assemble(robot).q
    check(robot, robot.tree.integrate(q, 0.05 * random.normal(size=robot.tree.nv)), random)


@given(seed=seeds, root=st.sampled_from(["fixed", "floating"]), reach=st.sampled_from([0.0, 0.3]))
@settings(max_examples=10, deadline=None)
def test_terms_vary_as_differences_for_every_joint_and_constraint(seed: int, root: Any, reach: float) -> None:
    random = np.random.default_rng(seed)
    robot, q = closed_tree(random, root=root)
    check(robot, robot.tree.integrate(q, reach * random.uniform(-1.0, 1.0, robot.tree.nv)), random)


def test_terms_of_contacts_and_held_axes_vary_as_differences() -> None:
    digit, leg = (eurdf.load(name, geometry=False) for name in ("digit_2legs", "digit_leg"))
    standing = digit.with_contacts({"left_sole": "6d", "right_sole": {"type": "hinge", "axis": [0, 1, 0]}})
    held = holding(leg, eurdf.assemble(leg).q, [("ball_rod1_start", "z")], None).robot
    for robot in (standing, held):
        random = np.random.default_rng(3)
        q = robot.tree.integrate(eurdf.assemble(robot).q, 0.05 * random.normal(size=robot.tree.nv))
        check(robot, q, random)


@pytest.mark.parametrize("name", ["delta", "digit_2legs", "double_wishbone"])
def test_numpy_equals_pinocchio(name: str) -> None:
    robot, found = eurdf.load(name, geometry=False), []
    for dynamics in (robot.tree.dynamics(), TreeRecursion(robot.model, robot.tree.springs)):
        state, *_, lambdas = some_state(robot, eurdf.assemble(robot).q, np.random.default_rng(2), dynamics)
        found.append(variation_of(robot, state, lambdas))
    for one, other in zip(*found, strict=True):
        near(one, other, 1e-12)
