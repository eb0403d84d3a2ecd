"""The tangent space far from singularities and at them: null space, pseudoinverse and rank of the dimensionless K."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eurdf
from benchmarks.loops import four_bars
from eurdf.collection import collection_names
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.kinematics.tangent_space import LeastSolutions, TangentSpaces
from support.linkage import n_bar, slider_crank, stewart


def check(robot: Any, q: Any) -> int:
    """Compare with a decomposition of all of K; return its rank."""
    spaces, (_, K) = TangentSpaces(robot), residual_and_jacobian(robot, q)
    space, A = spaces.at(K), K * spaces.dimensionless
    values = np.linalg.svd(A, compute_uv=False)
    rank = numerical_rank(values, values.max(initial=0.0))
    f, one = K.shape[1] - rank, np.eye(K.shape[1] - rank)
    assert space.basis.shape == space.free.shape == (K.shape[1], f)
    np.testing.assert_allclose(space.basis.T @ space.basis, one, rtol=0.0, atol=1e-12)
    free = space.free / spaces.scale[:, None]
    np.testing.assert_allclose(free.T @ free, one, rtol=0.0, atol=1e-12)
    for basis in (space.basis, space.free):
        np.testing.assert_allclose(A @ (basis / spaces.scale[:, None]), 0.0, atol=1e-10 * values[0])
    row_scale = spaces.dimensionless[:, 0] / spaces.scale[0]
    expected = spaces.scale[:, None] * np.linalg.pinv(A, rcond=0.5 * values[rank - 1] / values[0]) * row_scale
    np.testing.assert_allclose(space.inverse, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    return rank


@pytest.mark.parametrize("name", [name for name in collection_names() if eurdf.load(name, geometry=False).constraints])
def test_robot_has_a_tangent_space(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    q = eurdf.assemble(robot).q
    away = np.random.default_rng(0).uniform(-0.05, 0.05, robot.tree.nv)
    check(robot, q)
    check(robot, eurdf.assemble(robot, robot.tree.integrate(q, away)).q)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("build", [lambda size: n_bar(5, size=size), lambda size: slider_crank(size=size)])
def test_redundant_rows_at_any_size(build: Any, size: float) -> None:
    robot = build(size)
    assert check(robot, robot.tree.neutral()) == 3


def test_rank_in_doubt_is_that_of_the_singular_values() -> None:
    """Rows that are nearly dependent: both sides of what is certain."""
    robot = stewart()
    spaces, (_, K) = TangentSpaces(robot), residual_and_jacobian(robot, robot.tree.neutral())
    for apart in (1e-12, 1e-7, 1e-5, 1e-3, 1e-1):
        near = np.array(K)
        near[-1] = near[0] + apart * near[-1]
        values = np.linalg.svd(near * spaces.dimensionless, compute_uv=False)
        free = K.shape[1] - numerical_rank(values, values[0])
        assert spaces.at(near).basis.shape[1] == free


def test_loops_of_one_shape_are_decomposed_alike() -> None:
    """Four loops of three rows, two with a redundant one."""
    robot = four_bars(4, in_series=True)
    spaces, (_, K) = TangentSpaces(robot), residual_and_jacobian(robot, np.linspace(0.1, 1.2, 12))
    for first in (0, 6):
        K[first : first + 3, first : first + 3] = np.random.default_rng(first).normal(size=(3, 3))
    space, A = spaces.at(K), K * spaces.dimensionless
    assert np.linalg.matrix_rank(A) == 10
    assert space.basis.shape[1] == 2
    np.testing.assert_allclose(K @ space.basis, 0.0, atol=1e-12)
    expected = spaces.scale[:, None] * np.linalg.pinv(A, rcond=1e-9) * spaces.row_scale
    np.testing.assert_allclose(space.inverse, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["cassie_leg", "five_bar", "double_wishbone"])
@pytest.mark.parametrize("size", [1e-10, 1.0])
def test_least_solutions_of_moving_robot(name: str, size: float) -> None:
    """Those of the K before serve nearby, where a redundant row stays one, and not far away."""
    robot, random = eurdf.load(name, geometry=False), np.random.default_rng(0)
    spaces, q = TangentSpaces(robot), eurdf.assemble(robot).q
    least, along = LeastSolutions(spaces), eurdf.project_velocity(robot, q, random.normal(size=robot.tree.nv))
    for distance in (0.0, 1e-3, 2e-3, 0.2):
        _, K = residual_and_jacobian(robot, eurdf.assemble(robot, robot.tree.integrate(q, distance * along)).q)
        b = size * K @ random.normal(size=robot.tree.nv)
        (v,) = least.of(K, b[None], 1e-6 * size)
        np.testing.assert_allclose(K @ v, b, rtol=0.0, atol=2e-6 * size)
        exact = spaces.at(K).inverse @ b
        accuracy = 1e-9 if size == 1.0 else 0.1
        np.testing.assert_allclose(v, exact, rtol=0.0, atol=accuracy * np.abs(exact).max())
