"""The mass matrix of the spanning tree, against kinetic energy, MuJoCo, and Pinocchio's own where that is right."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

import eurdf
import pinocchio as pin
from support import mujoco_witness
from support.described import LIMITED, body, load
from support.plain_urdf import joint_element

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


def test_matches_pinocchio_without_mimic_joints() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    q = eurdf.assemble(robot).q
    M = np.triu(pin.crba(robot.model, robot.model.createData(), q))
    np.testing.assert_allclose(eurdf.mass_matrix(robot, q, data=robot.data), M + np.triu(M, 1).T, rtol=1e-12)


def test_invalid_configuration_is_refused() -> None:
    with pytest.raises(ValueError, match=r"has the shape \(2,\); expected \(3,\)"):
        eurdf.mass_matrix(load(hand()), np.zeros(2))
