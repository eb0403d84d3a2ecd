"""The bodies and joints that the URDF alone describes."""

from __future__ import annotations

from dataclasses import replace

from eurdf.format.urdf.data import Urdf, UrdfJoint
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.pose import Vector3

_AXIAL = frozenset({JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC})


def bodies_of(urdf: Urdf) -> dict[str, Body]:
    """Every link as a body, by name."""
    return {link.name: Body(link.name, link.inertia, link.visuals, link.collisions) for link in urdf.links.values()}


def joint_of(joint: UrdfJoint) -> Joint:
    """A joint of the URDF, before the description changes it.

    Limits and dynamics of planar and floating joints are not read, as in Pinocchio: URDF has one number for all of
    their coordinates, of different units.
    """
    kind = joint.type
    axes: tuple[Vector3, ...] = ()
    properties = JointProperties() if kind is JointType.FIXED else JointProperties.unlimited(kind)
    if kind in _AXIAL:
        axes = (joint.axis,)
        changes = {"damping": (joint.damping,), "friction": (joint.friction,)}
        limit = joint.limit
        if limit is not None:
            changes |= {"velocity": (limit.velocity,), "effort": (limit.effort,)}
            if kind is not JointType.CONTINUOUS:
                changes |= {"lower": (limit.lower,), "upper": (limit.upper,)}
        properties = replace(properties, **changes)
    mimic = joint.mimic if kind in _AXIAL else None
    return Joint(
        joint.name, kind, joint.parent, joint.child, joint.placement, axes=axes, properties=properties, mimic=mimic
    )
