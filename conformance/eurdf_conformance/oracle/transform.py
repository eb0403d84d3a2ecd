"""The motion of each type of joint: the table of chapter Joints, clauses EU-JNT-015 to 019, 025 and 026."""

from __future__ import annotations

import numpy as np

from eurdf_conformance.oracle.spatial import Array, from_quaternion, pose, rotation

Z = np.array([0.0, 0.0, 1.0])


def transform(kind: str, axes: Array, pitch: float, q: Array) -> Array:
    """jMc(q): the pose of the child's frame in the joint's frame.

    Args:
        kind: Type of the joint.
        axes: Its unit vectors in the joint's frame, one a row: two of a universal joint, else one that may not count.
        pitch: m a revolution, of a helical joint.
        q: Its coordinates, rad and m.
    """
    match kind:
        case "fixed":
            return np.eye(4)
        case "revolute" | "continuous":
            return pose(rotation(axes[0], q[0]))
        case "prismatic":
            return pose(None, q[0] * axes[0])
        case "helical":
            return pose(rotation(axes[0], q[0]), pitch / (2.0 * np.pi) * q[0] * axes[0])
        case "cylindrical":
            return pose(rotation(axes[0], q[1]), q[0] * axes[0])
        case "universal":
            return pose(rotation(axes[0], q[0]) @ rotation(axes[1], q[1]))
        case "planar":
            return pose(rotation(Z, q[2]), [q[0], q[1], 0.0])
        case "spherical":
            return pose(from_quaternion(q))
        case "floating":
            return pose(from_quaternion(q[3:]), q[:3])
    raise AssertionError(kind)


def motion(kind: str, axes: Array, pitch: float, q: Array) -> Array:
    """The twists (linear, angular) of the child's frame relative to the joint's, seen from the child's: 6 × nv."""
    nothing = np.zeros(3)
    match kind:
        case "fixed":
            columns = np.zeros((0, 6))
        case "revolute" | "continuous":
            columns = np.array([[*nothing, *axes[0]]])
        case "prismatic":
            columns = np.array([[*axes[0], *nothing]])
        case "helical":
            columns = np.array([[*(pitch / (2.0 * np.pi) * axes[0]), *axes[0]]])
        case "cylindrical":
            columns = np.array([[*axes[0], *nothing], [*nothing, *axes[0]]])
        case "universal":
            # The first axis is fixed to the parent: the child, which has turned about the second, sees it turned back.
            first = rotation(axes[1], -q[1]) @ axes[0]
            columns = np.array([[*nothing, *first], [*nothing, *axes[1]]])
        case "planar":
            columns = np.eye(6)[[0, 1, 5]]
        case "spherical":
            columns = np.eye(6)[3:]
        case "floating":
            columns = np.eye(6)
        case _:
            raise AssertionError(kind)
    return columns.T
