"""Where the frames of bodies stand in a model's list of frames."""

from __future__ import annotations

from eurdf.mechanism.mechanism import Mechanism


def body_frame_ids(mechanism: Mechanism) -> dict[str, int]:
    """Index of each body's frame in ``model.frames``, of the model that `build_model` makes of the mechanism.

    A virtual body has no frame of its own; the frame of the joint that carries it, which has the same pose, stands for
    it. How models are built fixes the order, so that no name is searched for: a link and a joint may bear the same one.
    """
    last = 2 if mechanism.root == "floating" else 1  # after 'universe' and, where it floats, 'root_joint'
    ids = {mechanism.bodies[0].name: last}
    for joint, body in zip(mechanism.joints, mechanism.bodies[1:], strict=True):
        last += 1 if body.virtual else 2
        ids[joint.child] = last
    return ids
