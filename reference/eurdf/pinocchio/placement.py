"""Poses as Pinocchio placements, to the last bit as its URDF parser makes them."""

from __future__ import annotations

import pinocchio as pin

from eurdf.mechanism.pose import Pose


def placement_of(pose: Pose) -> pin.SE3:
    """The pose as ``pin.SE3``; its rotation is that of the quaternion."""
    x, y, z = pose.xyz
    qx, qy, qz, qw = pose.quaternion
    return pin.XYZQUATToSE3([x, y, z, qx, qy, qz, qw])
