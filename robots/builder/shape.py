"""Solid primitives of uniform density, placed in the world."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from eurdf.writing.xml_text import angles_with_yaw

Vector3 = tuple[float, float, float]
Matrix3 = npt.NDArray[np.float64]

#: An angle that is nothing but the rounding of sums and products of numbers of size 1, rad.
_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class Box:
    """A box.

    Attributes:
        center: Its centre in the world, m.
        size: Lengths of its edges along its own x, y, z, m.
        mass: kg; 0 where the body states its own solid.
        rpy: Its orientation in the world: roll, pitch, yaw about the fixed axes, rad.
    """

    center: Vector3
    size: Vector3
    mass: float = 0.0
    rpy: Vector3 = (0.0, 0.0, 0.0)

    @property
    def inertia(self) -> Matrix3:
        """Inertia about the centre, in world axes, kg·m², 3 x 3."""
        x, y, z = (edge * edge for edge in self.size)
        rotation = rotation_of(self.rpy)
        return rotation @ np.diag([y + z, z + x, x + y]) @ rotation.T * (self.mass / 12.0)


@dataclass(frozen=True, slots=True)
class Cylinder:
    """A cylinder between the centres of its two end faces.

    Attributes:
        start: Centre of one end face in the world, m.
        end: Centre of the other, m.
        radius: m.
        mass: kg; 0 where the body states its own solid.
    """

    start: Vector3
    end: Vector3
    radius: float
    mass: float = 0.0

    @property
    def center(self) -> Vector3:
        """Its centre in the world, m."""
        return midpoint(self.start, self.end)

    @property
    def length(self) -> float:
        """Distance of the end faces, m."""
        return math.dist(self.start, self.end)

    @property
    def inertia(self) -> Matrix3:
        """Inertia about the centre, in world axes, kg·m², 3 x 3: m (3r² + l²) / 12 across, m r² / 2 along."""
        axis = (np.array(self.end) - np.array(self.start)) / self.length
        along = np.outer(axis, axis)
        across = self.mass * (3.0 * self.radius**2 + self.length**2) / 12.0
        return across * (np.eye(3) - along) + self.mass * self.radius**2 / 2.0 * along


@dataclass(frozen=True, slots=True)
class Sphere:
    """A sphere.

    Attributes:
        center: Its centre in the world, m.
        radius: m.
        mass: kg; 0 where the body states its own solid.
    """

    center: Vector3
    radius: float
    mass: float = 0.0

    @property
    def inertia(self) -> Matrix3:
        """Inertia about the centre, kg·m², 3 x 3: 2/5 m r²."""
        return np.eye(3) * (0.4 * self.mass * self.radius**2)


Shape = Box | Cylinder | Sphere


def midpoint(a: Vector3, b: Vector3) -> Vector3:
    """The point halfway between two."""
    return ((a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0, (a[2] + b[2]) / 2.0)


def rotation_of(rpy: Vector3) -> Matrix3:
    """Rotation Rz(yaw) Ry(pitch) Rx(roll), 3 x 3, of angles in rad."""
    (sr, sp, sy), (cr, cp, cy) = map(math.sin, rpy), map(math.cos, rpy)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]])
    about_y = np.array([[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]])
    about_z = np.array([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]])
    rotation: Matrix3 = about_z @ about_y @ about_x
    return rotation


def rotation_of_quaternion(quaternion: tuple[float, float, float, float]) -> Matrix3:
    """Rotation (3 x 3) of a quaternion w, x, y, z of any length, the order of MJCF."""
    w, x, y, z = np.array(quaternion) / math.hypot(*quaternion)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: Matrix3 = np.eye(3) + 2.0 * w * skew + 2.0 * skew @ skew
    return rotation


def rpy_of(rotation: Matrix3) -> Vector3:
    """The roll, pitch and yaw (rad) that ``rotation_of`` turns into a rotation (3 x 3).

    Where yaw can be 0, it is. Half a turn is π, not -π, however it is rounded.
    """
    x, y, z = ((column[0], column[1], column[2]) for column in rotation.T.tolist())
    roll, pitch, yaw = angles_with_yaw(0.0 if abs(x[1]) < _ROUNDING else math.atan2(x[1], x[0]), x, y, z)
    return (_positive_half_turn(roll), _positive_half_turn(pitch), _positive_half_turn(yaw))


def along(axis: npt.NDArray[np.float64]) -> Vector3:
    """The roll and pitch (rad), without yaw, that turn z into the line of an axis (3,); upward, if it is not level."""
    x, y, z = (0.0 if abs(value) < _ROUNDING else value for value in axis / np.linalg.norm(axis))
    if (z, x, -y) < (0.0, 0.0, 0.0):
        x, y, z = 0.0 - x, 0.0 - y, 0.0 - z
    return (math.atan2(-y, math.hypot(x, z)), math.atan2(x, z), 0.0)


def _positive_half_turn(angle: float) -> float:
    return angle if angle + math.pi > _ROUNDING else angle + 2.0 * math.pi
