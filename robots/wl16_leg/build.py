"""Draws the left leg of Waseda's WL-16. Run as ``python -m robots.wl16_leg.build [FOLDER]``.

World: x forward, y to the left, z up, the origin midway between the two legs at the height of the upper balls; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Joint, Motor, Sphere, Vector3, ball, prismatic, write

#: The middle of the leg, and how far the balls of the foot lie below those of the hips.
LEFT, HEIGHT = 0.271, 0.6

# The balls of the hips, two and two closer together on a circle of radius 278.6 mm, round the leg from the front on.
HIP_BALLS: tuple[Vector3, ...] = (
    (0.275, LEFT - 0.0445, 0.0),
    (0.099, LEFT + 0.2604, 0.0),
    (-0.099, LEFT + 0.2604, 0.0),
    (-0.275, LEFT - 0.0445, 0.0),
    (-0.176, LEFT - 0.2159, 0.0),
    (0.176, LEFT - 0.2159, 0.0),
)

# The corners of the foot, in each of which two rods end, one ball about the other.
FRONT = (0.0908, LEFT + 0.0524, -HEIGHT)
BACK = (-0.0908, LEFT + 0.0524, -HEIGHT)
INSIDE = (0.0, LEFT - 0.1048, -HEIGHT)
FOOT_BALLS = (FRONT, FRONT, BACK, BACK, INSIDE, INSIDE)

#: Shortest and longest distance of the two balls of a rod.
REACH = (0.535, 0.735)

# Along a rod as drawn, from the ball of the hips: the far end of the tube; the two ends of the electric motor beside it
# and the bolt that holds it; the hidden end of the piston, and where the piston is cut.
TUBE_END, MOTOR_TOP, MOTOR_END, BOLT, PISTON_TOP, CUT = 0.46, 0.0, 0.2, 0.1, 0.335, 0.5

#: From the middle of a tube to that of the electric motor beside it.
BESIDE = 0.05

ACTUATOR = Motor(effort=600.0, velocity=0.5)


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = Drawing(
        "wl16_leg",
        materials={
            "hips": (0.58, 0.62, 0.68, 1.0),
            "tube": (0.6, 0.15, 0.15, 1.0),
            "piston": (0.65, 0.66, 0.7, 1.0),
            "foot": (0.25, 0.26, 0.3, 1.0),
        },
        metadata={
            "description": "Left leg of Waseda's biped WL-16 on fixed hips, six rods that change their length",
            "license": "BSD-3-Clause",
            "source": "Figures of wl16_like of Gepetto/example-parallel-robots",
        },
    )
    draw_hips(robot)
    for number in range(1, 7):
        draw_tube(robot, number)
    draw_foot(robot)
    for number in range(2, 7):
        draw_cut_piston(robot, number)
    return robot


def draw_hips(robot: Drawing) -> None:
    """The left half of the hips: a plate with six mounts below it."""
    plate = Box((0.0, LEFT, 0.054), (0.6, 0.54, 0.048), mass=21.4)
    mounts = (Cylinder(at, (at[0], at[1], 0.03), radius=0.025, mass=0.1) for at in HIP_BALLS)
    robot.body("hips", None, plate, *mounts, material="hips", contacts=(plate,))


def draw_tube(robot: Drawing, number: int) -> None:
    """The tube of a rod, and bolted to it the electric motor, on the outside of the leg."""
    hip_ball = HIP_BALLS[number - 1]
    radius = math.dist(hip_ball, (0.0, LEFT, 0.0))
    aside = (hip_ball[0] * BESIDE / radius, (hip_ball[1] - LEFT) * BESIDE / radius)
    motor_top, bolt, motor_end = (
        (x + aside[0], y + aside[1], z) for x, y, z in (on_rod(number, along) for along in (MOTOR_TOP, BOLT, MOTOR_END))
    )
    robot.body(
        f"tube{number}",
        ball(f"ball_hip{number}", "hips", hip_ball),
        Cylinder(hip_ball, on_rod(number, TUBE_END), radius=0.02, mass=1.27),
        Cylinder(motor_top, motor_end, radius=0.02, mass=0.65),
        Cylinder(on_rod(number, BOLT), bolt, radius=0.012, mass=0.05),
        material="tube",
    )


def draw_foot(robot: Drawing) -> None:
    """The piston of rod 1, and the foot, which hangs from it."""
    foot_ball = FOOT_BALLS[0]
    robot.body(
        "piston1",
        slide(1),
        Cylinder(on_rod(1, PISTON_TOP), foot_ball, radius=0.011, mass=0.149),
        Sphere(foot_ball, radius=0.018, mass=0.02),
        material="piston",
    )
    sole = Box((0.0, LEFT, -HEIGHT - 0.05), (0.32, 0.3, 0.016), mass=0.9)
    corners = (
        Cylinder((x, y, z - 0.042), (x, y, z - 0.01), radius=0.03, mass=0.132) for x, y, z in (FRONT, BACK, INSIDE)
    )
    robot.body("foot", ball("ball_foot1", "piston1", foot_ball), sole, *corners, material="foot", contacts=(sole,))


def draw_cut_piston(robot: Drawing, number: int) -> None:
    """The piston of another rod: its upper half slides in the tube, its lower half hangs on the foot."""
    cut, foot_ball = on_rod(number, CUT), FOOT_BALLS[number - 1]
    robot.body(
        f"piston{number}",
        slide(number),
        Cylinder(on_rod(number, PISTON_TOP), cut, radius=0.011, mass=0.082),
        material="piston",
    )
    robot.body(
        f"piston{number}_end",
        ball(f"ball_foot{number}", "foot", foot_ball),
        Cylinder(foot_ball, cut, radius=0.011, mass=0.067),
        Sphere(foot_ball, radius=0.018, mass=0.02),
        material="piston",
    )
    robot.close(f"rod{number}", "6d", f"piston{number}", f"piston{number}_end", cut)


def slide(number: int) -> Joint:
    """The prismatic joint of a rod, which makes it longer."""
    start, end = HIP_BALLS[number - 1], FOOT_BALLS[number - 1]
    along = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
    length = math.dist(start, end)
    return prismatic(f"motor_rod{number}", f"tube{number}", end, along, metres=REACH, drawn=length, motor=ACTUATOR)


def on_rod(number: int, distance: float) -> Vector3:
    """The point on a rod at a distance (m) from the ball of the hips."""
    start, end = HIP_BALLS[number - 1], FOOT_BALLS[number - 1]
    part = distance / math.dist(start, end)
    x, y, z = (a + part * (b - a) for a, b in zip(start, end, strict=True))
    return (x, y, z)


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
