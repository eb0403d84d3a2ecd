"""The dynamics of a robot that is divided into limbs are those of the whole robot."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from benchmarks.robots import chain
from eurdf.kinematics import limbs
from eurdf.kinematics.forward_solver import ForwardSolver
from eurdf.kinematics.limbs import find_limbs
from eurdf.pinocchio.limbs import LimbsDynamics

TRUNKS = {"battobot": 6, "digit_2legs": 6, "talos_2legs": 6, "four-bars": 0, "standing": 6}


def standing(name: str) -> Any:
    """On both feet, with its springs locked."""
    robot = eurdf.load(name, geometry=False)
    springs = [joint.name for joint in robot.mechanism.joints if any(joint.properties.stiffness)]
    return eurdf.lock(robot, springs).with_contacts({"left_sole": "6d", "right_sole": "6d"})


def made(name: str) -> Any:
    if name == "standing":
        return standing("digit_2legs")
    return chain(20, in_series=False) if name == "four-bars" else eurdf.load(name, geometry=False)


@pytest.mark.parametrize("name", TRUNKS)
def test_limbs_move_as_the_whole(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    robot, random = made(name), np.random.default_rng(0)
    assert not find_limbs(robot)
    q = eurdf.assemble(robot).q
    v, tau = eurdf.project_velocity(robot, q, random.normal(size=robot.tree.nv)), random.normal(size=robot.tree.nv)
    whole, motion = eurdf.forward_dynamics(robot, q, v, tau=tau), eurdf.simulate(robot, q, v, duration=0.003)
    torques = eurdf.inverse_dynamics(robot, q, v, whole.a, tau=tau).u
    monkeypatch.setattr(limbs, "MOST_VELOCITIES_OF_A_LIMB", 40)
    divided = made(name)
    own = ForwardSolver(divided).own
    assert isinstance(own, LimbsDynamics)
    assert len(own.trunk) == TRUNKS[name]
    found = eurdf.forward_dynamics(divided, q, v, tau=tau)
    np.testing.assert_allclose(found.a, whole.a, atol=1e-8 * np.abs(whole.a).max())
    largest = np.abs(np.concatenate(whole.forces)).max()
    np.testing.assert_allclose(np.concatenate(found.forces), np.concatenate(whole.forces), atol=1e-8 * largest)
    np.testing.assert_allclose(
        eurdf.inverse_dynamics(divided, q, v, whole.a, tau=tau).u, torques, atol=1e-7 * (1.0 + np.abs(torques).max())
    )
    for one, other in zip(eurdf.simulate(divided, q, v, duration=0.003), motion, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-7 * (1.0 + np.abs(other).max()))
    M = eurdf.mass_matrix(robot, q)
    np.testing.assert_allclose(own.mass_times(q, np.eye(len(M))), M, atol=1e-9 * np.abs(M).max())
    assert (own.inverse_mass_diagonal(q) >= (1.0 - 1e-9) * np.linalg.inv(M).diagonal()).all()


def test_limbs_that_hold_the_trunk_alike_have_least_forces(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = standing("cassie_2legs")  # each leg has five motors, so both keep the torso from one motion
    assert eurdf.analyze(robot).redundant == 1
    q, v, tau = eurdf.assemble(robot).q, np.zeros(robot.tree.nv), np.ones(robot.tree.nv)
    whole = eurdf.forward_dynamics(robot, q, v, tau=tau)
    for bound in ("MOST_VELOCITIES_OF_A_LIMB", "BUNDLED"):
        monkeypatch.setattr(limbs, bound, 20)
    divided = standing("cassie_2legs")
    assert len(find_limbs(divided)) == 2
    found = eurdf.forward_dynamics(divided, q, v, tau=tau)
    np.testing.assert_allclose(found.a, whole.a, atol=1e-8 * np.abs(whole.a).max())
    largest = np.abs(np.concatenate(whole.forces)).max()
    np.testing.assert_allclose(np.concatenate(found.forces), np.concatenate(whole.forces), atol=1e-8 * largest)


def test_limbs_take_over_changes_of_the_model(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limbs, "MOST_VELOCITIES_OF_A_LIMB", 40)
    robot = made("battobot")
    q, v = eurdf.assemble(robot).q, np.zeros(robot.tree.nv)
    before = eurdf.forward_dynamics(robot, q, v).a
    robot.model.gravity.linear = np.array([1.0, 0.0, -3.0])
    robot.model.armature = np.full(robot.tree.nv, 0.3)
    robot.model.inertias[5] = pin.Inertia(2.0, np.zeros(3), np.eye(3))
    found, other = (eurdf.forward_dynamics(robot, q, v, data=data).a for data in (None, robot.data))
    assert np.abs(found - before).max() > 0.1
    np.testing.assert_allclose(found, other, atol=1e-8 * np.abs(other).max())
