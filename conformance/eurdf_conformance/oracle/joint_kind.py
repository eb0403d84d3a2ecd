"""The types of joints, and how many coordinates and velocities each has: the table of chapter Joints."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class JointKind:
    """One type of joint. In a word of kinds each letter is one number: an angle `a`, or a length `l`."""

    #: Coordinates at which the child's frame is that of the joint.
    neutral: tuple[float, ...]
    #: Kinds of its velocities.
    velocities: str
    #: Kinds of the coordinates that position limits bound: all of them, or none, EU-JNT-009.
    bounded: str = ""
    #: The coordinate at which the four of a quaternion begin, if there is one.
    quaternion: int | None = None

    @property
    def nv(self) -> int:
        """Number of velocities."""
        return len(self.velocities)


KINDS = {
    "fixed": JointKind((), ""),
    "revolute": JointKind((0.0,), "a", "a"),
    "continuous": JointKind((0.0,), "a", "a"),
    "prismatic": JointKind((0.0,), "l", "l"),
    "helical": JointKind((0.0,), "a", "a"),
    "cylindrical": JointKind((0.0, 0.0), "la", "la"),
    "universal": JointKind((0.0, 0.0), "aa", "aa"),
    "planar": JointKind((0.0, 0.0, 0.0), "lla"),
    "spherical": JointKind((0.0, 0.0, 0.0, 1.0), "aaa", quaternion=0),
    "floating": JointKind((0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), "lllaaa", quaternion=3),
}
