"""Poses as in files, and as 4×4 matrices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from eurdf_conformance.properties.mechanism import Pose, Vector

Matrix = NDArray[np.float64]


def matrix_of(pose: Pose) -> Matrix:
    """R_z(yaw) R_y(pitch) R_x(roll) and the origin, EU-FRM-006."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(pose.rpy), np.sin(pose.rpy)
    M = np.eye(4)
    M[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    M[:3, 3] = pose.xyz
    return M


def pose_of(M: Matrix) -> Pose:
    """The pose of a matrix.

    The yaw is taken out before the other two are read, so that near a pitch of a quarter turn, where it is uncertain,
    they make up for it.
    """
    R = M[:3, :3]
    yaw = np.arctan2(R[1, 0], R[0, 0])
    c, s = np.cos(yaw), np.sin(yaw)
    rest = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ R
    roll, pitch = np.arctan2(-rest[1, 2], rest[1, 1]), np.arctan2(-rest[2, 0], rest[0, 0])
    return Pose(xyz=vector(M[:3, 3]), rpy=vector([roll, pitch, yaw]))


def inverse(M: Matrix) -> Matrix:
    """BMa of aMb."""
    R = M[:3, :3].T
    inverted = np.eye(4)
    inverted[:3, :3], inverted[:3, 3] = R, -R @ M[:3, 3]
    return inverted


def quaternion_of(R: Matrix) -> tuple[float, float, float, float]:
    """The unit quaternion x, y, z, w of a rotation, from its largest member, which is never small."""
    d = np.diag(R)
    Q = np.empty((4, 4))  # 4 q qᵀ
    Q[:3, :3] = R + R.T
    Q[3, :3] = Q[:3, 3] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    np.fill_diagonal(Q, [*(1.0 + 2.0 * d - d.sum()), 1.0 + d.sum()])
    q = Q[np.argmax(np.diag(Q))]
    x, y, z, w = (q / np.linalg.norm(q)).tolist()
    return x, y, z, w


def rotation_of(quaternion: tuple[float, ...]) -> Matrix:
    """The rotation of a unit quaternion x, y, z, w."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def vector(numbers: object) -> Vector:
    """An array as three numbers."""
    x, y, z = np.asarray(numbers, dtype=float).tolist()
    return x, y, z
