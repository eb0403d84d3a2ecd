"""Frames of a model, by name and by body, and poses as Pinocchio has them."""

from __future__ import annotations

import reprlib
from typing import Any

import pinocchio as pin

from eurdf.diagnostics.wording import meant
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.joint_model import number_of_models


def placement_of(pose: Pose) -> pin.SE3:
    """The pose as ``pin.SE3``, to the last bit as Pinocchio's URDF parser makes it from the quaternion."""
    x, y, z = pose.xyz
    qx, qy, qz, qw = pose.quaternion
    return pin.XYZQUATToSE3([x, y, z, qx, qy, qz, qw])


def body_frame_ids(mechanism: Mechanism) -> dict[str, int]:
    """Index of each body's frame in ``model.frames``, of the model that `build_model` makes of the mechanism.

    A virtual body has no frame; its index is that of the frame of its joint, which has the same pose. The order follows
    from how models are built, so names are not searched: a link and a joint can have the same name.
    """
    last = 2 if mechanism.root == "floating" else 1  # after 'universe' and, where it floats, 'root_joint'
    ids = {mechanism.bodies[0].name: last}
    for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
        last += number_of_models(joint.type) + (not body.virtual)
        ids[joint.child] = last
    return ids


def frame_index(model: Any, name: str) -> int:
    """Index in ``model.frames`` of the frame with this name.

    A link and a joint can have the same name if they have the same frame (EU-FRM-002).

    Raises:
        ValueError: The frame is unknown, two different frames have this name, or it is no name.
    """
    if not isinstance(name, str):
        raise ValueError(f"frame is {reprlib.repr(name)}; it must be the name of a frame")
    found = [(index, frame) for index, frame in enumerate(model.frames) if frame.name == name]
    if not found:
        raise ValueError(f"the model has no frame '{name}'{meant(name, (frame.name for frame in model.frames))}")
    index, first = found[0]
    for _, other in found[1:]:
        if other.parentJoint != first.parentJoint or not other.placement.isApprox(first.placement, 1e-12):
            raise ValueError(f"frame name '{name}' is ambiguous: two different frames of the model have it")
    return index
