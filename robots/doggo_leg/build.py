"""Draws a leg of Stanford Doggo. Run as ``python -m robots.doggo_leg.build [FOLDER]``.

World: origin at the hip, x forward, y to the left, z up; m, kg. The leg hangs from a fixed side panel.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Sphere, Vector3, revolute, write

# Published lengths, of all upper links and of all lower links.
UPPER = 0.09
LOWER = 0.162

#: Distance from hip to foot as drawn: that at which the robot trots.
DRAWN = 0.17

#: The two motors are above the hip, one in front of the other: an estimate.
MOTORS = {"front": (0.05, 0.0, 0.06), "rear": (-0.05, 0.0, 0.06)}

# Planes: y, m. It is a leg on the right side: negative is away from the body.
PANEL_PLANE = 0.03
UPPER_PLANES = {"front": -0.012, "rear": 0.0}
LOWER_PLANES = {"front": -0.024, "rear": -0.036}

# Axes about which a link swings forward and backward.
FORWARD = (0.0, -1.0, 0.0)
BACKWARD = (0.0, 1.0, 0.0)
SIGNS = {"front": 1.0, "rear": -1.0}
BENDING = {"front": BACKWARD, "rear": FORWARD}

#: 4.75 N·m and a belt of 48 on 16 teeth are published; velocity and rotor inertia are estimates.
MOTOR = Motor(effort=4.75, velocity=60.0, gear_ratio=3.0, rotor_inertia=6.5e-5)


def separation(length: float) -> float:
    """Angle between an upper link and the line from hip to foot (rad), where these are so far apart (m)."""
    return math.acos((UPPER**2 + length**2 - LOWER**2) / (2.0 * UPPER * length))


def bend(length: float) -> float:
    """Angle of a knee (rad) where hip and foot are so far apart (m): 0 where the links are in line."""
    return separation(length) + math.asin(UPPER / LOWER * math.sin(separation(length)))


HIP = (0.0, 0.0, 0.0)
FOOT = (0.0, 0.0, -DRAWN)
KNEES = {
    side: (sign * UPPER * math.sin(separation(DRAWN)), 0.0, -UPPER * math.cos(separation(DRAWN)))
    for side, sign in SIGNS.items()
}


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = Drawing(
        "doggo_leg",
        materials={
            "panel": (0.25, 0.27, 0.3, 1.0),
            "front": (0.75, 0.2, 0.15, 1.0),
            "rear": (0.85, 0.55, 0.15, 1.0),
            "lower": (0.5, 0.53, 0.57, 1.0),
        },
        metadata={
            "description": "Leg of Stanford Doggo: a five-bar linkage on two coaxial shafts, each with a belt drive",
            "license": "BSD-3-Clause",
            "source": "Lengths of Nate711/Doggo; gear, torque and masses of Kau et al. (2019)",
        },
    )
    draw_panel(robot)
    for side in SIGNS:
        draw_links(robot, side)
    robot.hinge("ankle", "lower_rear", "lower_front", at_plane(FOOT, LOWER_PLANES["rear"]), FORWARD)
    robot.frame("foot", "lower_front", FOOT)
    robot.configure("retracted", **pose(0.08))
    robot.configure("extended", **pose(0.25))
    robot.configure("step", **pose(0.17, swing=0.4))
    robot.configure("upside_down", **pose(0.17, swing=math.pi))
    return robot


def draw_panel(robot: Drawing) -> None:
    """The side panel with both motors and the bearing of the shafts."""
    plate = Box((0.0, PANEL_PLANE, 0.03), (0.2, 0.003, 0.14), mass=0.13)
    motors = [
        Cylinder(at_plane(at, PANEL_PLANE), at_plane(at, 0.06), radius=0.0295, mass=0.21) for at in MOTORS.values()
    ]
    bearing = Cylinder(at_plane(HIP, PANEL_PLANE), at_plane(HIP, 0.012), radius=0.018, mass=0.03)
    robot.body("panel", None, plate, *motors, bearing, material="panel")


def draw_links(robot: Drawing, side: str) -> None:
    """The upper link on its shaft, with the large pulley, and the lower link. The foot is on the front one."""
    knee, upper, lower = KNEES[side], UPPER_PLANES[side], LOWER_PLANES[side]
    pulley = {"front": (0.054, 0.046), "rear": (0.044, 0.036)}[side]
    motor = replace(MOTOR, name=f"belt_{side}")
    robot.body(
        f"upper_{side}",
        # The real one turns without end, but only together with the other: a limit that the knees do not reach.
        revolute(f"motor_{side}", "panel", HIP, FORWARD, degrees=(-360.0, 360.0), motor=motor),
        Cylinder(at_plane(HIP, pulley[0]), at_plane(HIP, pulley[1]), radius=0.023, mass=0.02),
        Cylinder(at_plane(HIP, pulley[1]), at_plane(HIP, upper), radius=0.006, mass=0.02),
        bar(HIP, knee, upper, mass=0.03),
        pin(knee, upper, lower),
        material=side,
    )
    foot = (Sphere(at_plane(FOOT, lower), 0.012, mass=0.01),) if side == "front" else ()
    robot.body(
        f"lower_{side}",
        # Over the published range from hip to foot, 25 to 8 cm, a knee bends from 15.1 to 163.4 degrees.
        revolute(
            f"free_knee_{side}",
            f"upper_{side}",
            knee,
            BENDING[side],
            degrees=(14.0, 164.0),
            drawn=math.degrees(bend(DRAWN)),
        ),
        bar(knee, FOOT, lower, mass=0.045),
        *(pin(FOOT, LOWER_PLANES["front"], LOWER_PLANES["rear"]),) * (side == "rear"),
        *foot,
        material="lower",
        contacts=foot,
    )


def pose(length: float, swing: float = 0.0) -> dict[str, float]:
    """Coordinates of all joints with the foot so far from the hip (m), and the leg swung forward (rad)."""
    spread = separation(length) - separation(DRAWN)
    knee = bend(length) - bend(DRAWN)
    return {
        "motor_front": swing + spread,
        "motor_rear": swing - spread,
        "free_knee_front": knee,
        "free_knee_rear": knee,
    }


def bar(start: Vector3, end: Vector3, y: float, mass: float) -> Cylinder:
    """A link in the plane ``y`` (m)."""
    return Cylinder(at_plane(start, y), at_plane(end, y), radius=0.006, mass=mass)


def pin(at: Vector3, start: float, end: float) -> Cylinder:
    """A pin through two planes ``y`` (m)."""
    return Cylinder(at_plane(at, start), at_plane(at, end), radius=0.004, mass=0.005)


def at_plane(point: Vector3, y: float) -> Vector3:
    """The point moved into the plane ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
