"""The bodies and joints that the URDF alone describes."""

from __future__ import annotations

import math

from eurdf.format.urdf.data import Limit, Urdf, UrdfJoint
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.pose import IDENTITY

_UNLIMITED = Limit(-math.inf, math.inf, math.inf, math.inf)
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
    if kind not in _AXIAL:
        properties = JointProperties() if kind is JointType.FIXED else JointProperties.unlimited(kind)
        return Joint(joint.name, kind, joint.parent, joint.child, joint.placement, properties=properties)
    lower, upper, velocity, effort = joint.limit or _UNLIMITED
    if kind is JointType.CONTINUOUS:
        lower, upper = -math.inf, math.inf
    properties = JointProperties(
        (lower,),
        (upper,),
        (velocity,),
        (effort,),
        (joint.damping,),
        (joint.friction,),
        armature=(0.0,),
        gear_ratio=(1.0,),
        rotor_inertia=(0.0,),
    )
    return Joint(
        joint.name,
        kind,
        joint.parent,
        joint.child,
        joint.placement,
        IDENTITY,
        (joint.axis,),
        0.0,
        properties,
        joint.mimic,
    )
