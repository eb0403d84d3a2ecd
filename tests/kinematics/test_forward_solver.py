"""Where forward dynamics trusts the simulator's solver, and where it eliminates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.kinematics import forward_solver
from eurdf.kinematics.equation_of_motion import EquationOfMotion
from eurdf.kinematics.independence import INDEPENDENT, Independence
from support.linkage import loop, stretched, weighted

seeds = st.integers(0, 2**32 - 1)


class Counted:
    """Counts the eliminations within a context."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.count = 0
        counted = self

        class Counting(EquationOfMotion):
            def eliminate(self, *arguments: Any) -> Any:
                counted.count += 1
                return super().eliminate(*arguments)

        monkeypatch.setattr(forward_solver, "EquationOfMotion", Counting)


@pytest.fixture
def eliminations(monkeypatch: pytest.MonkeyPatch) -> Counted:
    return Counted(monkeypatch)


def state(robot: Any, seed: int = 0, reach: float = 0.1) -> tuple[Any, Any]:
    random = np.random.default_rng(seed)
    first = eurdf.assemble(robot).q
    q = eurdf.assemble(robot, pin.integrate(robot.model, first, random.uniform(-reach, reach, robot.model.nv))).q
    return q, eurdf.project_velocity(robot, q, random.uniform(-1.0, 1.0, robot.model.nv))


def by_pinocchio(robot: Any, q: Any, v: Any, tau: Any) -> tuple[Any, Any]:
    """Acceleration and λ by `pin.constraintDynamics`."""
    model, data = robot.model, robot.model.createData()
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    for constraint_model in robot.constraint_models:
        models.append(constraint_model)
        datas.append(constraint_model.createData())
    pin.initConstraintDynamics(model, data, models, datas)
    a = pin.constraintDynamics(model, data, q, v, tau, models, datas, pin.ProximalSettings(1e-14, 1e-14, 1e-8, 50))
    return np.array(a), -np.array(data.lambda_c)


@pytest.mark.parametrize("name", ["digit_leg", "kangaroo_leg", "stewart_platform", "talos_leg"])
def test_regular_robot_is_solved_without_elimination(name: str, eliminations: Counted) -> None:
    robot = eurdf.load(name, geometry=False)
    for seed in range(3):
        q, v = state(robot, seed)
        tau = np.random.default_rng(seed).normal(size=robot.model.nv)
        found = eurdf.forward_dynamics(robot, q, v, tau=tau)
        assert eliminations.count == 0
        a, lambdas = by_pinocchio(robot, q, v, tau)
        np.testing.assert_allclose(found.a, a, atol=1e-9 * np.abs(a).max())
        np.testing.assert_allclose(np.concatenate(found.forces), lambdas, atol=1e-9 * np.abs(lambdas).max())
        exact = EquationOfMotion(robot, q, v, robot.tree.dynamics(robot.data)).eliminate(
            tau, [(0.0, 0.0)] * len(robot.constraints)
        )
        np.testing.assert_allclose(found.a, exact.a, atol=1e-8 * np.abs(a).max())
        np.testing.assert_allclose(np.concatenate(found.forces), exact.lambdas, atol=1e-7 * np.abs(lambdas).max())


KINDS = ["doggo_leg", "double_wishbone", "robotiq_2f85", "screw_press", "tello", "toddlerbot_2legs"]


@pytest.mark.parametrize("name", ["five_bar", "four_bar", "sarrus", "planar_3rrr", *KINDS])
def test_every_kind_and_redundant_rows_get_forces_of_elimination(name: str, eliminations: Counted) -> None:
    robot = eurdf.load(name, geometry=False)
    q, v = state(robot)
    springs = eurdf.springs.spring_force(robot, q)
    found = eurdf.forward_dynamics(robot, q, v)
    assert eliminations.count == 0
    exact = EquationOfMotion(robot, q, v, robot.tree.dynamics(robot.data)).eliminate(
        springs, [(0.0, 0.0)] * len(robot.constraints)
    )
    np.testing.assert_allclose(found.a, exact.a, atol=1e-9 * np.abs(exact.a).max())
    largest = np.abs(exact.lambdas).max()
    np.testing.assert_allclose(np.concatenate(found.forces), exact.lambdas, atol=1e-8 * largest)
    _, K = eurdf.residual_and_jacobian(robot, q)
    h = pin.rnea(robot.model, robot.data, q, v, found.a) - springs
    np.testing.assert_allclose(K.T @ np.concatenate(found.forces), h, atol=1e-9 * (1.0 + np.abs(h).max()))


@pytest.mark.parametrize("name", ["double_wishbone", "robotiq_2f85", "tello"])
def test_gains_act_on_rows_of_every_kind(name: str, eliminations: Counted) -> None:
    """Ajar by less than 1e-9, with gains so large that it matters."""
    robot = eurdf.load(name, geometry=False)
    (q, _), random = state(robot), np.random.default_rng(1)
    q = robot.tree.normalized(robot.tree.integrate(q, 1e-10 * random.normal(size=robot.tree.nv)))
    v = 1e-10 * random.normal(size=robot.tree.nv)
    found, free = eurdf.forward_dynamics(robot, q, v, gains=(1e10, 1e9)), eurdf.forward_dynamics(robot, q, v)
    assert eliminations.count == 0
    exact = EquationOfMotion(robot, q, v, robot.tree.dynamics(robot.data)).eliminate(
        eurdf.springs.spring_force(robot, q), [(1e10, 1e9)] * len(robot.constraints)
    )
    assert np.abs(found.a - free.a).max() > 0.01
    np.testing.assert_allclose(found.a, exact.a, atol=1e-6 * np.abs(exact.a).max())


