"""The velocities that follow driven joints: equal to least squares, and only where no rank is in doubt."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import eurdf
from eurdf.kinematics.driven_motion import DrivenMotion
from eurdf.kinematics.least_solution import CERTAIN, least_solution
from eurdf.kinematics.residual import residual_and_jacobian
from support.linkage import X, Z, loop, n_bar, slider_crank, stewart, three_rrr

SOME = ("bennett", "cassie_leg", "delta", "digit_2legs", "five_bar", "kangaroo_2legs", "planar_3rrr", "talos_2legs")


def by_least_squares(robot: Any, q: Any) -> Any:
    """The derivative (nv, nu), column by column, from K alone."""
    _, K = residual_and_jacobian(robot, q)
    driven = robot.actuation.idx_v
    free = np.setdiff1d(np.arange(robot.tree.nv), driven)
    D = np.zeros((robot.tree.nv, len(driven)))
    D[driven, np.arange(len(driven))] = 1.0
    D[free] = np.linalg.lstsq(K[:, free], -K[:, driven], rcond=1e-9)[0]
    return D


def check(robot: Any, q: Any) -> None:
    motion = DrivenMotion(robot, tuple(robot.actuation.idx_v.tolist()))
    found, expected = motion.derivative(q), by_least_squares(robot, q)
    assert found is not None
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    along = np.random.default_rng(0).uniform(-1.0, 1.0, found.shape[1])
    v = motion.velocity(q, along)
    np.testing.assert_allclose(v, expected @ along, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("name", SOME)
def test_derivative_equals_least_squares(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    check(robot, eurdf.assemble(robot).q)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_size_of_a_planar_loop_does_not_matter(size: float) -> None:
    """Three of its six rows are redundant."""
    check(n_bar(4, size=size), np.zeros(4))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_decomposition_decides_where_units_differ_much(size: float) -> None:
    robot = slider_crank(size=size)
    assert (DrivenMotion(robot, (0,)).derivative(np.zeros(4)) is None) == (size != 1.0)
    expected = by_least_squares(robot, np.zeros(4))
    np.testing.assert_allclose(eurdf.dq_dq_actuated(robot, np.zeros(4)), expected, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize(("lift", "certain"), [(0.0, False), (1e-6, False), (1e-3, True)])
def test_decomposition_decides_at_a_dead_point(lift: float, certain: bool) -> None:
    """Crank, coupler and ground in one line: there the slide, 1 m along the line, cannot move the crank."""
    pairs = [("R", (0, 0, 0), Z), ("R", (0.6, lift, 0), Z), ("R", (1, 0, 0), Z), ("P", (1, 0, 0), X)]
    robot = loop(pairs, actuated=["j3"])
    found = DrivenMotion(robot, (3,)).derivative(np.zeros(4))
    assert (found is not None) == certain
    if certain:
        check(robot, np.zeros(4))


@pytest.mark.parametrize("build", [stewart, three_rrr])
def test_parallel_robots_have_a_derivative(build: Any) -> None:
    robot = build()
    check(robot, robot.tree.neutral())


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_rank_is_certain_above_the_stated_number_only(scale: float) -> None:
    random = np.random.default_rng(0)
    left, right = (np.linalg.qr(random.normal(size=(n, n)))[0] for n in (4, 6))
    values = np.array([1.0, 0.7, 0.3, scale * CERTAIN])
    A = left @ np.diag(values) @ right[:4]
    norm = float(np.linalg.norm(A))
    found = least_solution(A, left[:, 0], norm)
    if scale * CERTAIN <= CERTAIN * norm:
        assert found is None
    else:
        assert found is not None
        np.testing.assert_allclose(found, right[0], rtol=0.0, atol=1e-11)


@given(seed=st.integers(0, 2**32 - 1), rows=st.integers(1, 8), rank=st.integers(1, 8), columns=st.integers(1, 8))
@settings(max_examples=200, deadline=None)
def test_least_solution_equals_the_pseudoinverse(seed: int, rows: int, rank: int, columns: int) -> None:
    random, rank = np.random.default_rng(seed), min(rank, rows, columns)
    A = random.normal(size=(rows, rank)) @ random.normal(size=(rank, columns))
    b = A @ random.normal(size=columns)
    found = least_solution(A, b, float(np.linalg.norm(A)))
    values = np.linalg.svd(A, compute_uv=False)[:rank]
    if values[-1] > 1e-3 * np.linalg.norm(A):
        assert found is not None
    if found is not None:
        np.testing.assert_allclose(
            found, np.linalg.pinv(A, rcond=1e-9) @ b, rtol=0.0, atol=1e-8 * np.abs(b).max() + 1e-12
        )


def test_what_redundant_rows_contradict_has_no_solution() -> None:
    A = np.array([[1.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    assert least_solution(A, np.array([1.0, 2.1, 0.0]), float(np.linalg.norm(A))) is None
    np.testing.assert_allclose(least_solution(A, np.array([1.0, 2.0, 3.0]), float(np.linalg.norm(A))), [1.0, 3.0])


def test_numbers_that_overflow_have_no_solution() -> None:
    assert least_solution(np.array([[np.inf, 1.0]]), np.ones(1), np.inf) is None
