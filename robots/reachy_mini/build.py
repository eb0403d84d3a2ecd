"""Draws Pollen Robotics' Reachy Mini. Run as ``python -m robots.reachy_mini.build [FOLDER]``.

World: origin under the foot, as in the published description, x forward, y to the left, z up; m, kg, rad.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from robots.builder import (
    Box,
    Cylinder,
    Drawing,
    Motor,
    Solid,
    Sphere,
    Vector3,
    ball,
    cross,
    revolute,
    universal,
    write,
)

YAW = (0.0, 0.0, 0.0348)

# Six motors in three pairs on a circle, their axes toward the middle: distance of a pair from it, half the distance of
# its two motors, and their height.
MOTOR_RADIUS = 0.0436606
MOTOR_HALF_SPACING = 0.01
MOTOR_HEIGHT = 0.0766335

# A crank reaches this far across its motor's axis, away from its pair; its ball is this far along the axis.
CRANK = 0.04
CRANK_OFFSET = 0.007

# The balls on the head are in pairs above the motors.
HEAD_RADIUS = 0.0291721
HEAD_HALF_SPACING = 0.007
HEAD_HEIGHT = 0.1495712

CAMERA = (0.0395, 0.0, 0.2020711)
ANTENNA = (-0.0367571, 0.0521924, 0.2215904)
ANTENNA_AXIS = (0.861282, -0.497260, -0.104529)
#: Where the antenna begins, on the horn of its motor, and where it ends; the length is an estimate.
ANTENNA_FOOT = (-0.0442, 0.0565, 0.2225)
ANTENNA_TIP = (-0.0334, 0.0579, 0.3320)

UP = (0.0, 0.0, 1.0)

# As ROBOTIS states them at 5 V: stall torque, velocity without load and gear.
BODY_MOTOR = Motor(effort=0.93, velocity=8.48, gear_ratio=288.35)
CRANK_MOTOR = Motor(effort=0.52, velocity=10.79, gear_ratio=288.4)
ANTENNA_MOTOR = Motor(effort=0.215, velocity=40.1, gear_ratio=77.5)

CRANKS = (1, 2, 3, 4, 5, 6)

#: Of each crank, lowest and highest angle, degrees. Published is 80 in place of 56: with the other cranks level, one
#: alone has its dead point, in line with its rod, at 57.4.
STOPS = {1: (-48.0, 56.0), 2: (-56.0, 56.0), 3: (-48.0, 56.0), 4: (-56.0, 48.0), 5: (-56.0, 56.0), 6: (-56.0, 48.0)}


def draw() -> Drawing:
    """The robot with every joint at zero: the head level, the antennas up."""
    robot = Drawing(
        "reachy_mini",
        materials={
            "body": (0.58, 0.62, 0.68, 1.0),
            "motor": (0.22, 0.23, 0.26, 1.0),
            "rod": (0.85, 0.5, 0.15, 1.0),
            "head": (0.45, 0.55, 0.7, 1.0),
        },
        metadata={
            "description": "Pollen Robotics' Reachy Mini, whose head is on a Stewart platform, from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of pollen-robotics/reachy_mini: mjcf/reachy_mini.xml",
        },
    )
    draw_body(robot)
    for crank in CRANKS:
        draw_crank(robot, crank)
    draw_head(robot)
    draw_antenna(robot)
    robot.mirror("left", "right")
    robot.frame("head_middle", "head", (0.0, 0.0, HEAD_HEIGHT))
    robot.frame("camera", "head", CAMERA, (-math.pi / 2.0, 0.0, -math.pi / 2.0))
    robot.configure("look_left", yaw_body=math.pi / 4.0, left_antenna=0.4, right_antenna=0.4)
    return robot


def draw_body(robot: Drawing) -> None:
    """The foot, and the body that turns on it, without its shell, so that the cranks are seen."""
    foot = Cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 0.0348), radius=0.055)
    figures = Solid(0.0617881, (0.0029, 0.0001, 0.01326), np.diag([6.915e-5, 6.073e-5, 1.1035e-4]))
    robot.body("foot", None, foot, material="motor", contacts=(foot,), solid=figures)
    motors = (
        Box(
            point(crank, MOTOR_RADIUS + 0.013, sign(crank) * MOTOR_HALF_SPACING, MOTOR_HEIGHT - 0.0075),
            (0.026, 0.02, 0.034),
            rpy=(0.0, 0.0, pair(crank)),
        )
        for crank in CRANKS
    )
    robot.body(
        "body",
        revolute("yaw_body", "foot", YAW, UP, degrees=(-160.0, 160.0), motor=BODY_MOTOR),
        Cylinder(YAW, (0.0, 0.0, 0.0525), radius=0.075),
        *motors,
        material="body",
        solid=Solid(
            0.78209,
            (0.00062, 0.0, 0.05497),
            np.array([[2.2446e-3, 0.0, -4.46e-5], [0.0, 2.3379e-3, 0.0], [-4.46e-5, 0.0, 2.5442e-3]]),
        ),
    )


def draw_crank(robot: Drawing, crank: int) -> None:
    """A motor's crank, and the rod on it: a universal joint keeps the rod from spinning."""
    horn = point(crank, MOTOR_RADIUS, sign(crank) * MOTOR_HALF_SPACING, MOTOR_HEIGHT)
    inward = unit_toward(crank)
    plane = moved(horn, inward, CRANK_OFFSET / 2.0)
    elbow = point(crank, MOTOR_RADIUS - CRANK_OFFSET / 2.0, sign(crank) * (MOTOR_HALF_SPACING + CRANK), MOTOR_HEIGHT)
    robot.body(
        f"crank_{crank}",
        revolute(f"motor_{crank}", "body", horn, inward, degrees=STOPS[crank], motor=CRANK_MOTOR),
        Cylinder(horn, moved(horn, inward, 0.004), radius=0.008, mass=0.0008),
        Cylinder(plane, elbow, radius=0.003, mass=0.0018),
        Sphere(lower(crank), radius=0.004, mass=0.00106675),
        material="motor",
    )
    start, end = lower(crank), upper(crank)
    x, y, z = (b - a for a, b in zip(start, end, strict=True))
    level = (-y, x, 0.0)
    robot.body(
        f"rod_{crank}",
        universal(f"universal_{crank}", f"crank_{crank}", start, level, cross((x, y, z), level)),
        Cylinder(start, end, radius=0.002, mass=0.00303424),
        Sphere(start, radius=0.0045, mass=0.001),
        Sphere(end, radius=0.0045, mass=0.001),
        material="rod",
    )


