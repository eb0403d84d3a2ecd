"""Joints of formats in which limits of 0 and 0 lock; in a description, they are no range."""

from __future__ import annotations

from dataclasses import fields, replace

from eurdf.convert.losses import Effect, Losses, LossKind
from eurdf.mechanism.joint import Joint, JointProperties, is_no_range
from eurdf.mechanism.joint_types import JointType

#: Of a joint that is locked.
LOCKED = LossKind(
    "import-locked-joint",
    "joint",
    Effect.EXACT,
    "is fixed where its limits are 0 and 0, which would be no range in a description",
    "make it a fixed joint",
    only="limits that are both 0",
)


def without_locks(joint: Joint, losses: Losses) -> Joint:
    """The joint, without each coordinate that limits of 0 and 0 lock; only a universal joint has a second one."""
    properties = joint.properties
    limits = list(zip(properties.lower, properties.upper, strict=True))
    free = [index for index, pair in enumerate(limits) if not is_no_range(*pair)]
    if len(free) == len(limits):
        return joint
    losses.add(LOCKED.code, joint.name)
    if not free:
        return Joint(joint.name, JointType.FIXED, joint.parent, joint.child, joint.placement, joint.offset)
    (index,) = free
    values = {field.name: getattr(properties, field.name)[index : index + 1] for field in fields(properties)}
    axes, properties = (joint.axes[index],), JointProperties(**values)
    return replace(joint, type=JointType.REVOLUTE, axes=axes, properties=properties)
