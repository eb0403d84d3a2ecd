"""The mirror image, in the plane y = 0, of what is drawn.

A mirrored joint moves as the joint in a mirror does where both have the same coordinate. So what slides is mirrored as
a vector, and what turns as a pseudovector: of ``M = diag(1, -1, 1)``, ``M R(a, θ) M = R(-M a, θ)``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from robots.builder.joint import WORLD, Joint
from robots.builder.shape import Box, Cylinder, Shape, Sphere, Vector3
from robots.builder.solid import Solid

#: Gives what is drawn on one side the name it has on the other.
Renamed = Callable[[str], str]


def mirrored_vector(vector: Vector3) -> Vector3:
    """The mirror image of a point or a direction."""
    x, y, z = vector
    return (x, -y, z)


def mirrored_turn(axis: Vector3) -> Vector3:
    """The axis about which a mirrored turn has the same angle; or the roll, pitch and yaw of a mirrored frame."""
    x, y, z = axis
    return (-x, y, -z)


def mirrored_shape(shape: Shape) -> Shape:
    """The mirror image of a shape, of the same mass."""
    if isinstance(shape, Box):
        return replace(shape, center=mirrored_vector(shape.center), rpy=mirrored_turn(shape.rpy))
    if isinstance(shape, Cylinder):
        return replace(shape, start=mirrored_vector(shape.start), end=mirrored_vector(shape.end))
    return Sphere(mirrored_vector(shape.center), shape.radius, shape.mass)


def mirrored_solid(solid: Solid) -> Solid:
    """The mirror image of what is known of a body."""
    mirror = np.diag((1.0, -1.0, 1.0))
    return Solid(solid.mass, mirrored_vector(solid.center), mirror @ solid.inertia @ mirror)


def mirrored_joint(joint: Joint, renamed: Renamed) -> Joint:
    """The mirror image of a joint: where both have the same coordinate, what it carries is mirrored."""
    x, y, z = joint.axes
    motor = joint.motor
    return replace(
        joint,
        name=renamed(joint.name),
        parent=renamed(joint.parent),
        at=mirrored_vector(joint.at),
        axis=(mirrored_vector if joint.type == "prismatic" else mirrored_turn)(joint.axis),
        motor=motor and replace(motor, name=renamed(motor.name)),
        axes=WORLD if joint.axes == WORLD else (mirrored_turn(x), mirrored_turn(y), mirrored_turn(z)),
    )
