"""The bodies and joints that the URDF alone describes."""

from __future__ import annotations

import math

from eurdf.format.urdf import Urdf, UrdfJoint
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import COORDINATES, JointType

_INF = math.inf
_AXIAL = frozenset({JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC})


def bodies_of(urdf: Urdf) -> dict[str, Body]:
    """Every link as a body, by name."""
    return {link.name: Body(link.name, link.inertia, link.visuals, link.collisions) for link in urdf.links.values()}


def joint_of(joint: UrdfJoint) -> Joint:
    """A joint of the URDF as it stands, before the description changes it.

    Limits and dynamics of planar and floating joints are not read, as in Pinocchio: URDF has one number for all of
    their coordinates, of different units.
    """
    kind = joint.type
    if kind is JointType.FIXED:
        return Joint(joint.name, kind, joint.parent, joint.child, joint.placement)
    coordinates = COORDINATES[kind]
    if kind not in _AXIAL:
        unlimited = (_INF,) * coordinates.nv
        nothing = (0.0,) * coordinates.nv
        return Joint(
            joint.name,
            kind,
            joint.parent,
            joint.child,
            joint.placement,
            lower=(-_INF,) * len(coordinates.names),
            upper=(_INF,) * len(coordinates.names),
            velocity=unlimited,
            effort=unlimited,
            damping=nothing,
            friction=nothing,
            armature=nothing,
            gear_ratio=(1.0,) * coordinates.nv,
            rotor_inertia=nothing,
        )
    lower, upper, velocity, effort = -_INF, _INF, _INF, _INF
    if joint.limit is not None:
        velocity, effort = joint.limit.velocity, joint.limit.effort
        if kind is not JointType.CONTINUOUS:
            lower, upper = joint.limit.lower, joint.limit.upper
    return Joint(
        joint.name,
        kind,
        joint.parent,
        joint.child,
        joint.placement,
        axes=(joint.axis,),
        lower=(lower,),
        upper=(upper,),
        velocity=(velocity,),
        effort=(effort,),
        damping=(joint.damping,),
        friction=(joint.friction,),
        armature=(0.0,),
        gear_ratio=(1.0,),
        rotor_inertia=(0.0,),
        mimic=joint.mimic,
    )
