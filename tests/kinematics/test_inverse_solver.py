"""Where inverse dynamics trusts the independence of constraints and motors, and where a decomposition decides."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics import dynamics
from eurdf.kinematics.equation_of_motion import EquationOfMotion
from eurdf.kinematics.inverse_solver import InverseSolver
from support.linkage import stretched


@pytest.fixture
def decompositions(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """One entry for each state that is decomposed."""
    found: list[Any] = []

    class Counting(EquationOfMotion):
        def __init__(self, *arguments: Any) -> None:
            found.append(arguments)
            super().__init__(*arguments)

    monkeypatch.setattr(dynamics, "EquationOfMotion", Counting)
    return found


@pytest.mark.parametrize("name", ["digit_leg", "cassie_leg", "stewart_platform", "delta"])
def test_both_ways_give_same_torques(name: str, decompositions: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    robot, random = eurdf.load(name, geometry=False), np.random.default_rng(0)
    tree, first = robot.tree, eurdf.assemble(robot).q
    q = eurdf.assemble(robot, tree.integrate(first, random.uniform(-0.05, 0.05, tree.nv))).q
    v = eurdf.project_velocity(robot, q, random.uniform(-1.0, 1.0, tree.nv))
    a, tau = eurdf.project_acceleration(robot, q, v, random.uniform(-1.0, 1.0, tree.nv)), random.normal(size=tree.nv)
    a = eurdf.kinematics.achievable_acceleration(robot, q, v, a, tau=tau)
    decompositions.clear()
    one = eurdf.inverse_dynamics(robot, q, v, a, tau=tau)
    assert not decompositions
    np.testing.assert_allclose(eurdf.forward_dynamics(robot, q, v, one.u, tau=tau).a, a, atol=1e-8 * np.abs(a).max())
    monkeypatch.setattr(InverseSolver, "solve", lambda *arguments: None)
    other = eurdf.inverse_dynamics(robot, q, v, a, tau=tau)
    assert len(decompositions) == 1
    np.testing.assert_allclose(one.u, other.u, atol=1e-9 * np.abs(other.u).max())
    forces = np.concatenate(other.forces)
    np.testing.assert_allclose(np.concatenate(one.forces), forces, atol=1e-9 * np.abs(forces).max())


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("bend", "decomposed"), [(1e-2, 0), (1e-3, 1), (0.0, 1)])
def test_decomposition_decides_near_singular_pose(
    bend: float, decomposed: int, size: float, decompositions: list[Any]
) -> None:
    robot, zero = stretched(bend, size, ("j0",)), np.zeros(4)
    given = np.array([3.0])
    found = eurdf.inverse_dynamics(robot, zero, zero, eurdf.forward_dynamics(robot, zero, zero, given).a)
    assert len(decompositions) == decomposed
    np.testing.assert_allclose(found.u, given, rtol=1e-6)


@pytest.mark.parametrize("name", ["five_bar", "four_bar", "planar_3rrr"])
def test_decomposition_decides_on_redundant_planar_loops(name: str, decompositions: list[Any]) -> None:
    robot = eurdf.load(name, geometry=False)
    q, still = eurdf.assemble(robot).q, np.zeros(robot.model.nv)
    given = np.linspace(1.0, 2.0, len(robot.actuation.joints))
    found = eurdf.inverse_dynamics(robot, q, still, eurdf.forward_dynamics(robot, q, still, given).a)
    assert len(decompositions) == 1
    np.testing.assert_allclose(found.u, given, rtol=1e-6)


def test_tolerance_decides_on_small_uncontrolled_motion() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q, still, S = eurdf.assemble(robot).q, np.zeros(27), robot.actuation.selection
    u = np.ones(6)
    a = eurdf.forward_dynamics(robot, q, still, u).a
    # The rods turn about themselves: no motor moves them.
    _, K = eurdf.residual_and_jacobian(robot, q)
    spin = np.linalg.svd(np.vstack((K, S.T)))[2][-1]
    spin *= 1e-6 * (1.0 + np.abs(a).max()) / np.abs(spin).max()
    for share in (1e-3, 0.3, 0.9):
        np.testing.assert_allclose(eurdf.inverse_dynamics(robot, q, still, a + share * spin).u, u, atol=1e-6)
    with pytest.raises(eurdf.errors.UnderactuatedMotion):
        eurdf.inverse_dynamics(robot, q, still, a + 1.1 * spin)


def test_diagonal_of_inverse_mass_matrix_includes_armature() -> None:
    robot = eurdf.load("cassie_leg", geometry=False)
    robot.model.armature = np.linspace(0.1, 0.3, robot.model.nv)
    q = pin.randomConfiguration(robot.model, -np.ones(robot.model.nq), np.ones(robot.model.nq))
    expected = np.linalg.inv(eurdf.mass_matrix(robot, q)).diagonal()
    np.testing.assert_allclose(robot.tree.dynamics(robot.data).inverse_mass_diagonal(q), expected, rtol=1e-8)
