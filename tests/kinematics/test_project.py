"""Projections of configurations, velocities and accelerations onto the closures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from eurdf.errors import EurdfError, NotClosable
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.project import project_acceleration, project_configuration, project_velocity
from eurdf.kinematics.residual import acceleration_drift, residual, residual_and_jacobian
from support.actuated import ROBOTS, closed_near, robot_called
from support.linkage import (
    Linkage,
    Z,
    bennett,
    closure,
    drift_by_differences,
    loop,
    n_bar,
    pulled_apart,
    sarrus,
    slider_crank,
    spherical_four_bar,
    stewart,
    translation,
)

# Redundant rows, and more of them than counting predicts (Bennett), ball joints, sliders, and one motion or many.
BUILD: dict[str, Callable[[], Any]] = {
    "four-bar in 6d": lambda: n_bar(4),
    "six-bar in 3d": lambda: n_bar(6, "3d"),
    "slider-crank": slider_crank,
    "spherical four-bar": spherical_four_bar,
    "Sarrus": sarrus,
    "Bennett": bennett,
    "Stewart": stewart,
    **{name: (lambda name=name: robot_called(name)) for name in ROBOTS},  # type: ignore[misc]
}


def null_space(K: Any) -> Any:
    """Of the K of a robot of about a metre at a regular configuration."""
    _, values, right = np.linalg.svd(K)
    return right[int((values > 1e-5 * values.max(initial=0.0)).sum()) :].T


def some_metric(nv: int, random: np.random.Generator) -> Any:
    A = random.normal(size=(nv, nv))
    return A @ A.T / nv + np.eye(nv)


def test_drift_is_exact_near_half_turn_and_closed() -> None:
    random = np.random.default_rng(2)
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "body")
    linkage = Linkage(model, [closure(model, 0, pin.SE3.Identity(), joint, pin.SE3.Identity())])
    v = random.normal(size=6)
    for angle in (0.0, 1e-9, 1e-3, 1.0, 3.0):
        turn = pin.exp6(np.array([0.4, -0.3, 2.0, 0.6 * angle, 0.0, 0.8 * angle]))
        q = pin.SE3ToXYZQUAT(turn)
        expected = drift_by_differences(linkage, q, v)
        np.testing.assert_allclose(acceleration_drift(linkage, q, v), expected, atol=1e-8 * np.abs(expected).max())
    np.testing.assert_allclose(acceleration_drift(linkage, pin.neutral(model), v), 0.0, atol=1e-12)


@pytest.mark.parametrize("name", BUILD)
def test_projected_velocity_is_nearest_consistent_one(name: str) -> None:
    robot, random = BUILD[name](), np.random.default_rng(1)
    q = closed_near(robot, random)
    _, K = residual_and_jacobian(robot, q)
    nv = robot.model.nv
    free = null_space(K)
    assert free.shape[1] > 0
    for weights in (None, random.uniform(0.5, 2.0, nv), some_metric(nv, random)):
        W = np.eye(nv) if weights is None else np.diag(weights) if weights.ndim == 1 else weights
        v = random.normal(size=nv)
        projected = project_velocity(robot, q, v, weights=weights)
        np.testing.assert_allclose(K @ projected, 0.0, atol=1e-6)  # numbers in published files are rounded
        np.testing.assert_allclose(free.T @ W @ (projected - v), 0.0, atol=1e-6)
        np.testing.assert_allclose(project_velocity(robot, q, projected, weights=weights), projected, atol=1e-9)


@pytest.mark.parametrize("name", ["four-bar in 6d", "spherical four-bar", "Stewart", "digit_leg", "four_bar"])
def test_projected_acceleration_is_nearest_consistent_one(name: str) -> None:
    robot, random = BUILD[name](), np.random.default_rng(3)
    q, nv = closed_near(robot, random), robot.model.nv
    _, K = residual_and_jacobian(robot, q)
    v = project_velocity(robot, q, random.normal(size=nv))
    drift = acceleration_drift(robot, q, v)
    assert np.abs(drift).max() > 1e-3
    for weights in (None, some_metric(nv, random)):
        W = np.eye(nv) if weights is None else weights
        a = random.normal(size=nv)
        projected = project_acceleration(robot, q, v, a, weights=weights)
        np.testing.assert_allclose(K @ projected + drift, 0.0, atol=1e-8)
        np.testing.assert_allclose(null_space(K).T @ W @ (projected - a), 0.0, atol=1e-7)
        np.testing.assert_allclose(project_acceleration(robot, q, v, projected, weights=weights), projected, atol=1e-8)


@pytest.mark.parametrize("name", BUILD)
@pytest.mark.parametrize("weighted", [False, True])
def test_projected_configuration_is_closed_and_nearest(name: str, weighted: bool) -> None:
    robot, random = BUILD[name](), np.random.default_rng(5)
    model = robot.model
    W = some_metric(model.nv, random) if weighted else np.eye(model.nv)
    closed = closed_near(robot, random)
    q = pin.integrate(model, closed, random.uniform(-0.2, 0.2, model.nv))

    def distance(to: Any) -> float:
        x = pin.difference(model, q, to)
        return float(np.sqrt(x @ W @ x))

    projected = project_configuration(robot, q, weights=W if weighted else None)
    assert np.abs(residual(robot, projected)).max() <= 1e-10
    assert pin.isNormalized(model, projected, 1e-12)
    assert 1e-3 < distance(projected) <= distance(closed) + 1e-9
    for size in (1e-3, 1e-2, 0.1):
        for _ in range(5):
            beside = assemble(robot, pin.integrate(model, projected, random.uniform(-size, size, model.nv)), restarts=0)
            assert not beside.closes or distance(beside.q) >= distance(projected) - 1e-9
    # The shortest step is normal to the closed configurations.
    _, K = residual_and_jacobian(robot, projected)
    x = pin.difference(model, q, projected)
    slope = null_space(K).T @ pin.dDifference(model, q, projected, pin.ARG1).T @ (W @ x)
    assert np.abs(slope).max() < 1e-6


@pytest.mark.parametrize("name", BUILD)
def test_closed_configuration_is_its_own_projection(name: str) -> None:
    robot = BUILD[name]()
    q = closed_near(robot, np.random.default_rng(6))
    np.testing.assert_allclose(project_configuration(robot, q), q, atol=1e-12)


def test_loops_that_cannot_close_are_named_with_openings() -> None:
    linkage = loop([("R", (0, 0, 0), Z), ("R", (1, 0, 0), Z)], "3d", (2, 0, 0))
    linkage = pulled_apart(linkage, translation(5.0, 0.0, 0.0))
    with pytest.raises(NotClosable, match=r"'end' by 3 m") as raised:
        project_configuration(linkage, np.array([0.3, 0.4]))
    assert isinstance(raised.value, EurdfError)
    (opening,) = raised.value.openings
    assert opening.position == pytest.approx(3.0, abs=1e-6)
    assert raised.value.q.shape == (2,)


def test_projection_without_loops_is_identity() -> None:
    linkage = Linkage(n_bar(4).model)
    q, v, a = np.arange(4.0), np.arange(4.0) + 1.0, np.arange(4.0) - 2.0
    np.testing.assert_array_equal(project_configuration(linkage, q), q)
    np.testing.assert_allclose(project_velocity(linkage, q, v, weights=np.array([1.0, 2.0, 3.0, 4.0])), v, atol=1e-12)
    np.testing.assert_allclose(project_acceleration(linkage, q, v, a), a, atol=1e-12)


def test_invalid_metric_is_refused() -> None:
    robot, q, v = robot_called("four_bar"), assemble(robot_called("four_bar")).q, np.zeros(3)
    for weights, reason in (
        (np.array([1.0, -1.0, 1.0]), "not positive definite"),
        (np.triu(np.ones((3, 3))) + np.eye(3), "not a symmetric matrix"),
    ):
        with pytest.raises(ValueError, match=reason):
            project_velocity(robot, q, v, weights=weights)
