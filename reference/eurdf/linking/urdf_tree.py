"""The bodies and joints that the URDF alone describes."""

from __future__ import annotations

from dataclasses import replace

from eurdf.format.urdf.data import Urdf, UrdfJoint
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_type import JointType

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
    fixed = Joint(joint.name, kind, joint.parent, joint.child, joint.placement)
    if kind is JointType.FIXED:
        return fixed
    properties = JointProperties.unlimited(kind)
    if kind not in _AXIAL:
        return replace(fixed, properties=properties)
    properties = replace(properties, damping=(joint.damping,), friction=(joint.friction,))
    limit = joint.limit
    if limit is not None:
        properties = replace(properties, velocity=(limit.velocity,), effort=(limit.effort,))
        if kind is not JointType.CONTINUOUS:
            properties = replace(properties, lower=(limit.lower,), upper=(limit.upper,))
    return replace(fixed, axes=(joint.axis,), properties=properties, mimic=joint.mimic)
