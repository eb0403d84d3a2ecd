"""Draws the five-bar robot DexTAR. Run as ``python -m robots.dextar.build [FOLDER]``.

World: origin on the table in the middle between the motors, x along the line of the motors, y toward the work, z up;
m, kg. The links move in horizontal planes.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, prismatic, revolute, write

# All four links have the same length. The figures are estimates.
LINK = 0.09
MOTORS = {1: (-0.059, 0.0, 0.0), 2: (0.059, 0.0, 0.0)}

#: The tip in all named configurations.
TIP = (0.0, 0.12, 0.0)

# Heights of the links: z, m. All joints are drawn in the plane z = 0.
PROXIMAL_HEIGHT = 0.12
DISTAL_HEIGHTS = {1: 0.138, 2: 0.156}

UP = (0.0, 0.0, 1.0)
#: Side of the line from motor to tip on which an elbow is, as drawn: +1 is to the left.
DRAWN = {1: 1.0, 2: -1.0}

#: The other working modes.
WORKING_MODES = {
    "elbows_in": {1: -1.0, 2: 1.0},
    "elbows_left": {1: 1.0, 2: 1.0},
    "elbows_right": {1: -1.0, 2: -1.0},
}


def angles(leg: int, side: float) -> tuple[float, float]:
    """Directions of the proximal and the distal link, from x toward y (rad), with the elbow on a side."""
    across, ahead = TIP[0] - MOTORS[leg][0], TIP[1] - MOTORS[leg][1]
    middle, off = math.atan2(ahead, across), side * math.acos(0.5 * math.hypot(across, ahead) / LINK)
    return middle + off, middle - off


def elbow(leg: int) -> Vector3:
    """The elbow as drawn."""
    angle, _ = angles(leg, DRAWN[leg])
    return (MOTORS[leg][0] + LINK * math.cos(angle), MOTORS[leg][1] + LINK * math.sin(angle), 0.0)


ELBOWS = {leg: elbow(leg) for leg in MOTORS}
#: Angle from distal link 1 to distal link 2 as drawn, degrees.
TIP_ANGLE = math.degrees(angles(2, DRAWN[2])[1] - angles(1, DRAWN[1])[1])


def draw() -> Drawing:
    """The robot with every joint at zero."""
    robot = Drawing(
        "dextar",
        materials={
            "base": (0.27, 0.29, 0.33, 1.0),
            "proximal": (0.8, 0.35, 0.15, 1.0),
            "distal": (0.3, 0.5, 0.7, 1.0),
            "tool": (0.85, 0.7, 0.25, 1.0),
        },
        metadata={
            "description": "DexTAR, a five-bar robot with four equal links, in its four working modes",
            "license": "BSD-3-Clause",
            "source": "Arrangement and working modes of DexTAR; figures estimated",
        },
    )
    motors = [Cylinder(at_height(at, 0.02), at_height(at, 0.1), radius=0.03, mass=0.6) for at in MOTORS.values()]
    robot.body("base", None, Box((0.0, 0.0, 0.01), (0.22, 0.1, 0.02), mass=1.2), *motors, material="base")
    motor = Motor(effort=3.0, velocity=10.0)
    for leg, at in MOTORS.items():
        robot.body(
            f"proximal_{leg}",
            revolute(f"motor_{leg}", "base", at, UP, degrees=(-170.0, 170.0), motor=motor),
            bar(at, ELBOWS[leg], PROXIMAL_HEIGHT),
            pin(at, 0.1, PROXIMAL_HEIGHT),
            pin(ELBOWS[leg], PROXIMAL_HEIGHT, DISTAL_HEIGHTS[leg]),
            material="proximal",
        )
    robot.body(
        "distal_1",
        revolute("free_elbow_1", "proximal_1", ELBOWS[1], UP),
        bar(ELBOWS[1], TIP, DISTAL_HEIGHTS[1]),
        material="distal",
    )
    # At 0 and 180 degrees the distal links are in line.
    robot.body(
        "distal_2",
        revolute("free_tip", "distal_1", TIP, UP, degrees=(-165.0, 165.0), drawn=TIP_ANGLE),
        bar(ELBOWS[2], TIP, DISTAL_HEIGHTS[2]),
        pin(TIP, DISTAL_HEIGHTS[2], DISTAL_HEIGHTS[1]),
        material="distal",
    )
    robot.body(
        "tool",
        prismatic("motor_tool", "distal_1", TIP, UP, metres=(-0.02, 0.01), motor=Motor(effort=20.0, velocity=0.1)),
        Cylinder(at_height(TIP, 0.05), at_height(TIP, 0.18), radius=0.004, mass=0.04),
        material="tool",
    )
    robot.close("elbow_2", "3d", "distal_2", "proximal_2", at_height(ELBOWS[2], DISTAL_HEIGHTS[2]))
    robot.frame("tool_tip", "tool", at_height(TIP, 0.05))
    for name, sides in WORKING_MODES.items():
        robot.configure(name, **pose(sides))
    return robot


def pose(sides: dict[int, float]) -> dict[str, float]:
    """Coordinates of the joints in a working mode, the tip as drawn."""
    (proximal_1, distal_1), (proximal_2, distal_2) = (
        [now - drawn for now, drawn in zip(angles(leg, sides[leg]), angles(leg, DRAWN[leg]), strict=True)]
        for leg in MOTORS
    )
    return {
        "motor_1": proximal_1,
        "motor_2": proximal_2,
        "free_elbow_1": distal_1 - proximal_1,
        "free_tip": distal_2 - distal_1,
    }


def bar(start: Vector3, end: Vector3, z: float) -> Cylinder:
    """A link at the height ``z`` (m)."""
    return Cylinder(at_height(start, z), at_height(end, z), radius=0.007, mass=0.05)


def pin(at: Vector3, start: float, end: float) -> Cylinder:
    """A pin between two heights (m)."""
    return Cylinder(at_height(at, start), at_height(at, end), radius=0.005, mass=0.01)


def at_height(point: Vector3, z: float) -> Vector3:
    """The point moved to the height ``z`` (m)."""
    return (point[0], point[1], z)


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
