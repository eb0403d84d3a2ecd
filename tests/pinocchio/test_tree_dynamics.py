"""Dynamics of trees in a `pin.Data`, and of large ones without; the mass matrix against MuJoCo."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.kinematics import forward_solver
from eurdf.pinocchio import tree
from eurdf.pinocchio.springs import NO_SPRINGS
from eurdf.pinocchio.tree_dynamics import TreeRecursion
from support import mujoco_witness
from support.described import LIMITED, body, load
from support.linkage import JOINTS, branching
from support.plain_urdf import joint_element


def every_joint() -> Any:
    return branching([make() for make in JOINTS.values()], np.random.default_rng(0)).model


def mimicking() -> Any:
    """A joint, one that mimics it, and two that the latter carries."""
    model, place = pin.Model(), pin.SE3(pin.exp3(np.array([0.3, 0.2, 0.1])), np.array([0.5, 0.1, 0.2]))
    leader = model.addJoint(0, pin.JointModelRX(), place, "leader")
    moving = pin.JointModel(pin.JointModelRY())
    joint = model.joints[leader]
    moving.setIndexes(leader, joint.idx_q, joint.idx_v, joint.idx_vExtended)
    mimic = model.addJoint(leader, pin.JointModelMimic(moving, -1.5, 0.3), place, "mimic")
    for name in ("one", "other"):
        model.addJoint(mimic, pin.JointModelRZ(), place, name)
    return model


@pytest.mark.parametrize("make", [every_joint, mimicking])
def test_recursion_matches_pinocchio(make: Callable[[], Any]) -> None:
    model, random = make(), np.random.default_rng(0)
    for joint in range(1, model.njoints):
        A = random.uniform(-0.3, 0.3, (3, 3))
        model.inertias[joint] = pin.Inertia(random.uniform(0.5, 2.0), random.uniform(-0.3, 0.3, 3), A @ A.T)
    model.armature = random.uniform(0.0, 1.0, model.nv)
    low, high = -np.ones(model.nq), np.ones(model.nq)
    q, v, a = pin.randomConfiguration(model, low, high), random.normal(size=model.nv), random.normal(size=model.nv)
    recursion, data, still = TreeRecursion(model, NO_SPRINGS), model.createData(), np.zeros(model.nv)
    expected = np.array(pin.rnea(model, data, q, v, a))
    np.testing.assert_allclose(recursion.inverse_dynamics(q, v, a), expected, atol=1e-11 * np.abs(expected).max())
    gravity = np.array(pin.rnea(model, data, q, still, still))
    M = np.array([pin.rnea(model, data, q, still, each) - gravity for each in np.eye(model.nv)]).T
    np.testing.assert_allclose(recursion.mass_times(q, np.eye(model.nv)), M, atol=1e-11 * np.abs(M).max())
    for direction, force in zip(np.eye(model.nv), gravity, strict=True):
        ends = [recursion.potential_energy(pin.integrate(model, q, sign * 1e-4 * direction)) for sign in (1.0, -1.0)]
        assert (ends[0] - ends[1]) / 2e-4 == pytest.approx(force, abs=1e-5)


@pytest.mark.parametrize("name", ["digit_leg", "four_bar", "digit_2legs"])
def test_large_robot_moves_as_small_one(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = eurdf.load(name, geometry=False)
    q, random = eurdf.assemble(robot).q, np.random.default_rng(0)
    v = eurdf.project_velocity(robot, q, random.normal(size=robot.model.nv))
    u = random.normal(size=len(robot.actuation.idx_v))
    expected = eurdf.forward_dynamics(robot, q, v, u)
    motion = eurdf.simulate(robot, q, v, duration=0.005)
    for module in (tree, forward_solver):
        monkeypatch.setattr(module, "MOST_VELOCITIES_WITH_DATA", 0)
    large = eurdf.load(name, geometry=False)
    found = eurdf.forward_dynamics(large, q, v, u)
    np.testing.assert_allclose(found.a, expected.a, atol=1e-8 * np.abs(expected.a).max())
    largest = max(np.abs(each).max() for each in expected.forces)
    for one, other in zip(found.forces, expected.forces, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-7 * largest)
    back = eurdf.inverse_dynamics(large, q, v, found.a).u
    np.testing.assert_allclose(
        back, eurdf.inverse_dynamics(robot, q, v, found.a).u, atol=1e-7 * (1.0 + np.abs(u).max())
    )
    again = eurdf.simulate(large, q, v, duration=0.005)
    for one, other in zip(again, motion, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-7 * (1.0 + np.abs(other).max()))


MIMIC = '<mimic joint="a" multiplier="-1.5" offset="0.3"/>'


def hand(mimic: str = MIMIC) -> str:
    """A joint ``b`` that carries two fingers, ``c`` and ``d``, and that mimics ``a``."""
    turned = ("0 1 0", "1 0 0", "0 0 1")
    return (
        '<robot name="hand">'
        + "".join(body(name) for name in ("base", "arm", "palm", "thumb", "finger"))
        + joint_element("a", "revolute", "base", "arm", LIMITED.format(turned[0]), "")
        + joint_element("b", "revolute", "arm", "palm", LIMITED.format(turned[1]) + mimic, '<origin xyz="0.5 0 0"/>')
        + joint_element("c", "revolute", "palm", "thumb", LIMITED.format(turned[0]), '<origin xyz="0.1 0.2 0"/>')
        + joint_element("d", "revolute", "palm", "finger", LIMITED.format(turned[2]), '<origin xyz="0.1 -0.2 0"/>')
        + "</robot>"
    )


ARMATURE = "joints: {c: {armature: 0.05}}\n"


def test_branched_mimic_joint_matches_constrained_free_joint(tmp_path: Path) -> None:
    robot = load(hand(), ARMATURE)
    bound = np.array([[1.0, 0.0, 0.0], [-1.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    q = np.array([0.4, 0.9, -0.6])
    (tmp_path / "free.urdf").write_text(hand(mimic=""))
    model = mujoco_witness.read_urdf(tmp_path / "free.urdf")
    data = mujoco.MjData(model)
    names = [mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_JOINT, index) for index in range(model.njnt)]
    order = [names.index(name) for name in "abcd"]
    data.qpos[order] = bound @ q + np.array([0.0, 0.3, 0.0, 0.0])
    mujoco.mj_forward(model, data)
    M = bound.T @ mujoco_witness.mass_matrix(model, data)[np.ix_(order, order)] @ bound
    M[1, 1] += 0.05
    np.testing.assert_allclose(eurdf.mass_matrix(robot, q), M, rtol=1e-6, atol=1e-6)