@pytest.mark.parametrize(("bend", "rank", "eliminated"), [(1e-2, 3, 0), (1e-3, 3, 1), (0.0, 2, 0)])
def test_elimination_decides_near_singular_pose(bend: float, rank: int, eliminated: int, eliminations: Counted) -> None:
    robot, zero = stretched(bend), np.zeros(4)
    assert eurdf.analyze(robot, zero).rank == rank
    found = eurdf.forward_dynamics(robot, zero, zero, tau=np.ones(4))
    assert eliminations.count == eliminated
    _, K = eurdf.residual_and_jacobian(robot, zero)
    N = np.linalg.svd(K)[2][rank:].T
    M = eurdf.mass_matrix(robot, zero)
    h = pin.rnea(robot.model, robot.model.createData(), zero, zero, zero)
    expected = N @ np.linalg.solve(N.T @ M @ N, N.T @ (np.ones(4) - h))
    np.testing.assert_allclose(found.a, expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize(("decimals", "eliminated"), [(None, 0), (6, 1)])
def test_elimination_decides_on_rounded_redundant_rows(
    decimals: int | None, eliminated: int, eliminations: Counted
) -> None:
    corners = [(0.0, 0.0, 0.0), (0.1, 1.0, 0.2), (1.2, 1.1, 0.5), (1.1, 0.1, 0.3)]
    axis = np.array([0.3, -0.4, 1.0])
    plane = [np.array(corner) - axis * (axis @ corner) / (axis @ axis) for corner in corners]
    robot = weighted(loop([("R", tuple(corner), tuple(axis)) for corner in plane], decimals=decimals))
    q = eurdf.assemble(robot).q
    eurdf.forward_dynamics(robot, q, np.zeros(4))
    assert eliminations.count == eliminated


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_unit_of_length_does_not_matter(size: float, eliminations: Counted) -> None:
    robot, zero = stretched(0.3, size), np.zeros(4)
    tau = np.array([1.0, size, size, size])  # forces are alike, and moments are like the size
    found = eurdf.forward_dynamics(robot, zero, zero, tau=tau)
    assert eliminations.count == 0
    scale = np.array([size, 1.0, 1.0, 1.0])
    one = stretched(0.3)
    one.model.gravity.linear = one.model.gravity.linear / size
    same = eurdf.forward_dynamics(one, zero, zero, tau=np.ones(4) / size)
    np.testing.assert_allclose(found.a / scale, same.a, rtol=1e-7, atol=1e-9 * np.abs(same.a).max())


@given(seed=seeds, size=st.floats(-4.0, 0.0), change=st.floats(-9.0, 0.0))
@settings(max_examples=100, deadline=None)
def test_what_is_kept_changes_no_decision(seed: int, size: float, change: float) -> None:
    random = np.random.default_rng(seed)
    K = random.normal(size=(3, 5))
    K[2] = K[0] + 10.0**size * K[2]
    after, fresh = Independence(np.ones(3), np.ones(5)), Independence(np.ones(3), np.ones(5))
    after.is_shown(K)
    near = K + 10.0 ** (change + size) * random.normal(size=(3, 5))
    assert after.is_shown(near) == fresh.is_shown(near)
    values = np.linalg.svd(near, compute_uv=False)
    assert not fresh.is_shown(near) or values[2] ** 2 * INDEPENDENT >= values[0] ** 2


@pytest.mark.parametrize("off", [0.0, 1e-14, 1e-9, 1e-5, 1e-1])
@pytest.mark.parametrize("moved", [0.0, 1e-4, 1e-1, 10.0])
def test_kept_redundant_rows_change_no_forces(moved: float, off: float) -> None:
    random = np.random.default_rng(0)
    mix, rows = np.array([[1.0, 0.0], [0.0, 1.0], [0.6, -0.8]]), random.normal(size=(2, 5))
    after, fresh = Independence(np.ones(3), np.ones(5)), Independence(np.ones(3), np.ones(5))
    assert after.least_forces(mix @ rows, np.ones(3)) is not None
    # Near or far, with the same redundancy or another rank.
    K = mix @ (rows + moved * random.normal(size=(2, 5))) + off * random.normal(size=(3, 5))
    lambdas = random.normal(size=3)
    found, expected = after.least_forces(K, lambdas), fresh.least_forces(K, lambdas)
    assert (found is None) == (expected is None) == (off in (1e-9, 1e-5))
    if found is not None and expected is not None:
        np.testing.assert_allclose(found, expected, atol=1e-9)
        np.testing.assert_allclose(K.T @ found, K.T @ lambdas, atol=1e-9 * np.abs(K).max())


def test_open_mechanism_is_eliminated(eliminations: Counted) -> None:
    robot = eurdf.load("cassie_leg", geometry=False)
    q, v = state(robot)
    ajar = pin.integrate(robot.model, q, 1e-8 * np.ones(robot.model.nv))
    eurdf.forward_dynamics(robot, ajar, v)
    eurdf.forward_dynamics(robot, q, v + 1e-8)
    assert eliminations.count == 2
    eurdf.forward_dynamics(robot, q, v)
    assert eliminations.count == 2
