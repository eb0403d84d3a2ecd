"""Orientations as the roll, pitch and yaw of a URDF."""

from __future__ import annotations

import math

from eurdf.mechanism.pose import Pose, Vector3


def rpy_of(pose: Pose) -> Vector3:
    """Roll, pitch and yaw of an orientation, rad: the shortest numbers that give exactly its quaternion, if any do.

    Pitch is from -π/2 to π/2. The roll is found from the yaw, so that rounding is not amplified near these two.
    """
    (r00, r10, r20), (r01, r11, _), (r02, r12, _) = (
        pose.rotate(axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    )
    yaw = math.atan2(r10, r00)
    s, c = math.sin(yaw), math.cos(yaw)
    pitch = math.atan2(-r20, c * r00 + s * r10)
    roll = math.atan2(s * r02 - c * r12, c * r11 - s * r01)
    for digits in range(17):
        rounded = round(roll, digits), round(pitch, digits), round(yaw, digits)
        if Pose.from_xyz_rpy(pose.xyz, rounded).quaternion == pose.quaternion:
            return rounded
    return roll, pitch, yaw
