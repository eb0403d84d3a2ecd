"""Unitree's G1: the linkage of its waist as measured, and the serial robot that stands for it."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

import eurdf
from eurdf.pinocchio.frames import body_frame_ids

ANKLES = [(f"{side}_ankle_pitch_joint", f"{side}_ankle_roll_joint") for side in ("left", "right")]
WAIST = ("waist_roll_joint", "waist_pitch_joint")


@pytest.fixture(scope="module")
def g1() -> eurdf.Robot:
    return eurdf.load("unitree_g1", geometry=False)


def places(robot: eurdf.Robot, q: np.ndarray) -> dict[str, np.ndarray]:
    """Pose (4, 4) of each body in the world at q (nq,), by name."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    return {name: data.oMf[frame].homogeneous for name, frame in body_frame_ids(robot.mechanism).items()}


def test_waist_has_the_lengths_of_the_published_parts(g1: eurdf.Robot) -> None:
    at = places(g1, g1.configurations["assembled"])
    for side in ("left", "right"):
        rod, ball, crank = (at[f"{side}_waist_{name}"][:3, 3] for name in ("rod", "rod_b", "crank"))
        assert math.dist(rod, ball) == pytest.approx(0.050, abs=5e-6)
        assert math.dist(ball[1:], crank[1:]) == pytest.approx(0.024, abs=5e-6)  # across the axis of the motor


def test_motors_reach_the_ends_of_pitch_and_roll(g1: eurdf.Robot) -> None:
    waist = eurdf.transmissions.prepare_transmission(g1, WAIST)
    stops = [g1.model.upperPositionLimit[g1.slots[f"{side}_waist_joint"].idx_q] for side in ("left", "right")]
    for pose in ((0.52, 0.0), (-0.52, 0.0), (0.0, 0.52), (0.0, -0.52)):
        assert (np.abs(waist.at_joints(pose).positions) < stops).all(), pose


@pytest.mark.slow
def test_serial_twin_has_the_poses_of_the_robot(g1: eurdf.Robot) -> None:
    twin = g1
    for joints in (WAIST, *ANKLES):
        twin = eurdf.transmissions.serial_twin(twin, joints, limits="fitted", grid=5).robot
    assert twin.constraints == ()
    assert len(twin.actuation.joints) == twin.model.nv - 6 == 29
    random = np.random.default_rng(5)
    for _ in range(5):
        serial = {name: [random.uniform(-0.15, 0.15)] for name in twin.actuation.joints}
        closed = eurdf.assemble(g1, g1.configuration(serial), hold=tuple(serial))
        assert closed.converged
        own = places(g1, closed.q)
        for body, pose in places(twin, twin.configuration(serial)).items():
            assert own[body] == pytest.approx(pose, abs=1e-9), body
