"""Draws Sarrus' linkage: a plate lifted straight by hinges. Run as ``python -m robots.sarrus.build [FOLDER]``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, midpoint, revolute, write

# The hinges of both legs, in m. Leg A folds in the plane y = 0, leg B in the plane x = 0; every panel is 10 cm long.
FOOT_A = (0.10, 0.0, 0.0)
KNEE_A = (0.16, 0.0, 0.08)
TOP_A = (0.10, 0.0, 0.16)
FOOT_B = (0.0, -0.10, 0.0)
KNEE_B = (0.0, -0.16, 0.08)
TOP_B = (0.0, -0.10, 0.16)

#: Angle of the lower panels above the ground, degrees: of a triangle 3, 4, 5.
ELEVATION = math.degrees(math.atan2(4.0, 3.0))

#: Where the plate is cut: between the part that leg A carries and the strip along the hinge of leg B.
SEAM = (0.0, -0.06, 0.16)

# About its axis, every hinge turns in the direction in which the plate rises.
FORWARD = (1.0, 0.0, 0.0)
BACK = (-1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
RIGHT = (0.0, -1.0, 0.0)

THICKNESS = 0.008
WIDTH = 0.08


def panel(start: Vector3, end: Vector3) -> Box:
    """The panel between two hinges of a leg."""
    x, y, z = (b - a for a, b in zip(start, end, strict=True))
    length = math.hypot(x, y, z)
    if y == 0.0:
        return Box(midpoint(start, end), (length, WIDTH, THICKNESS), mass=0.16, rpy=(0.0, -math.atan2(z, x), 0.0))
    return Box(midpoint(start, end), (WIDTH, length, THICKNESS), mass=0.16, rpy=(math.atan2(z, y), 0.0, 0.0))


def hinge(at: Vector3, axis: Vector3) -> Cylinder:
    """The knuckles of a hinge."""
    half = 0.6 * WIDTH
    start, end = ((at[0] + side * axis[0], at[1] + side * axis[1], at[2]) for side in (-half, half))
    return Cylinder(start, end, radius=0.007, mass=0.02)


def draw() -> Drawing:
    """The linkage with every joint at zero."""
    robot = Drawing(
        "sarrus",
        materials={
            "ground": (0.3, 0.3, 0.33, 1.0),
            "driven": (0.8, 0.35, 0.15, 1.0),
            "bar": (0.45, 0.55, 0.7, 1.0),
            "strip": (0.85, 0.7, 0.25, 1.0),
        },
        metadata={"description": "Sarrus' linkage, six hinges that lift a plate straight", "license": "BSD-3-Clause"},
    )
    robot.body("ground", None, Box((0.0, 0.0, -0.006), (0.2, 0.2, 0.012), mass=1.3), material="ground")
    draw_leg_a(robot)
    draw_leg_b(robot)
    robot.close("seam", "6d", "plate", "strip", SEAM)
    return robot


def draw_leg_a(robot: Drawing) -> None:
    """The leg with the motor, and the plate. Its lower panel rises from 25 to 75 degrees."""
    motor = Motor(effort=5.0, velocity=5.0)
    robot.body(
        "lower_a",
        revolute("motor_foot_a", "ground", FOOT_A, RIGHT, degrees=(25.0, 75.0), drawn=ELEVATION, motor=motor),
        *(panel(FOOT_A, KNEE_A), hinge(FOOT_A, LEFT)),
        material="driven",
    )
    robot.body(
        "upper_a",
        revolute("free_knee_a", "lower_a", KNEE_A, LEFT, degrees=(44.0, 156.0), drawn=2.0 * ELEVATION),
        *(panel(KNEE_A, TOP_A), hinge(KNEE_A, LEFT)),
        material="bar",
    )
    robot.body(
        "plate",
        revolute("free_top_a", "upper_a", TOP_A, RIGHT, degrees=(22.0, 78.0), drawn=ELEVATION),
        *(Box((0.0, 0.02, 0.166), (0.2, 0.16, 0.012), mass=1.04), hinge(TOP_A, LEFT)),
        material="bar",
    )


def draw_leg_b(robot: Drawing) -> None:
    """The leg without a motor, and the strip of the plate that it carries."""
    robot.body(
        "lower_b",
        revolute("free_foot_b", "ground", FOOT_B, BACK, degrees=(22.0, 78.0), drawn=ELEVATION),
        *(panel(FOOT_B, KNEE_B), hinge(FOOT_B, FORWARD)),
        material="bar",
    )
    robot.body(
        "upper_b",
        revolute("free_knee_b", "lower_b", KNEE_B, FORWARD, degrees=(44.0, 156.0), drawn=2.0 * ELEVATION),
        *(panel(KNEE_B, TOP_B), hinge(KNEE_B, FORWARD)),
        material="bar",
    )
    robot.body(
        "strip",
        revolute("free_top_b", "upper_b", TOP_B, BACK, degrees=(22.0, 78.0), drawn=ELEVATION),
        *(Box((0.0, -0.08, 0.166), (0.2, 0.04, 0.012), mass=0.26), hinge(TOP_B, FORWARD)),
        material="strip",
    )


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
