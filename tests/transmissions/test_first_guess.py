"""The polynomials and stored poses that Newton's method starts from."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import eurdf
from eurdf.transmissions.drive import Drive
from eurdf.transmissions.first_guess import WorkspacePoses, nearest_poses
from eurdf.transmissions.motors import sides
from eurdf.transmissions.transmission import at_one
from support.mechanisms import one_loop
from support.transmissions import DRIVEN


def made(robot: Any, joints: Any, ranges: Any = None) -> tuple[Drive, WorkspacePoses, np.ndarray]:
    """A drive by joints, the poses of its workspace, and the assembled pose."""
    q = eurdf.assemble(robot).q
    serial, motors = sides(robot, joints)
    return Drive(at_one(robot, serial, q, motors), serial, motors), WorkspacePoses(robot, serial, motors, q, ranges), q


@pytest.mark.parametrize("name", ["unitree_g1_ankle", "digit_leg"])
def test_polynomials_err_by_less_than_they_state(name: str) -> None:
    robot = eurdf.load(name, geometry=False)
    drive, poses, q = made(robot, DRIVEN[name])
    prediction, missing = poses.prediction(drive)
    assert prediction is not None, missing
    assert prediction.error < 0.01
    space = eurdf.transmissions.workspace(robot, DRIVEN[name], grid=10)
    _, motions = nearest_poses(drive, q, space.q)
    for position, motion in zip(space.positions, motions, strict=True):
        found = prediction.motion(position)
        assert found is not None
        assert np.abs(found / drive.unit - motion).max() < prediction.error
    assert prediction.motion(prediction.upper + 0.01) is None


def test_spin_of_rods_does_not_matter() -> None:
    robot = eurdf.load("digit_leg", geometry=False)
    drive, _, q = made(robot, DRIVEN["digit_leg"])
    positions, here = np.array([-0.3, 0.2]), q
    _, direct = drive.along(q, positions)
    for corner in ([0.3, 0.2], [0.3, -0.2], [-0.3, -0.2], [-0.3, 0.2], [0.3, 0.2], positions):
        here, around = drive.along(here, np.array(corner))
    assert direct is not None
    assert around is not None
    assert np.abs(direct[0] - around[0]).max() > 1e-3  # rods have spun on the way round
    nearest, motions = nearest_poses(drive, q, np.array([direct[0], around[0]]))
    assert np.abs(eurdf.residual(robot, nearest[1])).max() < 1e-12
    assert motions[1] == pytest.approx(motions[0], abs=1e-9)


@pytest.mark.parametrize(
    ("robot", "joints", "ranges", "message"),
    [
        ("kangaroo_leg", DRIVEN["kangaroo_leg"], None, "polynomials are of at most 2 positions"),
        ("bennett", "free_b", None, "joint 'free_b' has no limits"),
        (one_loop(["revolute", "helical", "planar", "cylindrical"], "6d", 1), "j0", {"j0": (-9.0, 9.0)}, "is planar"),
    ],
    ids=["three joints", "no limits", "planar"],
)
def test_missing_polynomials_have_a_reason(robot: Any, joints: Any, ranges: Any, message: str) -> None:
    robot = eurdf.load(robot, geometry=False) if isinstance(robot, str) else robot
    drive, poses, _ = made(robot, joints, ranges)
    prediction, missing = poses.prediction(drive)
    assert prediction is None
    assert message in missing
