"""Robots drawn in one assembled pose, in world coordinates, and written as Extended URDF.

Every body's frame has its origin at the joint that carries the body, and its axes parallel to the world's in the drawn
pose; only those of a universal joint lie along its two axes. So the drawn pose is the one in which every joint is
at zero, and every loop is closed there because both its sides are the same point of the drawing.
"""

from robots.builder.assembled import assembled_at
from robots.builder.drawing import Drawing, End
from robots.builder.joint import Joint, Motor, Spring, ball, cross, prismatic, revolute, unit, universal
from robots.builder.shape import Box, Cylinder, Shape, Sphere, Vector3, midpoint, rotation_of_quaternion
from robots.builder.solid import Solid, solid_of
from robots.builder.write import write

__all__ = [
    "Box",
    "Cylinder",
    "Drawing",
    "End",
    "Joint",
    "Motor",
    "Shape",
    "Solid",
    "Sphere",
    "Spring",
    "Vector3",
    "assembled_at",
    "ball",
    "cross",
    "midpoint",
    "prismatic",
    "revolute",
    "rotation_of_quaternion",
    "solid_of",
    "unit",
    "universal",
    "write",
]
