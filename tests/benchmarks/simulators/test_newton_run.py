"""Exported robots in Newton, from USD and from MJCF: as many loops and freedoms, the same masses and poses.

Newton needs packages of versions that exclude ours: it is asked in an environment of its own.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from benchmarks.simulators.newton_run import HOW, VARIABLE, ask_newton
from support.plain_urdf import inertial, joint_element, link_element
from support.plain_urdf import robot as robot_element

PYTHON = os.environ.get(VARIABLE)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON, reason=f"Newton is asked in an environment of its own: {HOW}"),
]

#: What closures become.
LOOPS = {"3d": "BALL", "6d": "FIXED", "hinge": "REVOLUTE", "distance": "DISTANCE"}

Ask = Callable[[str, str], Mapping[str, Any]]


@pytest.fixture
def ask(tmp_path: Path) -> Ask:
    """What Newton reads of an exported robot."""

    def asked(name: str, to: str) -> Mapping[str, Any]:
        pytest.importorskip("pxr" if to == "usd" else "mujoco")
        return ask_newton(str(PYTHON), eurdf.export(name, to).write(tmp_path)[0])

    return asked


@pytest.mark.parametrize("to", ["usd", "mjcf"])
@pytest.mark.parametrize("name", ["four_bar", "delta", "digit_leg", "kangaroo_leg", "digit_2legs"])
def test_loops_freedoms_and_masses_are_those_of_the_robot(ask: Ask, name: str, to: str) -> None:
    found = ask(name, to)
    robot = eurdf.load(name, geometry=False)
    assert found["freedoms"] == robot.model.nv
    assert found["loops"] == sorted(LOOPS[closure.type] for closure in robot.mechanism.closures)
    masses = {body.name: body.inertia.mass for body in robot.mechanism.bodies if body.inertia is not None}
    for body, mass in zip(found["bodies"], found["mass"], strict=True):
        if masses.get(body):
            assert mass == pytest.approx(masses[body], rel=1e-6)


@pytest.mark.parametrize("name", ["delta", "digit_leg", "kangaroo_leg", "digit_2legs"])
def test_poses_of_a_stage_are_those_of_the_assembled_robot(ask: Ask, name: str) -> None:
    found = ask(name, "usd")
    robot = eurdf.load(name, geometry=False)
    pin.framesForwardKinematics(robot.model, robot.data, robot.configurations["assembled"])
    for body, pose, again in zip(found["bodies"], found["poses"], found["poses_of_coordinates"], strict=True):
        expected = robot.data.oMf[robot.model.getFrameId(body, pin.FrameType.BODY)]
        for each in (pose, again):  # as stated, and from the coordinates that Newton finds for its joints
            np.testing.assert_allclose(each[:3], expected.translation, atol=5e-6)
            R = pin.Quaternion(np.array(each[3:])).normalized().matrix()
            np.testing.assert_allclose(R, expected.rotation, atol=5e-6)


def test_mimic_joint_is_read(tmp_path: Path) -> None:
    pytest.importorskip("pxr")
    links = [link_element(name, inertial(1.0)) for name in ("base", "crank", "follower")]
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    mimic = '<mimic joint="turn" multiplier="-2" offset="0.5"/>'
    joints = (
        joint_element("turn", "revolute", "base", "crank", limit),
        joint_element("follow", "revolute", "crank", "follower", limit + mimic),
    )
    path = eurdf.export(robot_element(*links, *joints), "usd").write(tmp_path)[0]
    np.testing.assert_allclose(ask_newton(str(PYTHON), path)["mimics"], [[0.5, -2.0]], rtol=1e-6)
