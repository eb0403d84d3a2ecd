"""How far a joint has moved its child, from its coordinates."""

from __future__ import annotations

import math
from collections.abc import Sequence

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Quaternion, Vector3, direction

_HERE = (0.0, 0.0, 0.0)
_Z = (0.0, 0.0, 1.0)


def joint_transform(joint: Joint, coordinates: Sequence[float]) -> Pose:
    """EU-JNT-015 to -018, EU-JNT-025: pose of a joint's moving frame in its frame at rest, jMj'(c).

    Its child body is at ``joint.placement * joint_transform(joint, c) * joint.offset`` in its parent. With R(a, θ)
    the rotation about a by θ, a the unit vector of an axis, as (rotation, translation):

    - revolute, continuous: R(a, θ), 0; prismatic: 1, d a; helical: R(a, θ), pitch θ / 2π a;
    - cylindrical: R(a, θ), d a; universal: R(a₁, θ₁) R(a₂, θ₂), 0; planar: R(z, θ), (x, y, 0);
    - spherical: that of the quaternion, 0; floating: that of the quaternion, (x, y, z).

    Args:
        joint: Of any type.
        coordinates: As files have them (`eurdf.mechanism.joint_type.COORDINATES`): rad, m, quaternions x, y, z, w,
            brought to unit length.

    Raises:
        ValueError: There are too few or too many coordinates, or a quaternion has length 0.
    """
    names = joint.coordinates.names
    c = tuple(float(value) for value in coordinates)
    if len(c) != len(names):
        raise ValueError(
            f"joint '{joint.name}' is given {len(c)} coordinates; it has {len(names)}: " + (", ".join(names) or "none")
        )
    if c == joint.coordinates.neutral:
        return IDENTITY
    match joint.type:
        case JointType.REVOLUTE | JointType.CONTINUOUS:
            return Pose(_HERE, _turn(direction(joint.axes[0]), c[0]))
        case JointType.PRISMATIC:
            return Pose(_along(direction(joint.axes[0]), c[0]))
        case JointType.HELICAL:
            axis = direction(joint.axes[0])
            return Pose(_along(axis, joint.pitch / (2.0 * math.pi) * c[0]), _turn(axis, c[0]))
        case JointType.CYLINDRICAL:
            axis = direction(joint.axes[0])
            return Pose(_along(axis, c[0]), _turn(axis, c[1]))
        case JointType.UNIVERSAL:
            first, second = (Pose(_HERE, _turn(direction(a), angle)) for a, angle in zip(joint.axes, c, strict=True))
            return first * second
        case JointType.PLANAR:
            return Pose((c[0], c[1], 0.0), _turn(_Z, c[2]))
        case JointType.SPHERICAL:
            return Pose(_HERE, _unit_quaternion(joint, c))
        case JointType.FLOATING:
            return Pose((c[0], c[1], c[2]), _unit_quaternion(joint, c[3:]))
        case JointType.FIXED:
            return IDENTITY


def _along(unit: Vector3, length: float) -> Vector3:
    return length * unit[0], length * unit[1], length * unit[2]


def _turn(unit: Vector3, angle: float) -> Quaternion:
    s, c = math.sin(angle / 2.0), math.cos(angle / 2.0)
    return s * unit[0], s * unit[1], s * unit[2], c


def _unit_quaternion(joint: Joint, quaternion: Sequence[float]) -> Quaternion:
    norm = math.hypot(*quaternion)
    if norm == 0.0:
        raise ValueError(f"the quaternion of joint '{joint.name}' has length 0")
    x, y, z, w = (value / norm for value in quaternion)
    return x, y, z, w
