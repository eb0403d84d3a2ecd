"""The robots that simulators are given."""

from __future__ import annotations

from dataclasses import replace

import eurdf
from eurdf.mechanism.joint import Joint
from eurdf.pinocchio.robot import build_robot

#: One with a 3d closure; 6d closures; universal joints; both kinds, and twelve loops.
ROBOTS = ("four_bar", "delta", "digit_leg", "kangaroo_leg")


def plain_robot(name: str) -> eurdf.Robot:
    """A robot of the collection that no motor and no contact moves: gravity acts, and nothing else.

    Its bodies, joints, position limits, damping, friction and closures are those of the collection.
    """
    mechanism = eurdf.load(name, geometry=False).mechanism
    bodies = tuple(replace(body, visuals=(), collisions=()) for body in mechanism.bodies)
    joints = tuple(map(_without_motor, mechanism.joints))
    plain = replace(mechanism, joints=joints, bodies=bodies, actuators=(), motors={})
    return build_robot(plain, geometry=False)


def _without_motor(joint: Joint) -> Joint:
    zero = (0.0,) * joint.type.nv
    return replace(
        joint, properties=replace(joint.properties, velocity=(), effort=(), armature=zero, rotor_inertia=zero)
    )
