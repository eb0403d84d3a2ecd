"""Draws the gripper Robotiq 2F-85. Run as ``python -m robots.robotiq_2f85.build [FOLDER]``.

World: origin and axes of the base as seen by the left finger, which is at positive y; the fingers point up; m, kg.
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
    Spring,
    Vector3,
    revolute,
    rotation_of_quaternion,
    solid_of,
    write,
)

# Joints of the left finger, as published, with the gripper open.
DRIVER = (0.0, 0.0306011, 0.054904)
COUPLER = (0.0, 0.0621011, 0.050804)
TIP = (0.0, 0.0682, 0.0984)  # where the coupler holds the follower
SPRING_LINK = (0.0, 0.0132, 0.0609)
FOLLOWER = (0.0, 0.0502, 0.1049)
PAD = (0.0, 0.0493, 0.11192)

FORWARD = (1.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)

#: The published tendon pulls half at each driver, with up to 5 N·m, against 0.1 N·m·s/rad and 0.005 kg·m² at each.
MOTOR = Motor(effort=5.0, velocity=1.5, damping=0.2, armature=0.01, name="fingers_actuator", control=(-5.0, 5.0))
SPRING = Spring(stiffness=0.05, rest=2.62, damping=0.00125)


def draw() -> Drawing:
    """The open gripper."""
    robot = Drawing(
        "robotiq_2f85",
        materials={
            "shell": (0.16, 0.17, 0.19, 1.0),
            "metal": (0.55, 0.57, 0.6, 1.0),
            "link": (0.3, 0.42, 0.55, 1.0),
            "pad": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": "Two-finger gripper 2F-85 of Robotiq, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of google-deepmind/mujoco_menagerie, robotiq_2f85/2f85.xml",
        },
    )
    flange = Cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 0.035), radius=0.037)
    housing = Box((0.0, 0.0, 0.0425), (0.046, 0.074, 0.02))
    cheeks = [Box((x, 0.0, 0.056), (0.008, 0.074, 0.028)) for x in (0.023, -0.023)]
    inertia = (0.000260285, 0.000225381, 0.000152708)
    base = published(0.777441, (0.0, 2.70394e-05, 0.0354675), inertia, (1.0, 0.00152849, 0.0, 0.0))
    robot.body(
        "base", None, flange, housing, *cheeks, material="shell", contacts=(flange, housing, *cheeks), solid=base
    )
    robot.body(
        "screw",
        revolute("motor", "base", (0.0, 0.0, 0.05), UP, degrees=(0.0, math.degrees(0.8)), motor=MOTOR),
        Cylinder((0.0, 0.0, 0.05), (0.0, 0.0, 0.08), radius=0.005, mass=0.01),
        material="metal",
    )
    draw_finger(robot)
    robot.close("left_tip", "3d", "left_coupler", "left_follower", TIP)
    robot.couple("left_gear", left_driver_joint=1.0, motor=-1.0)
    robot.frame("left_pad", "left_follower", (0.0, PAD[1] - 0.0066, PAD[2] + 0.01875))
    robot.mirror("left", "right")
    robot.frame("pinch", "base", (0.0, 0.0, 0.145))
    robot.configure("closed", **grip(0.77, 0.0))
    robot.configure("enveloping", **grip(0.5, -0.35))
    return robot


def draw_finger(robot: Drawing) -> None:
    """The left finger: the driver and the coupler push the follower, which a sprung link carries."""
    robot.body(
        "left_driver",
        revolute("left_driver_joint", "base", DRIVER, FORWARD, degrees=(0.0, math.degrees(0.8))),
        *bars(DRIVER, COUPLER, apart=0.006, radius=0.004),
        pin(DRIVER, 0.02),
        pin(COUPLER, 0.015),
        material="metal",
        solid=published(
            0.00899563,
            moved(DRIVER, (0.0, 0.0177547, 0.00107314)),
            (1.72352e-06, 1.60906e-06, 3.22006e-07),
            (0.681301, 0.732003, 0.0, 0.0),
        ),
    )
    robot.body(
        "left_coupler",
        revolute("left_coupler_joint", "left_driver", COUPLER, FORWARD, degrees=(math.degrees(-1.57), 0.0)),
        *bars(COUPLER, TIP, apart=0.012, radius=0.004),
        pin(TIP, 0.016),
        material="link",
        solid=published(
            0.0140974,
            moved(COUPLER, (0.0, 0.00301209, 0.0232175)),
            (4.16206e-06, 3.52216e-06, 8.88131e-07),
            (0.705636, -0.0455904, 0.0455904, 0.705636),
        ),
    )
    robot.body(
        "left_spring_link",
        revolute(
            "left_spring_link_joint",
            "base",
            SPRING_LINK,
            FORWARD,
            degrees=(math.degrees(-0.29670597283), math.degrees(0.8)),
            spring=SPRING,
        ),
        *bars(SPRING_LINK, FOLLOWER, apart=0.0165, radius=0.004),
        pin(SPRING_LINK, 0.0205),
        pin(FOLLOWER, 0.0205),
        material="shell",
        solid=published(
            0.0221642,
            moved(SPRING_LINK, (-8.65005e-09, 0.0181624, 0.0212658)),
            (8.96853e-06, 6.71733e-06, 2.63931e-06),
            (0.663403, -0.244737, 0.244737, 0.663403),
        ),
    )
    finger = Box((0.0, PAD[1] + 0.003, PAD[2] + 0.0135), (0.014, 0.006, 0.045))
    pad = Box((0.0, PAD[1] - 0.0033, PAD[2] + 0.01875), (0.022, 0.0066, 0.0375))
    end = published(
        0.0125222,
        moved(TIP, (0.0, -0.011046, 0.0124786)),
        (2.67415e-06, 2.4559e-06, 6.02031e-07),
        (1.0, 0.1664, 0.0, 0.0),
    )
    cushion = published(
        0.0035, moved(PAD, (0.0, -0.0025, 0.0185)), (4.73958e-07, 3.64583e-07, 1.23958e-07), (1.0, 0.0, 0.0, 1.0)
    )
    half = math.degrees(0.872664)
    robot.body(
        "left_follower",
        revolute("left_follower_joint", "left_spring_link", FOLLOWER, FORWARD, degrees=(-half, half)),
        Cylinder(FOLLOWER, TIP, radius=0.005),
        finger,
        pad,
        material="pad",
        contacts=(pad,),
        solid=solid_of([end, cushion]),
    )


def grip(driver: float, coupler: float) -> dict[str, float]:
    """Coordinates (rad) of all joints at given ones of the driver and the coupler."""
    elbow = turned(COUPLER, DRIVER, driver)
    tip = moved(elbow, turned(minus(TIP, COUPLER), (0.0, 0.0, 0.0), driver + coupler))
    arm, end = minus(FOLLOWER, SPRING_LINK), minus(FOLLOWER, TIP)
    # The follower's joint is where circles about the link's and about the tip meet, on the side where it is drawn.
    line = minus(tip, SPRING_LINK)
    span = math.hypot(*line)
    along = (math.hypot(*arm) ** 2 - math.hypot(*end) ** 2 + span**2) / (2.0 * span)
    link = direction(line) + math.acos(along / math.hypot(*arm)) - direction(arm)
    joint = moved(SPRING_LINK, turned(arm, (0.0, 0.0, 0.0), link))
    follower = math.remainder(direction(minus(joint, tip)) - direction(end) - link, math.tau)
    finger = {"driver": driver, "coupler": coupler, "spring_link": link, "follower": follower}
    pairs = {f"{side}_{name}_joint": angle for side in ("left", "right") for name, angle in finger.items()}
    return {"motor": driver, **pairs}


def published(mass: float, center: Vector3, moments: Vector3, quaternion: tuple[float, float, float, float]) -> Solid:
    """A solid of known mass (kg), centre of mass (m) and principal moments (kg·m²) along axes turned by w, x, y, z."""
    axes = rotation_of_quaternion(quaternion)
    return Solid(mass, center, axes @ np.diag(moments) @ axes.T)


def bars(start: Vector3, end: Vector3, apart: float, radius: float) -> list[Cylinder]:
    """Two bars side by side, each so far (m) from the middle of the finger."""
    return [Cylinder(moved(start, (x, 0.0, 0.0)), moved(end, (x, 0.0, 0.0)), radius) for x in (apart, -apart)]


def pin(at: Vector3, half: float) -> Cylinder:
    """A pin along x, with half its length in m."""
    return Cylinder(moved(at, (-half, 0.0, 0.0)), moved(at, (half, 0.0, 0.0)), 0.0055)


def moved(point: Vector3, by: Vector3) -> Vector3:
    """A point moved by a vector."""
    return (point[0] + by[0], point[1] + by[1], point[2] + by[2])


def minus(end: Vector3, start: Vector3) -> Vector3:
    """The vector from one point to another."""
    return (end[0] - start[0], end[1] - start[1], end[2] - start[2])


def turned(point: Vector3, about: Vector3, angle: float) -> Vector3:
    """A point turned about an axis along x through another."""
    x, y, z = minus(point, about)
    c, s = math.cos(angle), math.sin(angle)
    return moved(about, (x, c * y - s * z, s * y + c * z))


def direction(vector: Vector3) -> float:
    """Angle of a vector about x, rad: 0 along y."""
    return math.atan2(vector[2], vector[1])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
