"""The velocities that follow driven joints: equal to least squares, and only where no rank is in doubt."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.residual import residual_and_jacobian
from support.linkage import X, Z, loop, n_bar, slider_crank

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


def check(robot: Any, q: Any, few: bool = True) -> None:
    problem = Problem(robot, robot.actuation.idx_v.tolist(), few=few)
    ((found,), (sure,)), expected = problem.derivative(q[None]), by_least_squares(robot, q)
    assert sure
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9 * np.abs(expected).max())
    along = np.random.default_rng(0).uniform(-1.0, 1.0, found.shape[1])
    ((v,), _) = problem.velocity(q[None], along[None])
    np.testing.assert_allclose(v, expected @ along, rtol=0.0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("name", SOME)
@pytest.mark.parametrize("few", [True, False])
def test_derivative_equals_least_squares(name: str, few: bool) -> None:
    robot = eurdf.load(name, geometry=False)
    check(robot, eurdf.assemble(robot).q, few)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_size_of_a_planar_loop_does_not_matter(size: float) -> None:
    """Three of its six rows are redundant."""
    check(n_bar(4, size=size), np.zeros(4))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_decomposition_decides_where_units_differ_much(size: float) -> None:
    robot = slider_crank(size=size)
    assert Problem(robot, (0,)).derivative(np.zeros((1, 4)))[1][0] == (size == 1.0)
    expected = by_least_squares(robot, np.zeros(4))
    np.testing.assert_allclose(eurdf.kinematics.dq_dq_actuated(robot, np.zeros(4)), expected, rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize(("lift", "certain"), [(0.0, False), (1e-6, False), (1e-3, True)])
def test_decomposition_decides_at_a_dead_point(lift: float, certain: bool) -> None:
    """Crank, coupler and ground in one line: there the slide, 1 m along the line, cannot move the crank."""
    pairs = [("R", (0, 0, 0), Z), ("R", (0.6, lift, 0), Z), ("R", (1, 0, 0), Z), ("P", (1, 0, 0), X)]
    robot = loop(pairs, actuated=["j3"])
    assert Problem(robot, (3,)).derivative(np.zeros((1, 4)))[1][0] == certain
    if certain:
        check(robot, np.zeros(4))
