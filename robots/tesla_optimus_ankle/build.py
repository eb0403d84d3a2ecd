"""Draws an ankle like that of Tesla's Optimus. Run as ``python -m robots.tesla_optimus_ankle.build [FOLDER]``.

World: origin in the middle of the ankle, where its axes meet, x forward, y to the left, z up along the shank; m, kg.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Sphere, Vector3, prismatic, revolute, universal, write

KNEE = (0.0, 0.0, 0.40)
ANKLE = (0.0, 0.0, 0.0)
SOLE = (0.05, 0.0, -0.07)

# The left one of two actuators side by side behind the shank: the universal joint at its upper end, and the
# ball at the heel.
TOP = (-0.05, 0.035, 0.34)
HEEL = (-0.05, 0.035, 0.005)

FORWARD = (1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
DOWN = (0.0, 0.0, -1.0)

#: A roller screw: force in N, speed in m/s.
ACTUATOR = Motor(effort=4000.0, velocity=0.25)


def draw() -> Drawing:
    """The ankle with every joint at zero: the sole level, the actuators upright."""
    robot = Drawing(
        "tesla_optimus_ankle",
        materials={
            "shell": (0.58, 0.62, 0.68, 1.0),
            "motor": (0.2, 0.21, 0.24, 1.0),
            "foot": (0.35, 0.37, 0.42, 1.0),
            "rod": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": "Ankle like that of Tesla's Optimus: two linear actuators behind a fixed shank",
            "license": "BSD-3-Clause",
            "source": "Two linear actuators an ankle are public, all dimensions are estimates",
        },
    )
    draw_shank(robot)
    draw_foot(robot)
    draw_left_actuator(robot)
    robot.mirror("left", "right")
    return robot


def draw_shank(robot: Drawing) -> None:
    """The shank, from the knee to the fork at the ankle, with the bracket of the actuators at its back."""
    robot.body(
        "shank",
        None,
        Cylinder(beside(KNEE, -0.045), beside(KNEE, 0.045), radius=0.045, mass=0.7),
        Box((0.0, 0.0, 0.215), (0.055, 0.07, 0.37), mass=1.2),
        Box((-0.03, 0.0, TOP[2]), (0.03, 0.1, 0.02), mass=0.2),
        Box((0.0, 0.033, 0.015), (0.03, 0.008, 0.06), mass=0.06),
        Box((0.0, -0.033, 0.015), (0.03, 0.008, 0.06), mass=0.06),
        material="shell",
    )


def draw_foot(robot: Drawing) -> None:
    """The ankle's cross, from pitch to roll, and the foot with the two balls at the heel."""
    robot.body(
        "cross",
        revolute("free_pitch", "shank", ANKLE, LEFT, degrees=(-25.0, 45.0)),
        Cylinder(beside(ANKLE, -0.03), beside(ANKLE, 0.03), radius=0.009, mass=0.1),
        Cylinder((-0.025, 0.0, 0.0), (0.025, 0.0, 0.0), radius=0.009, mass=0.08),
        material="motor",
    )
    sole = Box(SOLE, (0.24, 0.095, 0.02), mass=0.6)
    robot.body(
        "foot",
        revolute("free_roll", "cross", ANKLE, FORWARD, degrees=(-20.0, 20.0)),
        sole,
        Box((0.031, 0.0, -0.025), (0.012, 0.04, 0.07), mass=0.12),
        Box((-0.031, 0.0, -0.025), (0.012, 0.04, 0.07), mass=0.12),
        Cylinder((-0.037, 0.0, HEEL[2]), (HEEL[0], 0.0, HEEL[2]), radius=0.008, mass=0.05),
        Cylinder(HEEL, beside(HEEL, -HEEL[1]), radius=0.006, mass=0.06),
        material="foot",
        contacts=(sole,),
    )


def draw_left_actuator(robot: Drawing) -> None:
    """A linear actuator: its housing hangs from the shank, and its piston ends in a ball at the heel."""
    x, y, _ = TOP
    robot.body(
        "left_housing",
        universal("left_universal", "shank", TOP, LEFT, FORWARD),
        Sphere(TOP, radius=0.014, mass=0.05),
        Cylinder(TOP, (x, y, 0.30), radius=0.009, mass=0.05),
        Cylinder((x, y, 0.30), (x, y, 0.20), radius=0.026, mass=0.4),
        Cylinder((x, y, 0.20), (x, y, 0.14), radius=0.018, mass=0.15),
        material="motor",
    )
    robot.body(
        "left_piston",
        prismatic("left_motor", "left_housing", HEEL, DOWN, metres=(0.0, 0.085), drawn=0.05, motor=ACTUATOR),
        Cylinder((x, y, 0.22), HEEL, radius=0.008, mass=0.2),
        Sphere(HEEL, radius=0.012, mass=0.05),
        material="rod",
    )
    robot.close("left_heel", "3d", "left_piston", "foot", HEEL)


def beside(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
