"""Reachy Mini: the pose of its head."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import eurdf

#: Angles of the body and of the six cranks, rad, and the pose of the head: those at which the published model
#: (mjcf/reachy_mini.xml of pollen-robotics/reachy_mini 70a7c0b) is closed to 1e-13 m, found by SciPy with MuJoCo.
PUBLISHED = [
    ((0.0, 0.3, -0.3, 0.3, -0.3, 0.3, -0.3), (0.0, 0.0, 0.1624160521), np.eye(3)),
    (
        (0.5, 0.5, -0.2, 0.1, -0.4, 0.2, 0.3),
        (-0.012439776, 0.020114699, 0.152479336),
        [
            [0.725902087, -0.52668705, 0.442342528],
            [0.665035007, 0.701555833, -0.256023148],
            [-0.175483904, 0.480021003, 0.859526169],
        ],
    ),
]


@pytest.mark.parametrize(("angles", "position", "rotation"), PUBLISHED, ids=["lifted", "turned"])
def test_head_is_where_the_published_model_has_it(
    angles: tuple[float, ...], position: tuple[float, ...], rotation: np.ndarray
) -> None:
    robot = eurdf.load("reachy_mini", geometry=False)
    motors = dict(zip(["yaw_body", *(f"motor_{crank}" for crank in range(1, 7))], angles, strict=True))
    q = eurdf.forward_kinematics(robot, motors | {"left_antenna": 0.0, "right_antenna": 0.0})
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, q)
    head = data.oMf[robot.model.getFrameId("head_middle")]
    # The published figures are rounded to 6 digits.
    np.testing.assert_allclose(head.translation, position, atol=5e-6)
    np.testing.assert_allclose(head.rotation, rotation, atol=5e-5)
