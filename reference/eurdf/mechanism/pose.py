"""Rigid placements as plain numbers: a translation and a unit quaternion."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

ORIGIN: Vector3 = (0.0, 0.0, 0.0)
#: Unit vectors along the axes.
X, Y, Z = AXES = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
IDENTITY_QUATERNION: Quaternion = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Pose:
    """Pose of a frame in another.

    Attributes:
        xyz: Origin, in metres.
        quaternion: Orientation as a unit quaternion x, y, z, w.
        rpy: Roll, pitch and yaw that the quaternion was computed from, rad, so that what is written can be read as the
            same quaternion to the last bit; None for other quaternions.
    """

    xyz: Vector3 = ORIGIN
    quaternion: Quaternion = IDENTITY_QUATERNION
    rpy: Vector3 | None = field(default=None, compare=False, repr=False)

    def __reduce__(self) -> str | tuple[type[Pose], tuple[Vector3, Quaternion, Vector3 | None]]:
        """What is pickled and copied: `IDENTITY` stays one object, as others ask whether a pose is this object."""
        return "IDENTITY" if self is IDENTITY else (Pose, (self.xyz, self.quaternion, self.rpy))

    @classmethod
    def from_xyz_rpy(cls, xyz: Vector3, rpy: Vector3) -> Pose:
        """EU-FRM-006: pose of a URDF ``origin``: roll, pitch, yaw (rad) about the fixed axes x, y, z.

        The operations and their order are those of urdfdom, so that results agree to the last bit.
        """
        if rpy == (0.0, 0.0, 0.0):
            return cls(xyz)
        phi, theta, psi = rpy[0] / 2.0, rpy[1] / 2.0, rpy[2] / 2.0
        sr, cr = math.sin(phi), math.cos(phi)
        sp, cp = math.sin(theta), math.cos(theta)
        sy, cy = math.sin(psi), math.cos(psi)
        x = sr * cp * cy - cr * sp * sy
        y = cr * sp * cy + sr * cp * sy
        z = cr * cp * sy - sr * sp * cy
        w = cr * cp * cy + sr * sp * sy
        norm = math.sqrt(x * x + y * y + z * z + w * w)
        return cls(xyz, (x / norm, y / norm, z / norm, w / norm), rpy)

    @classmethod
    def from_xyz_quaternion(cls, xyz: Vector3, quaternion: Quaternion) -> Pose:
        """EU-URD-039: pose with the orientation of a quaternion x, y, z, w of any length but zero."""
        x, y, z, w = quaternion
        if not 1e-290 < x * x + y * y + z * z + w * w < 1e290:  # its square is out of range
            largest = max(map(abs, quaternion))
            x, y, z, w = x / largest, y / largest, z / largest, w / largest
        norm = math.sqrt(x * x + y * y + z * z + w * w)
        return cls(xyz, (x / norm, y / norm, z / norm, w / norm))

    def act(self, point: Vector3) -> Vector3:
        """Coordinates, in the outer frame, of a point of this frame."""
        x, y, z = self.rotate(point)
        return (x + self.xyz[0], y + self.xyz[1], z + self.xyz[2])

    def rotate(self, vector: Vector3) -> Vector3:
        """Coordinates, in the outer frame, of a direction of this frame: v + 2w(u×v) + 2u×(u×v)."""
        x, y, z, w = self.quaternion
        vx, vy, vz = vector
        tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
        return (
            vx + w * tx + (y * tz - z * ty),
            vy + w * ty + (z * tx - x * tz),
            vz + w * tz + (x * ty - y * tx),
        )

    def __mul__(self, other: Pose) -> Pose:
        """Composition: the pose, in the outer frame, of what ``other`` places in this frame."""
        if self is IDENTITY:
            return other
        if other is IDENTITY:
            return self
        x1, y1, z1, w1 = self.quaternion
        x2, y2, z2, w2 = other.quaternion
        x = w1 * x2 + x1 * w2 + y1 * z2 - z1 * y2
        y = w1 * y2 - x1 * z2 + y1 * w2 + z1 * x2
        z = w1 * z2 + x1 * y2 - y1 * x2 + z1 * w2
        w = w1 * w2 - x1 * x2 - y1 * y2 - z1 * z2
        norm = math.sqrt(x * x + y * y + z * z + w * w)
        return Pose(self.act(other.xyz), (x / norm, y / norm, z / norm, w / norm))

    def inverse(self) -> Pose:
        """Pose of the outer frame in this one."""
        x, y, z, w = self.quaternion
        turned = Pose((0.0, 0.0, 0.0), (-x, -y, -z, w))
        tx, ty, tz = turned.rotate(self.xyz)
        return Pose((-tx, -ty, -tz), turned.quaternion)


IDENTITY = Pose()


def squarable(axis: Vector3) -> Vector3:
    """The axis, rescaled if the square of its length is out of range."""
    x, y, z = axis
    if 1e-290 < x * x + y * y + z * z < 1e290:
        return axis
    largest = max(abs(x), abs(y), abs(z))
    return x / largest, y / largest, z / largest


def direction(axis: Vector3) -> Vector3:
    """EU-URD-035: the unit vector along an axis of any length but zero."""
    x, y, z = squarable(axis)
    norm = math.hypot(x, y, z)
    return x / norm, y / norm, z / norm


def cross(a: Vector3, b: Vector3) -> Vector3:
    """The vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def turn_from_x(axis: Vector3) -> Quaternion:
    """The shortest rotation that takes x to an axis of any length but zero; about z where the axis is opposite."""
    x, y, z = direction(axis)
    cosine = 1.0 + x if x > 0.0 else (y * y + z * z) / (1.0 - x)  # 1 + x, without cancellation
    norm = math.hypot(cosine, y, z)
    if norm == 0.0:
        return 0.0, 0.0, 1.0, 0.0
    return 0.0, -z / norm, y / norm, cosine / norm
