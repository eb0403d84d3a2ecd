"""A joint of the mechanism, made of joints of MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass

from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3

#: Types whose one coordinate equalities and tendons relate.
SCALAR = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.HELICAL)


@dataclass(frozen=True, slots=True)
class Step:
    """A joint of the mechanism that one or several joints of a body are.

    Attributes:
        name: Its name.
        type: Its type.
        joints: Indices of the MuJoCo joints that it is, in order.
        anchor: Its origin in the body at qpos0, m.
        turn: Orientation of its frame in the body.
        axes: Of the joint, in its frame.
        pitch: Of a helical joint, m per revolution.
    """

    name: str
    type: JointType
    joints: tuple[int, ...]
    anchor: Vector3
    axes: tuple[Vector3, ...] = ()
    turn: Pose = IDENTITY
    pitch: float = 0.0
