"""The bodies and joints that the URDF alone describes."""

from __future__ import annotations

import math

from eurdf.format.urdf.data import Limit, Urdf, UrdfJoint
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, JointProperties

_NONE = JointProperties()
_UNLIMITED = Limit(-math.inf, math.inf, math.inf, math.inf)


def bodies_of(urdf: Urdf) -> dict[str, Body]:
    """Every link as a body, by name."""
    return {link.name: Body(link.name, link.inertia, link.visuals, link.collisions) for link in urdf.links.values()}


def joint_of(joint: UrdfJoint) -> Joint:
    """A joint of the URDF, before the description changes it.

    Limits and dynamics of planar and floating joints are not read, as in Pinocchio: URDF has one number for all of
    their coordinates, of different units.
    """
    kind = joint.type
    properties = _NONE if kind.is_fixed else JointProperties.unlimited(kind)
    if not kind.is_axial:
        return Joint(joint.name, kind, joint.parent, joint.child, joint.placement, properties=properties)
    if joint.limit is not None or joint.damping or joint.friction:
        lower, upper, velocity, effort, *rates = joint.limit or _UNLIMITED
        acceleration, deceleration, jerk = (() if math.isinf(limit) else (limit,) for limit in rates)
        properties = JointProperties(
            (lower,) if kind.limited else properties.lower,
            (upper,) if kind.limited else properties.upper,
            (velocity,),
            (effort,),
            (joint.damping,),
            (joint.friction,),
            properties.armature,
            properties.gear_ratio,
            properties.rotor_inertia,
            acceleration=acceleration,
            deceleration=deceleration,
            jerk=jerk,
        )
    return Joint(
        joint.name,
        kind,
        joint.parent,
        joint.child,
        joint.placement,
        axes=(joint.axis,),
        properties=properties,
        mimic=joint.mimic,
    )
