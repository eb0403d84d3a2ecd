"""Draws a delta robot of the size of ABB's IRB 360. Run as ``python -m robots.delta.build [FOLDER]``.

World: origin in the middle of the plane by which the robot hangs, z up, x toward the first arm; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Cylinder, Drawing, Motor, Sphere, Vector3, ball, revolute, universal, write

# The first arm, in the plane y = 0; the others are turned by 120 and 240 degrees about z.
SHOULDER = (0.1750, 0.0, -0.2630)
ELBOW = (0.6820, 0.0, -0.2990)
WRIST = (0.0760, 0.0, -1.1512)

#: The two rods of a forearm, a and b, run this far to either side of its middle, m.
HALF_WIDTH = 0.06

ARMS = (1, 2, 3)
RODS = [(arm, rod) for arm in ARMS for rod in "ab"]
ROD_RADIUS = 0.008
ROD_MASS = 0.2

LEFT = (0.0, 1.0, 0.0)

#: Angle of an arm as drawn, below the level, degrees.
ARM_DRAWN = math.degrees(math.atan2(SHOULDER[2] - ELBOW[2], ELBOW[0] - SHOULDER[0]))
ARM_MOTOR = Motor(effort=200.0, velocity=12.0)


def draw() -> Drawing:
    """The robot with every joint at zero: the platform in the middle, all arms alike."""
    robot = Drawing(
        "delta",
        materials={
            "base": (0.58, 0.62, 0.68, 1.0),
            "arm": (0.9, 0.45, 0.1, 1.0),
            "rod": (0.25, 0.26, 0.3, 1.0),
            "platform": (0.45, 0.55, 0.7, 1.0),
        },
        metadata={
            "description": "Delta robot of the size of ABB's IRB 360-6/1600, without its fourth axis",
            "license": "BSD-3-Clause",
            "source": "Figures taken by harshalaptraise/delta-hil from ABB's published CAD",
        },
    )
    draw_base(robot)
    for arm in ARMS:
        draw_arm(robot, arm)
    draw_platform(robot)
    for arm, rod in RODS[1:]:
        draw_rod(robot, arm, rod)
    return robot


def draw_base(robot: Drawing) -> None:
    """The housing, with the three gearboxes."""
    gearboxes = (
        Cylinder(around(arm, SHOULDER, -0.07), around(arm, SHOULDER, 0.07), radius=0.06, mass=15.0) for arm in ARMS
    )
    robot.body(
        "base",
        None,
        Cylinder((0.0, 0.0, -0.03), (0.0, 0.0, 0.0), radius=0.26, mass=20.0),
        Cylinder((0.0, 0.0, -0.26), (0.0, 0.0, -0.03), radius=0.15, mass=40.0),
        *gearboxes,
        material="base",
    )


def draw_arm(robot: Drawing, arm: int) -> None:
    """An upper arm on its motor, with the pins of the forearm across its end."""
    robot.body(
        f"arm_{arm}",
        revolute(
            f"motor_{arm}",
            "base",
            around(arm, SHOULDER),
            around(arm, LEFT),
            degrees=(-40.0, 80.0),
            drawn=ARM_DRAWN,
            motor=ARM_MOTOR,
        ),
        Cylinder(around(arm, SHOULDER, -0.08), around(arm, SHOULDER, 0.08), radius=0.045, mass=0.6),
        Cylinder(around(arm, SHOULDER), around(arm, ELBOW), radius=0.03, mass=1.2),
        Cylinder(around(arm, ELBOW, -HALF_WIDTH), around(arm, ELBOW, HALF_WIDTH), radius=0.008, mass=0.2),
        material="arm",
    )


def draw_platform(robot: Drawing) -> None:
    """The first rod of the first forearm, and the platform, which hangs from it by a ball."""
    elbow, wrist = rod_ends(1, "a")
    robot.body(
        "rod_1a",
        universal("universal_rod_1a", "arm_1", elbow, LEFT, (elbow[2] - wrist[2], 0.0, wrist[0] - elbow[0])),
        Cylinder(elbow, wrist, ROD_RADIUS, mass=ROD_MASS * 0.75),
        Sphere(elbow, 2.0 * ROD_RADIUS, mass=ROD_MASS * 0.125),
        Sphere(wrist, 2.0 * ROD_RADIUS, mass=ROD_MASS * 0.125),
        material="rod",
    )
    pins = (
        Cylinder(around(arm, WRIST, -HALF_WIDTH), around(arm, WRIST, HALF_WIDTH), radius=0.008, mass=0.08)
        for arm in ARMS
    )
    robot.body(
        "platform",
        ball("ball_platform", "rod_1a", wrist),
        Cylinder((0.0, 0.0, WRIST[2] - 0.02), (0.0, 0.0, WRIST[2] + 0.01), radius=0.075, mass=0.7),
        Cylinder((0.0, 0.0, WRIST[2] - 0.06), (0.0, 0.0, WRIST[2] - 0.02), radius=0.025, mass=0.2),
        *pins,
        material="platform",
    )


def draw_rod(robot: Drawing, arm: int, rod: str) -> None:
    """Another rod of a forearm, from a universal joint at the elbow to a ball on the platform."""
    elbow, wrist = rod_ends(arm, rod)
    robot.rod(
        f"rod_{arm}{rod}",
        (f"arm_{arm}", elbow),
        ("platform", wrist),
        radius=ROD_RADIUS,
        mass=ROD_MASS,
        material="rod",
        ends=("universal", "point"),
    )


def rod_ends(arm: int, rod: str) -> tuple[Vector3, Vector3]:
    """Where a rod begins, on the arm, and ends, on the platform."""
    y = HALF_WIDTH if rod == "a" else -HALF_WIDTH
    return around(arm, ELBOW, y), around(arm, WRIST, y)


def around(arm: int, point: Vector3, y: float = 0.0) -> Vector3:
    """A point or direction given for the first arm, moved along y (m), then turned to another arm."""
    angle = math.radians(120.0 * (arm - 1))
    x, y = point[0], point[1] + y
    return (x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle), point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
