"""The joint types of Extended URDF and the coordinates each has in files and in answers."""

from __future__ import annotations

import sys
from dataclasses import dataclass

from eurdf.text_enum import TextEnum


class JointType(TextEnum):
    """URDF's own joint types and the four that it lacks."""

    FIXED = "fixed"
    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    PLANAR = "planar"
    FLOATING = "floating"
    SPHERICAL = "spherical"
    UNIVERSAL = "universal"
    CYLINDRICAL = "cylindrical"
    HELICAL = "helical"

    # The hash of the string it equals: Enum's own is a Python function, and lookups by type are frequent.
    __hash__ = str.__hash__


if sys.version_info < (3, 12):
    # There, a member is looked up through a descriptor written in Python, which takes four times as long.
    for _member in JointType:
        type.__setattr__(JointType, _member.name, _member)


@dataclass(frozen=True, slots=True)
class Coordinates:
    """How a joint's configuration is written.

    Attributes:
        names: One name for each number in files: angles in rad, lengths in m, a unit quaternion x y z w.
        nv: Number of velocities.
        neutral: The configuration at which child and joint frame coincide.
        quaternion: Index of the first of the quaternion's four numbers, or None.
    """

    names: tuple[str, ...]
    nv: int
    neutral: tuple[float, ...]
    quaternion: int | None = None


COORDINATES: dict[JointType, Coordinates] = {
    JointType.FIXED: Coordinates((), 0, ()),
    JointType.REVOLUTE: Coordinates(("angle",), 1, (0.0,)),
    JointType.CONTINUOUS: Coordinates(("angle",), 1, (0.0,)),
    JointType.PRISMATIC: Coordinates(("length",), 1, (0.0,)),
    JointType.HELICAL: Coordinates(("angle",), 1, (0.0,)),
    JointType.UNIVERSAL: Coordinates(("angle", "angle"), 2, (0.0, 0.0)),
    JointType.CYLINDRICAL: Coordinates(("length", "angle"), 2, (0.0, 0.0)),
    JointType.PLANAR: Coordinates(("x", "y", "angle"), 3, (0.0, 0.0, 0.0)),
    JointType.SPHERICAL: Coordinates(("x", "y", "z", "w"), 3, (0.0, 0.0, 0.0, 1.0), quaternion=0),
    JointType.FLOATING: Coordinates(
        ("x", "y", "z", "qx", "qy", "qz", "qw"), 6, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), quaternion=3
    ),
}
