"""Indices of the frames of bodies in a model's list of frames."""

from __future__ import annotations

from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.joint_model import number_of_models


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
