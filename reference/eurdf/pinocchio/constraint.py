"""The closures of a mechanism as Pinocchio constraint models."""

from __future__ import annotations

import pinocchio as pin

from eurdf.mechanism.frame import Anchor
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.frames import body_frame_ids
from eurdf.pinocchio.placement import placement_of

_CONTACT = {"3d": pin.ContactType.CONTACT_3D, "6d": pin.ContactType.CONTACT_6D}


def build_constraint_models(mechanism: Mechanism, model: pin.Model) -> list[pin.RigidConstraintModel]:
    """One constraint model a closure, in file order and under the closure's name.

    Each joins the joints that move the bodies of its frames A and B; its placements are those of the frames in the
    joints, and its residual and forces are expressed in frame A (``LOCAL``).

    Args:
        mechanism: The mechanism.
        model: What `build_model` made of it.
    """
    if not mechanism.closures:
        return []
    body_frames = body_frame_ids(mechanism)

    def locate(anchor: Anchor) -> tuple[int, pin.SE3]:
        frame = model.frames[body_frames[anchor.body]]
        return frame.parentJoint, frame.placement * placement_of(anchor.pose)

    constraint_models = []
    for closure in mechanism.closures:
        constraint_model = pin.RigidConstraintModel(
            _CONTACT[closure.type], model, *locate(closure.a), *locate(closure.b), pin.ReferenceFrame.LOCAL
        )
        constraint_model.name = closure.name
        constraint_models.append(constraint_model)
    return constraint_models
