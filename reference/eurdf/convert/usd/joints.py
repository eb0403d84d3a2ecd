"""The joint of USD that a joint is: its kind, its frames and its free axes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from eurdf.closures.se3 import quaternion_of
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import AXES, IDENTITY_QUATERNION, Quaternion, cross, direction, turn_from_x

#: Axis tokens of directions that need no turn of the frame.
_TOKENS = dict(zip(AXES, "XYZ", strict=True))

#: The types of joint that are one of USD, beside those of one axis; but for spherical ones, a D6 joint.
WHOLE = (
    JointType.SPHERICAL,
    JointType.UNIVERSAL,
    JointType.CYLINDRICAL,
    JointType.HELICAL,
    JointType.PLANAR,
    JointType.FLOATING,
)

#: The kinds of the other joints of USD.
KINDS = {
    JointType.FIXED: "fixed",
    JointType.REVOLUTE: "revolute",
    JointType.CONTINUOUS: "revolute",
    JointType.PRISMATIC: "prismatic",
    JointType.SPHERICAL: "spherical",
}


@dataclass(frozen=True, slots=True)
class Freedom:
    """A free axis of a USD joint.

    Attributes:
        axis: Its name: ``angular`` or ``linear`` of a joint with one axis, else ``transX`` to ``rotZ``.
        index: Index of the velocity of the joint that it has, and of its coordinate unless it turns a ball.
        lead: Of the translation of a helical joint its length for 1 rad, m; else None.
    """

    axis: str
    index: int
    lead: float | None = None


def turns(axis: str) -> bool:
    """Whether an axis of a joint is one of rotation: its numbers are in degrees."""
    return axis == "angular" or axis.startswith("rot")


def axis_and_frame(joint: Joint) -> tuple[str, Quaternion]:
    """The axis token of a joint with one axis, and the orientation of the frames of the USD joint in those of it."""
    if not joint.axes:
        return "", IDENTITY_QUATERNION
    first, *others = map(direction, joint.axes)
    if others:
        x, y, z, w = quaternion_of(np.transpose((first, others[0], cross(first, others[0])))).tolist()
        return "", (x, y, z, w)
    if joint.type.is_axial and first in _TOKENS:
        return _TOKENS[first], IDENTITY_QUATERNION
    return "X" if joint.type.is_axial else "", turn_from_x(first)


def freedoms(joint: Joint) -> Iterator[Freedom]:
    """The free axes of the USD joint for a joint; a spherical one has none, since USD neither limits nor drives it."""
    if joint.type is JointType.SPHERICAL:
        return
    for index, (step, motion) in enumerate(zip(joint.type.steps, joint.motions, strict=True)):
        if step.kind == "ball":
            yield from (Freedom(f"rot{letter}", index + number) for number, letter in enumerate("XYZ"))
        elif joint.type.is_axial:
            yield Freedom("angular" if motion.turns else "linear", index)
        else:
            letter = "XYZ"[step.axis] if isinstance(step.axis, int) else _TOKENS[step.axis]
            if motion.advance:
                yield Freedom(f"trans{letter}", index, motion.advance if motion.turns else None)
            if motion.turns:
                yield Freedom(f"rot{letter}", index)
