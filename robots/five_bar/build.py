"""Draws a planar five-bar linkage. Run as ``python -m robots.five_bar.build [FOLDER]``.

World: x to the side, y away from the viewer, z up, origin on the ground between the motors; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Joint, Motor, Vector3, revolute, write

# The five pins, in the plane y = 0. The motors are 30 cm apart, every bar is 46 cm long, and the arms lean outward by
# 7 in 25.
BAR = 0.46
MOTORS = {1: (-0.15, 0.0, 0.06), 2: (0.15, 0.0, 0.06)}
ELBOWS = {1: (-0.2788, 0.0, 0.5016), 2: (0.2788, 0.0, 0.5016)}
RISE = math.sqrt(BAR**2 - 0.2788**2)
TIP = (0.0, 0.0, 0.5016 + RISE)

#: The tool is 6.75 cm beyond the tip, on the line of forearm 2.
TOOL = (TIP[0] - 0.2788 * 0.0675 / BAR, 0.0, TIP[2] + RISE * 0.0675 / BAR)

# Planes of the bars, one behind the other: y, m.
ARM_PLANE = 0.03
FOREARM_PLANES = {1: 0.0, 2: -0.03}

# Axes about which the bars turn toward -x and toward +x.
TO_LEFT = (0.0, -1.0, 0.0)
TO_RIGHT = (0.0, 1.0, 0.0)
OUTWARD = {1: TO_LEFT, 2: TO_RIGHT}
INWARD = {1: TO_RIGHT, 2: TO_LEFT}

#: How far arms and forearms lean as drawn, from upright, degrees.
ARM_LEAN = math.degrees(math.asin(7.0 / 25.0))
FOREARM_LEAN = math.degrees(math.asin(0.2788 / BAR))

MATERIALS = {
    "ground": (0.3, 0.3, 0.33, 1.0),
    "driven": (0.8, 0.35, 0.15, 1.0),
    "bar": (0.45, 0.55, 0.7, 1.0),
    "tool": (0.85, 0.7, 0.25, 1.0),
}


def draw() -> Drawing:
    """The linkage with every joint at zero."""
    robot = drawing("five_bar", "Planar five-bar linkage, two motors and five revolutes")
    draw_arms(robot)
    robot.body("forearm_1", elbow(1), forearm(1), material="bar")
    robot.body("forearm_2", elbow(2), forearm(2), material="bar")
    # Between the forearms: 17.5 to 151.3 degrees over the range of the motors.
    tip = revolute("free_tip", "forearm_1", TIP, TO_LEFT, degrees=(13.0, 156.0), drawn=2.0 * FOREARM_LEAN)
    robot.body("tool", tip, *tool(), material="tool")
    robot.close("tip", "6d", "tool", "forearm_2", TIP)
    return robot


def drawing(name: str, description: str) -> Drawing:
    """An empty drawing of a five-bar linkage."""
    return Drawing(
        name,
        MATERIALS,
        metadata={
            "description": description,
            "license": "BSD-3-Clause",
            "source": "Lengths of 5bar_linkage of Gepetto/example-parallel-robots",
        },
    )


def draw_arms(robot: Drawing) -> None:
    """The base with both motors, and the arm on each. An arm swings from 10 degrees inward to 40 outward."""
    robot.body(
        "base",
        None,
        Box((0.0, 0.06, 0.01), (0.5, 0.2, 0.02), mass=5.4),
        *(Cylinder(at_plane(motor, 0.05), at_plane(motor, 0.15), radius=0.04, mass=1.0) for motor in MOTORS.values()),
        material="ground",
    )
    motor = Motor(effort=15.0, velocity=10.0)
    for number, at in MOTORS.items():
        robot.body(
            f"arm_{number}",
            revolute(
                f"motor_{number}", "base", at, OUTWARD[number], degrees=(-10.0, 40.0), drawn=ARM_LEAN, motor=motor
            ),
            bar(at, ELBOWS[number], ARM_PLANE),
            pin(at, ARM_PLANE, 0.05),
            pin(ELBOWS[number], ARM_PLANE, FOREARM_PLANES[number]),
            material="driven",
        )


def elbow(number: int) -> Joint:
    """The elbow of an arm: 0 where arm and forearm are in line; -1.2 to 115.7 degrees over the range of the motors."""
    drawn = ARM_LEAN + FOREARM_LEAN
    return revolute(
        f"free_elbow_{number}",
        f"arm_{number}",
        ELBOWS[number],
        INWARD[number],
        degrees=(-6.0, 120.0),
        drawn=drawn,
    )


def forearm(number: int) -> Cylinder:
    """The bar of a forearm, from elbow to tip."""
    return bar(ELBOWS[number], TIP, FOREARM_PLANES[number])


def tool() -> tuple[Cylinder, Cylinder]:
    """The tool, which is the end of forearm 2 beyond the tip, and the pin there."""
    return (bar(TIP, TOOL, FOREARM_PLANES[2]), pin(TIP, FOREARM_PLANES[1], FOREARM_PLANES[2]))


def bar(start: Vector3, end: Vector3, y: float) -> Cylinder:
    """A round bar between two pins, in the plane ``y`` (m): aluminium, 24 mm thick."""
    mass = 1.22 * math.dist(start, end)
    return Cylinder(at_plane(start, y), at_plane(end, y), radius=0.012, mass=round(mass, 4))


def pin(at: Vector3, start: float, end: float) -> Cylinder:
    """A pin through two planes ``y`` (m)."""
    return Cylinder(at_plane(at, start), at_plane(at, end), radius=0.008, mass=0.05)


def at_plane(point: Vector3, y: float) -> Vector3:
    """The point moved into the plane ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
