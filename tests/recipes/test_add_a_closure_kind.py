"""To add a kind of closure, write one class: the kinematics and dynamics of one robot and of many work at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest

import eurdf
from eurdf.closures.kind import ClosureKind, RelativeMotions, RelativePoses, no_angle
from eurdf.closures.se3 import velocity_of_origin
from eurdf.kinematics.evaluate import frames
from eurdf.kinematics.residual import acceleration_drift
from eurdf.mechanism.constraint import Unit
from eurdf.pinocchio.robot import Robot, build_robot


@dataclass(frozen=True, slots=True)
class InPlane(ClosureKind):
    """The origin of B is in the plane z = 0 of A: r = p_z."""

    type: ClassVar[str] = "in-plane"
    units: ClassVar[tuple[Unit, ...]] = ("m",)

    @staticmethod
    def residual(poses: RelativePoses, fixed: Any) -> Any:
        return poses.position[..., 2:]

    @staticmethod
    def jacobian(poses: RelativePoses, fixed: Any) -> Any:
        return velocity_of_origin(poses.position)[..., 2:, :]

    @staticmethod
    def drift(motions: RelativeMotions, fixed: Any) -> Any:
        return motions.acceleration[..., 2:]

    @staticmethod
    def opening(poses: RelativePoses, fixed: Any) -> Any:
        return no_angle(np.abs(poses.position[..., 2]))


@pytest.fixture(scope="module")
def robot() -> Robot:
    """digit_leg with its last closure, a weld, replaced by one row."""
    mechanism = eurdf.load("digit_leg", geometry=False).mechanism
    *others, last = mechanism.closures
    return build_robot(replace(mechanism, closures=(*others, InPlane(last.name, last.a, last.b))), geometry=False)


def test_residual_has_its_derivatives(robot: Robot) -> None:
    random, tree = np.random.default_rng(0), robot.tree
    q, v = tree.integrate(tree.neutral(), random.uniform(-1.0, 1.0, tree.nv)), random.uniform(-1.0, 1.0, tree.nv)
    _, K = eurdf.residual_and_jacobian(robot, q)
    h = 1e-5
    ahead, here, behind = (eurdf.residual(robot, tree.integrate(q, t * v)) for t in (h, 0.0, -h))
    np.testing.assert_allclose(K @ v, (ahead - behind) / (2.0 * h), atol=1e-7)
    np.testing.assert_allclose(acceleration_drift(robot, q, v), (ahead - 2.0 * here + behind) / h**2, atol=1e-3)


def test_robot_closes_moves_and_falls(robot: Robot) -> None:
    assembly = eurdf.assemble(robot)
    q = assembly.q
    assert assembly.converged
    assert robot.mechanism.nc == 13
    assert eurdf.analyze(robot, q).mobility == eurdf.analyze(eurdf.load("digit_leg", geometry=False)).mobility + 5
    motor = robot.actuation.joints[0]
    values = q[robot.actuation.idx_q] + 0.01
    there = eurdf.forward_kinematics(robot, values, q)
    np.testing.assert_allclose(eurdf.residual(robot, there), 0.0, atol=1e-9)
    found = eurdf.batch.forward_kinematics(robot, np.tile(values, (3, 1)), q)
    np.testing.assert_allclose(found.q, np.tile(there, (3, 1)), atol=1e-8)
    frame = robot.mechanism.bodies[-1].name
    target = frames(robot, [frame], few=True).at(there[None]).position[0, 0]
    assert eurdf.inverse_kinematics(robot, {frame: target}, q).converged
    v = eurdf.project_velocity(robot, q, np.ones(robot.tree.nv))
    a = eurdf.forward_dynamics(robot, q, v).a
    K = eurdf.residual_and_jacobian(robot, q)[1]
    np.testing.assert_allclose(K @ a + acceleration_drift(robot, q, v), 0.0, atol=1e-7 * np.abs(a).max())
    assert np.isfinite(eurdf.simulate(robot, q, v, duration=0.005).q).all()
    assert eurdf.lock(robot, [motor], q).tree.nv < robot.tree.nv
    assert len(eurdf.sweep(robot, motor, q, steps=5).upper.configurations) > 1