def draw_head(robot: Drawing) -> None:
    """The head: it hangs on the ball of the sixth rod, and closures hold it on the other five."""
    robot.body(
        "head",
        ball("ball_6", "rod_6", upper(6)),
        Cylinder((0.0, 0.0, HEAD_HEIGHT + 0.003), (0.0, 0.0, HEAD_HEIGHT + 0.009), radius=0.036),
        Cylinder((0.0, 0.0, HEAD_HEIGHT + 0.009), (0.0, 0.0, 0.18), radius=0.02),
        Box((-0.005, 0.0, 0.208), (0.07, 0.11, 0.066)),
        Cylinder((0.03, 0.026, 0.208), (0.042, 0.026, 0.208), radius=0.02),
        Cylinder((0.03, -0.024, 0.208), (0.042, -0.024, 0.208), radius=0.015),
        *(Sphere(upper(crank), radius=0.0055) for crank in CRANKS),
        material="head",
        solid=Solid(
            0.259259,
            (0.00327, -0.00097, 0.20085),
            np.array([[6.185e-4, 8.0e-6, 9.5e-6], [8.0e-6, 4.058e-4, 3.0e-7], [9.5e-6, 3.0e-7, 6.584e-4]]),
        ),
    )
    for crank in CRANKS[:-1]:
        robot.close(f"ball_{crank}", "3d", f"rod_{crank}", "head", upper(crank))


def draw_antenna(robot: Drawing) -> None:
    """The left antenna."""
    robot.body(
        "left_antenna_rod",
        revolute("left_antenna", "head", ANTENNA, ANTENNA_AXIS, motor=ANTENNA_MOTOR),
        Cylinder(ANTENNA, ANTENNA_FOOT, radius=0.008),
        Cylinder(ANTENNA_FOOT, ANTENNA_TIP, radius=0.0025),
        material="rod",
        solid=Solid(
            0.0105926,
            (-0.03967, 0.05648, 0.26007),
            np.array([[2.665e-5, -2.1e-8, -2.622e-6], [-2.1e-8, 2.692e-5, -3.28e-7], [-2.622e-6, -3.28e-7, 5.464e-7]]),
        ),
    )


def pair(crank: int) -> float:
    """Direction of the pair of a crank from the middle, rad from x."""
    return math.radians(60.0 + 120.0 * ((crank - 1) // 2))


def sign(crank: int) -> float:
    """Whether a crank is before (-1) or after (1) the middle of its pair, counter-clockwise from above."""
    return -1.0 if crank % 2 == 1 else 1.0


def point(crank: int, radius: float, along: float, z: float) -> Vector3:
    """A point at a distance from the middle toward the pair of a crank, and along across that direction, m."""
    angle = pair(crank)
    return (
        radius * math.cos(angle) - along * math.sin(angle),
        radius * math.sin(angle) + along * math.cos(angle),
        z,
    )


def unit_toward(crank: int) -> Vector3:
    """The unit vector from the pair of a crank toward the middle: the axis of its motor."""
    return (-math.cos(pair(crank)), -math.sin(pair(crank)), 0.0)


def moved(start: Vector3, direction: Vector3, distance: float) -> Vector3:
    """The point at a distance (m) from another, along a unit vector."""
    x, y, z = (a + distance * b for a, b in zip(start, direction, strict=True))
    return (x, y, z)


def lower(crank: int) -> Vector3:
    """Centre of the ball on a crank."""
    return point(crank, MOTOR_RADIUS - CRANK_OFFSET, sign(crank) * (MOTOR_HALF_SPACING + CRANK), MOTOR_HEIGHT)


def upper(crank: int) -> Vector3:
    """Centre of the ball on the head that a crank's rod ends at."""
    return point(crank, HEAD_RADIUS, sign(crank) * HEAD_HALF_SPACING, HEAD_HEIGHT)


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
