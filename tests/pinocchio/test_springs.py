"""Springs of joints: their force and energy, in dynamics and in simulation."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import eurdf
from eurdf.pinocchio.robot import build_robot
from support.mujoco_witness import read_urdf
from support.plain_urdf import inertial, joint_element, link_element
from support.transmissions import with_properties

LIMIT = '<limit lower="-9" upper="9" effort="1" velocity="1"/>'


def urdf(joints: Mapping[str, tuple[str, str]]) -> str:
    """A chain of links that joints of these types move, each with the rest of its element."""
    body = inertial(1.5, '<origin xyz="0.1 0.2 0.3"/>')
    parts = [link_element("b0", body)]
    for index, (name, (kind, content)) in enumerate(joints.items()):
        at = '<origin xyz="0.2 0.1 0.3" rpy="0.3 0.2 0.1"/>'
        parts.append(link_element(f"b{index + 1}", body))
        parts.append(joint_element(name, kind, f"b{index}", f"b{index + 1}", LIMIT + content, at))
    return f'<robot name="chain">{"".join(parts)}</robot>'


CHAIN = {
    "turn": ("revolute", '<axis xyz="0 0.6 0.8"/>'),
    "slide": ("prismatic", '<axis xyz="1 0 0"/>'),
    "spin": ("continuous", '<axis xyz="0 1 0"/>'),
    "swing": ("revolute", '<axis xyz="1 0 0"/>'),
}
SPRINGS = {"turn": (30.0, 0.2), "slide": (200.0, -0.05), "spin": (4.0, 1.0)}


def sprung(given: str | Path, springs: Mapping[str, tuple[float, float]]) -> Any:
    """A robot with springs: by joint stiffness and rest."""
    stated = {name: {"stiffness": (stiffness,), "rest": (rest,)} for name, (stiffness, rest) in springs.items()}
    return with_properties(eurdf.load(given, geometry=False), stated)


def test_accelerations_are_those_of_mujoco(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(urdf(CHAIN), encoding="utf-8")
    robot = sprung(path, SPRINGS)
    witness = read_urdf(path)
    for name, (stiffness, rest) in SPRINGS.items():
        joint = witness.joint(name)
        joint.stiffness[0], witness.qpos_spring[joint.qposadr[0]] = stiffness, rest
    data = mujoco.MjData(witness)
    witness.opt.gravity[:] = 0.0, 0.0, -9.81
    random = np.random.default_rng(1)
    for _ in range(10):
        q, v = random.uniform(-1.0, 1.0, (2, 4))
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(witness, data)
        a = eurdf.forward_dynamics(robot, q, v).a
        np.testing.assert_allclose(a, data.qacc, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(eurdf.springs.spring_force(robot, q), data.qfrc_spring, rtol=1e-12, atol=1e-12)
        found = eurdf.inverse_dynamics(actuated_of(robot), q, v, a).u
        np.testing.assert_allclose(found, np.zeros(4), atol=1e-9)


def test_force_is_minus_the_gradient_of_the_energy() -> None:
    robot = sprung("four_bar", {"motor_crank": (3.0, 0.4), "free_rocker": (7.0, -0.2)})
    q = eurdf.assemble(robot).q
    step = 1e-4
    slopes = [
        (
            eurdf.springs.spring_energy(robot, robot.tree.integrate(q, step * unit))
            - eurdf.springs.spring_energy(robot, robot.tree.integrate(q, -step * unit))
        )
        / (2 * step)
        for unit in np.eye(robot.model.nv)
    ]
    np.testing.assert_allclose(eurdf.springs.spring_force(robot, q), -np.array(slopes), atol=1e-8)
    assert np.abs(slopes).max() > 0.1


def quiet(*given: Any, **options: Any) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return eurdf.simulate(*given, **options)


def test_oscillator_has_its_period_and_keeps_its_energy(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(urdf({"slide": ("prismatic", '<axis xyz="1 0 0"/>')}), encoding="utf-8")
    stiffness, mass = 60.0, 1.5
    robot = sprung(path, {"slide": (stiffness, 0.0)})
    robot.model.gravity.linear = np.zeros(3)
    period = 2.0 * math.pi * math.sqrt(mass / stiffness)
    motion = quiet(robot, np.array([0.1]), duration=period, step=period / 400)
    np.testing.assert_allclose(motion.q[:, 0], 0.1 * np.cos(2.0 * math.pi * motion.t / period), atol=1e-8)
    np.testing.assert_allclose(motion.potential, 0.5 * stiffness * motion.q[:, 0] ** 2, rtol=1e-12, atol=1e-12)
    assert motion.energy_error < 1e-7 * motion.energy_exchanged
    assert not motion.work.any()


# -- continuous joints -----------------------------------------------------------------------------------------------


def test_continuous_joint_with_a_spring_counts_its_turns(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(urdf(CHAIN), encoding="utf-8")
    robot, rigid = sprung(path, {"spin": (4.0, 1.0)}), sprung(path, {"spin": (0.0, 1.0)})
    assert (robot.model.nq, rigid.model.nq) == (4, 5)
    assert len(rigid.tree.springs) == 0
    q = np.array([0.0, 0.0, 4.0 * math.pi, 0.0])
    np.testing.assert_allclose(eurdf.springs.spring_force(robot, q), [0.0, 0.0, -4.0 * (4.0 * math.pi - 1.0), 0.0])
    assert robot.model.upperPositionLimit[2] == math.inf
    assert robot.joint_positions(q)["spin"] == (4.0 * math.pi,)


# -- mimic joints ----------------------------------------------------------------------------------------------------

LED = {
    "leader": ("revolute", '<axis xyz="0 1 0"/><dynamics damping="0.3" friction="0.2"/>'),
    "one": ("revolute", '<axis xyz="1 0 0"/><mimic joint="leader" multiplier="-2" offset="0.5"/>'),
    "two": ("prismatic", '<axis xyz="1 0 0"/><mimic joint="one" multiplier="0.5" offset="0.1"/>'),
    "free": ("revolute", '<axis xyz="0 0 1"/>'),
}


def led(tmp_path: Path, *, mimic: bool) -> Any:
    """A robot with a description, mimic joints in a chain, and springs, armatures, damping and friction on them."""
    (tmp_path / "robot.urdf").write_text(urdf(LED), encoding="utf-8")
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\n', encoding="utf-8")
    names = ("armature", "damping", "friction", "stiffness", "rest")
    added = {
        "one": (0.7, 0.4, 0.05, 11.0, 0.25),
        "two": (5.0, 6.0, 0.5, 90.0, -0.1),
        "leader": (0.9, 0.3, 0.2, 2.0, 0.3),
    }
    properties = {joint: {name: (each,) for name, each in zip(names, own, strict=True)} for joint, own in added.items()}
    return with_properties(eurdf.load(tmp_path, geometry=False, mimic=mimic), properties)


def test_mimic_joints_load_their_leader_as_if_they_were_free_and_led(tmp_path: Path) -> None:
    robot, free = led(tmp_path, mimic=True), led(tmp_path, mimic=False)
    assert (robot.model.nv, free.model.nv) == (2, 4)
    # q of all joints is G x + o, by hand: one = -2 leader + 0.5, two = 0.5 one + 0.1.
    G = np.array([[1.0, 0.0], [-2.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
    o = np.array([0.0, 0.5, 0.35, 0.0])
    random = np.random.default_rng(2)
    for _ in range(5):
        x, v, a = random.uniform(-1.0, 1.0, (3, 2))
        q = G @ x + o
        np.testing.assert_allclose(
            eurdf.springs.spring_force(robot, x), G.T @ eurdf.springs.spring_force(free, q), rtol=1e-12
        )
        assert eurdf.springs.spring_energy(robot, x) == pytest.approx(eurdf.springs.spring_energy(free, q), rel=1e-12)
        np.testing.assert_allclose(
            eurdf.mass_matrix(robot, x), G.T @ eurdf.mass_matrix(free, q) @ G, rtol=1e-10, atol=1e-12
        )
        forces = [
            eurdf.inverse_dynamics(actuated_of(one), *at, dissipation=True).u
            for one, at in ((robot, (x, v, a)), (free, (q, G @ v, G @ a)))
        ]
        np.testing.assert_allclose(forces[0], G.T @ forces[1], rtol=1e-10, atol=1e-10)


def actuated_of(robot: Any) -> Any:
    """The robot with a motor at each joint that mimics no other."""
    names = tuple(joint.name for joint in robot.mechanism.joints if joint.mimic is None)
    return build_robot(replace(robot.mechanism, actuators=names), geometry=False)


def test_mimic_joint_with_a_spring_counts_turns_of_its_leader(tmp_path: Path) -> None:
    joints = {
        "leader": ("continuous", '<axis xyz="0 1 0"/>'),
        "one": ("continuous", '<axis xyz="1 0 0"/><mimic joint="leader" multiplier="2"/>'),
    }
    path = tmp_path / "robot.urdf"
    path.write_text(urdf(joints), encoding="utf-8")
    robot = sprung(path, {"one": (3.0, 0.5)})
    assert robot.model.nq == 1
    np.testing.assert_allclose(eurdf.springs.spring_force(robot, np.array([7.0])), [-2.0 * 3.0 * (14.0 - 0.5)])


def test_bare_urdf_leaves_the_damping_of_mimic_joints_to_pinocchio(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(urdf(LED | {"one": (LED["one"][0], LED["one"][1] + '<dynamics damping="5"/>')}), encoding="utf-8")
    damping = {0: 0.3, 1: 0.3 + 4.0 * 5.0}
    assert eurdf.load(path, geometry=False).model.damping[0] == damping[0]
    (tmp_path / "robot.yaml").write_text('extended_urdf: "2.0"\n', encoding="utf-8")
    assert eurdf.load(tmp_path, geometry=False).model.damping[0] == pytest.approx(damping[1])
