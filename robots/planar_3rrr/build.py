"""Draws the planar 3-RRR robot. Run as ``python -m robots.planar_3rrr.build [FOLDER]``.

World: x to the side, y away from the viewer, z up, origin in the middle of the triangle of the motors; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, revolute, write

# Published lengths: motors and pins of the platform in equilateral triangles, arms, forearms.
BASE_SIDE = 1.0
PLATFORM_SIDE = 0.4
ARM = 0.4
FOREARM = 0.6

# Planes of what moves, one behind the other: y, m. All joints are drawn in the plane y = 0.
ARM_PLANE = 0.05
FOREARM_PLANE = 0.0
PLATFORM_PLANE = -0.05

ACROSS = (0.0, 1.0, 0.0)


def on_circle(radius: float, degrees: float) -> Vector3:
    """The point of a circle about the origin, at an angle from x toward z."""
    angle = math.radians(degrees)
    return (radius * math.cos(angle), 0.0, radius * math.sin(angle))


# Leg 1 is at the lower left, and each leg is the one before, turned by 120 degrees. As drawn, every arm is at a right
# angle to the line from its motor to the middle.
DIRECTIONS = {1: 210.0, 2: 330.0, 3: 90.0}
BASE_RADIUS = BASE_SIDE / math.sqrt(3.0)
PLATFORM_RADIUS = PLATFORM_SIDE / math.sqrt(3.0)
ELBOW_RADIUS = math.hypot(BASE_RADIUS, ARM)

# Seen from the middle: the angle from motor to elbow, and from elbow to the pin of the platform.
TO_ELBOW = -math.degrees(math.atan2(ARM, BASE_RADIUS))
TO_PIN = math.degrees(
    math.acos((ELBOW_RADIUS**2 + PLATFORM_RADIUS**2 - FOREARM**2) / (2.0 * ELBOW_RADIUS * PLATFORM_RADIUS))
)

MOTORS = {leg: on_circle(BASE_RADIUS, angle) for leg, angle in DIRECTIONS.items()}
ELBOWS = {leg: on_circle(ELBOW_RADIUS, angle + TO_ELBOW) for leg, angle in DIRECTIONS.items()}
PINS = {leg: on_circle(PLATFORM_RADIUS, angle + TO_ELBOW + TO_PIN) for leg, angle in DIRECTIONS.items()}


def draw() -> Drawing:
    """The robot with every joint at zero."""
    robot = Drawing(
        "planar_3rrr",
        materials={
            "ground": (0.3, 0.3, 0.33, 1.0),
            "driven": (0.8, 0.35, 0.15, 1.0),
            "bar": (0.45, 0.55, 0.7, 1.0),
            "platform": (0.85, 0.7, 0.25, 1.0),
        },
        metadata={
            "description": "Planar 3-RRR parallel robot: a platform on three legs of three revolutes",
            "license": "BSD-3-Clause",
            "source": "Lengths and masses of the 3-RRR example of ReDySim",
        },
    )
    draw_base(robot)
    for leg in DIRECTIONS:
        draw_leg(robot, leg)
    # Over the range of the motors the platform turns on forearm 1 from -69 to 43 degrees.
    pin = revolute("free_pin_1", "forearm_1", PINS[1], ACROSS, degrees=(-80.0, 55.0))
    robot.body("platform", pin, *platform(), material="platform")
    for leg in (2, 3):
        robot.close(f"pin_{leg}", "3d", f"forearm_{leg}", "platform", PINS[leg])
    return robot


def draw_base(robot: Drawing) -> None:
    """The frame that holds the motors."""
    corners = [MOTORS[leg] for leg in DIRECTIONS]
    beams = [
        Cylinder(at_plane(start, 0.16), at_plane(end, 0.16), radius=0.02, mass=3.0)
        for start, end in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    motors = [Cylinder(at_plane(corner, 0.09), at_plane(corner, 0.19), radius=0.06, mass=4.0) for corner in corners]
    robot.body("base", None, *beams, *motors, material="ground")


def draw_leg(robot: Drawing, leg: int) -> None:
    """The motor, arm and forearm of a leg. An arm swings from 20 degrees outward to 40 inward."""
    motor = Motor(effort=80.0, velocity=5.0)
    robot.body(
        f"arm_{leg}",
        revolute(f"motor_{leg}", "base", MOTORS[leg], ACROSS, degrees=(-20.0, 40.0), motor=motor),
        bar(MOTORS[leg], ELBOWS[leg], ARM_PLANE, mass=2.6),
        axle(MOTORS[leg], 0.09, ARM_PLANE),
        axle(ELBOWS[leg], ARM_PLANE, FOREARM_PLANE),
        material="driven",
    )
    robot.body(
        f"forearm_{leg}",
        # -37 to 28 degrees over the range of the motors.
        revolute(f"free_elbow_{leg}", f"arm_{leg}", ELBOWS[leg], ACROSS, degrees=(-45.0, 40.0)),
        bar(ELBOWS[leg], PINS[leg], FOREARM_PLANE, mass=3.8),
        axle(PINS[leg], FOREARM_PLANE, PLATFORM_PLANE),
        material="bar",
    )


def platform() -> tuple[Box | Cylinder, ...]:
    """The platform: three beams and a hub."""
    beams = [bar((0.0, 0.0, 0.0), at, PLATFORM_PLANE, mass=1.6) for at in PINS.values()]
    hub = Cylinder((0.0, PLATFORM_PLANE - 0.03, 0.0), (0.0, PLATFORM_PLANE + 0.03, 0.0), radius=0.06, mass=3.2)
    return (*beams, hub)


def bar(start: Vector3, end: Vector3, y: float, mass: float) -> Cylinder:
    """A round bar in the plane ``y`` (m)."""
    return Cylinder(at_plane(start, y), at_plane(end, y), radius=0.02, mass=mass)


def axle(at: Vector3, start: float, end: float) -> Cylinder:
    """An axle through two planes ``y`` (m)."""
    return Cylinder(at_plane(at, start), at_plane(at, end), radius=0.015, mass=0.2)


def at_plane(point: Vector3, y: float) -> Vector3:
    """The point moved into the plane ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
