"""Draws a flight simulator's Stewart platform. Run as ``python -m robots.stewart_platform.build [FOLDER]``.

World: origin in the middle of the lower gimbals, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Sphere, Vector3, ball, prismatic, universal, write

# Six gimbals on a circle below and six above, in pairs; the pairs above are 60 degrees from those below.
LOWER_RADIUS = 1.65
UPPER_RADIUS = 1.60
HEIGHT = 2.39

#: Half the distance of the two gimbals of a pair, m.
LOWER_HALF_SPACING = 0.3
UPPER_HALF_SPACING = 0.1

#: Shortest and longest distance of the gimbals of a leg, m.
LEG_LENGTH = (2.131, 3.281)
LEG_MOTOR = Motor(effort=30000.0, velocity=1.0)

LEGS = (1, 2, 3, 4, 5, 6)


def draw() -> Drawing:
    """The platform in its neutral position: every joint at zero."""
    robot = Drawing(
        "stewart_platform",
        materials={
            "base": (0.3, 0.3, 0.33, 1.0),
            "cylinder": (0.45, 0.55, 0.7, 1.0),
            "piston": (0.85, 0.5, 0.15, 1.0),
            "platform": (0.58, 0.62, 0.68, 1.0),
        },
        metadata={
            "description": "Stewart platform of the size of the SIMONA flight simulator of TU Delft",
            "license": "BSD-3-Clause",
            "source": "Geometry in the source of the simulator's own motion limiter",
        },
    )
    feet = (Cylinder((x, y, -0.2), (x, y, -0.1), radius=0.16, mass=200.0) for x, y, _ in map(lower, LEGS))
    floor = Cylinder((0.0, 0.0, -0.22), (0.0, 0.0, -0.2), radius=2.0, mass=2000.0)
    robot.body("base", None, floor, *feet, material="base")
    for leg in LEGS:
        draw_leg(robot, leg)
    draw_platform(robot)
    for leg in LEGS[1:]:
        draw_socket(robot, leg)
    return robot


def draw_leg(robot: Drawing, leg: int) -> None:
    """A leg: a universal joint on the base, the cylinder, and the piston that slides in it."""
    start, end = lower(leg), upper(leg)
    x, y, z = (b - a for a, b in zip(start, end, strict=True))
    robot.body(
        f"cylinder_{leg}",
        # The first axis is level; the second lies in the upright plane of the leg. Both are across it.
        universal(f"universal_{leg}", "base", start, (-y, x, 0.0), (x * z, y * z, -(x * x + y * y))),
        Sphere(start, radius=0.1, mass=20.0),
        Cylinder(start, along(leg, 1.75), radius=0.08, mass=130.0),
        material="cylinder",
    )
    length = math.dist(start, end)
    robot.body(
        f"piston_{leg}",
        prismatic(f"motor_{leg}", f"cylinder_{leg}", end, (x, y, z), metres=LEG_LENGTH, drawn=length, motor=LEG_MOTOR),
        Cylinder(along(leg, 1.1), end, radius=0.05, mass=80.0),
        material="piston",
    )


def draw_platform(robot: Drawing) -> None:
    """The platform with the cabin on it; it hangs on the ball of the first leg."""
    ring = (Cylinder(upper(leg), upper(leg % 6 + 1), radius=0.06, mass=60.0) for leg in LEGS)
    robot.body(
        "platform",
        ball("ball_1", "piston_1", upper(1)),
        Sphere(upper(1), radius=0.1, mass=20.0),
        *ring,
        Cylinder((0.0, 0.0, HEIGHT + 0.06), (0.0, 0.0, HEIGHT + 0.16), radius=1.5, mass=900.0),
        Box((-0.1, 0.0, HEIGHT + 1.06), (2.0, 1.9, 1.8), mass=1700.0),
        material="platform",
    )


def draw_socket(robot: Drawing, leg: int) -> None:
    """The ball at the end of another leg, in a socket that is bolted to the platform."""
    socket = Sphere(upper(leg), radius=0.1, mass=20.0)
    robot.body(f"socket_{leg}", ball(f"ball_{leg}", f"piston_{leg}", upper(leg)), socket, material="platform")
    robot.close(f"bolts_{leg}", "6d", f"socket_{leg}", "platform", upper(leg))


def lower(leg: int) -> Vector3:
    """Middle of the lower gimbal of a leg."""
    pair = 60.0 + 120.0 * ((leg - 1) // 2)
    half = math.asin(LOWER_HALF_SPACING / LOWER_RADIUS)
    return on_circle(LOWER_RADIUS, math.radians(pair) + (half if leg % 2 == 0 else -half), 0.0)


def upper(leg: int) -> Vector3:
    """Middle of the upper gimbal of a leg."""
    pair = 120.0 * (leg // 2)
    half = math.asin(UPPER_HALF_SPACING / UPPER_RADIUS)
    return on_circle(UPPER_RADIUS, math.radians(pair) + (half if leg % 2 == 1 else -half), HEIGHT)


def on_circle(radius: float, angle: float, z: float) -> Vector3:
    """The point of a circle about z at an angle (rad) from x."""
    return (radius * math.cos(angle), radius * math.sin(angle), z)


def along(leg: int, distance: float) -> Vector3:
    """The point of a leg at a distance (m) from its lower gimbal."""
    start, end = lower(leg), upper(leg)
    share = distance / math.dist(start, end)
    return (
        start[0] + share * (end[0] - start[0]),
        start[1] + share * (end[1] - start[1]),
        start[2] + share * (end[2] - start[2]),
    )


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
