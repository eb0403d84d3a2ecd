"""The joints of a robot in the vectors of the robot, and in those of an exported model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY_QUATERNION, Quaternion


@dataclass(frozen=True, slots=True)
class OwnVectors:
    """The vectors of a robot.

    Attributes:
        nq: Number of coordinates.
        nv: Number of velocities.
        places: For each joint with coordinates of its own, by name, where these are in q, and the index of its first
            velocity in v; of a floating root under ``root_joint``.
    """

    nq: int
    nv: int
    places: Mapping[str, tuple[slice, int]]


@dataclass(frozen=True, slots=True)
class Part:
    """A joint of the robot in the exported model.

    Attributes:
        names: Names of the joints of the model that it is, in order.
        joint: The joint whose coordinates move it: itself, or the leader of a mimic joint.
        type: Type of the joint. Its coordinates in the model are those of files, but for ``ratios`` and ``turn``.
        ratios: Where all coordinates are angles and lengths: for each one of the model, the index of the coordinate
            of ``joint`` that it follows, multiplier and offset.
        zero: Where some coordinates are not zero where the robot's are: those of the robot at which the model's are
            zero, as in files. Only where there are no ``ratios``.
        turn: Orientation O of the child's frame in the joint's moving frame. A ball joint of the model has the rotation
            O⁻¹ Q O for Q of the robot, and the angular velocity O⁻¹ ω.
        mimics: Whether ``joint`` is a leader: the way back ignores the part.
        rotation: What an orientation is: a quaternion; ``xyz``, the angles of three joints, R(x, a) R(y, b) R(z, c),
            whose rates are the velocities; or ``rpy``, the angles of one, R(z, c) R(y, b) R(x, a), whose velocity is
            the angular velocity along the axes of the joint's frame at rest.
        orientation_first: Whether the orientation, and the angular velocity along the axes at rest, come before the
            position and the linear velocity.
        circular: Indices of the coordinates, angles, in whose place q of the model has their cosine and sine.
    """

    names: tuple[str, ...]
    joint: str
    type: JointType
    ratios: tuple[tuple[int, float, float], ...] = ()
    zero: tuple[float, ...] = ()
    turn: Quaternion = IDENTITY_QUATERNION
    mimics: bool = False
    rotation: Literal["quaternion", "xyz", "rpy"] = "quaternion"
    orientation_first: bool = False
    circular: tuple[int, ...] = ()

    @property
    def nq(self) -> int:
        """Number of coordinates in the model."""
        n = (len(self.ratios) or len(self.type.coordinates)) + len(self.circular)
        return n if self.rotation == "quaternion" else n - 1

    @property
    def nv(self) -> int:
        """Number of velocities in the model."""
        return len(self.ratios) or self.type.nv


def part_of(
    joint: Joint,
    names: Sequence[str],
    ratios: Iterable[tuple[int, float, float]],
    mimic: Mimic | None = None,
    **more: Any,
) -> Part:
    """A joint in the exported model.

    Args:
        joint: The joint.
        names: As for `Part`.
        ratios: As for `Part`, if the velocities of the joint are the rates of its coordinates.
        mimic: The leader of a mimic joint.
        **more: Other attributes of `Part`, if they are not.
    """
    if mimic is not None:
        ratio = (0, mimic.multiplier, mimic.offset)
        return Part(tuple(names), mimic.joint, joint.type, (ratio,), mimics=True)
    if joint.type.moving_frame:
        return Part(tuple(names), joint.name, joint.type, **more)
    return Part(tuple(names), joint.name, joint.type, tuple(ratios))
