"""Draws the legs of Tello. Run as ``python -m robots.tello.build [FOLDER]``.

World: origin at the torso frame of the published description, x forward, y to the left, z up; m, kg. The legs are
straight, as in the published zero of hip, knee and ankle.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

from robots.builder import Box, Cylinder, Drawing, Motor, Solid, Sphere, Vector3, revolute, solid_of, write
from robots.tello.linkage import (
    ANKLE_CRANK,
    ANKLE_LEVER,
    ANKLE_PIVOT,
    CRANK,
    HALF_WIDTH,
    SHIN,
    ankle_crank,
    hip_cranks,
    turned,
)

# Joints of the left leg, as published.
CLAMP = (0.0, 0.126, -0.087)
HIP = (0.0, 0.126, -0.2295)
KNEE = (0.0, 0.126, -0.4563)
ANKLE = (0.0, 0.126, -0.4563 - SHIN)
SOLE = -0.041  # below the ankle, m
TOE, HEEL = 0.1, -0.05  # before the ankle, m

FORWARD = (1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
UP = (0.0, 0.0, 1.0)

#: Gear and inertia of the rotor are published; torque, velocity and damping are estimates.
MOTOR = Motor(effort=18.0, velocity=40.0, damping=0.05, gear_ratio=6.0, rotor_inertia=5.1512e-5)
ROTOR, ROTOR_ACROSS = 0.07, 2.5984e-5  # mass, kg; inertia across its axis, kg·m²


def draw() -> Drawing:
    """Both legs with every joint at zero."""
    robot = Drawing(
        "tello",
        materials={
            "shell": (0.2, 0.33, 0.55, 1.0),
            "leg": (0.6, 0.62, 0.65, 1.0),
            "motor": (0.22, 0.22, 0.25, 1.0),
            "crank": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": "Legs of the UIUC's humanoid Tello, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of ROAM-Lab-ND/generalized_rbda: Tello.hpp, tello_properties.xacro, derive_tello_*.m",
        },
        root="floating",
    )
    torso = Box((0.0, 0.0, 0.03), (0.14, 0.3, 0.16))
    robot.body(
        "torso",
        None,
        torso,
        *(Cylinder((0.0, y, -0.05), (0.0, y, 0.0), radius=0.048) for y in (CLAMP[1], -CLAMP[1])),
        material="shell",
        contacts=(torso,),
        solid=solid_of(
            [
                published(2.3008, (0.0073, -0.0013, -0.0023), (0.0366, 0.0142, 0.0291), xz=-0.0006, yz=-0.0002),
                *(rotor((0.0, y, -0.026), UP) for y in (CLAMP[1], -CLAMP[1])),
            ]
        ),
    )
    draw_hip(robot)
    draw_shank(robot)
    for name, x in (("toe", TOE), ("heel", HEEL)):
        robot.frame(f"left_{name}", "left_foot", (x, ANKLE[1], ANKLE[2] + SOLE))
    robot.mirror("left", "right")
    robot.configure("bent", **pose(hip_y=-0.5, knee=1.0, ankle=-0.5))
    robot.configure("wide", **pose(hip_x=0.2, hip_y=-0.3, knee=0.6, ankle=-0.3))
    return robot


def draw_hip(robot: Drawing) -> None:
    """The hip: a clamp that yaws and carries two motors, whose rods roll and pitch the thigh on a gimbal."""
    body = Cylinder(beside(CLAMP, -0.06), beside(CLAMP, 0.06), radius=0.045)
    fork = [Box((x, CLAMP[1], -0.165), (0.012, 0.05, 0.15)) for x in (0.055, -0.055)]
    bridge = Box((0.0, CLAMP[1], -0.087), (0.122, 0.05, 0.05))
    clamp = published(1.3289, moved(CLAMP, (-0.001, 0.0, -0.0069)), (0.0032, 0.0033, 0.0027), xz=0.0001)
    robot.body(
        "left_hip",
        revolute("left_motor_hip_z", "torso", CLAMP, UP, degrees=(-40.0, 40.0), motor=MOTOR),
        Cylinder((0.0, CLAMP[1], -0.087), (0.0, CLAMP[1], -0.05), radius=0.035),
        body,
        bridge,
        *fork,
        material="motor",
        solid=solid_of([clamp, *(rotor(beside(CLAMP, y), LEFT) for y in (0.04, -0.04))]),
    )
    drawn = hip_cranks(0.0, 0.0)[0]
    tips = []
    for number, side in ((1, 1.0), (2, -1.0)):
        axle = beside(CLAMP, side * HALF_WIDTH)
        tips.append(moved(axle, turned((-CRANK, 0.0, 0.0), drawn)))
        robot.body(
            f"left_hip_crank_{number}",
            revolute(
                f"left_motor_hip_{number}",
                "left_hip",
                axle,
                LEFT,
                degrees=(-50.0, 60.0),
                drawn=round(math.degrees(drawn), 1),
                motor=MOTOR,
            ),
            Cylinder(beside(axle, -0.008), beside(axle, 0.008), radius=0.016, mass=0.02),
            Cylinder(axle, tips[-1], radius=0.007, mass=0.03),
            Sphere(tips[-1], radius=0.011, mass=0.01),
            material="crank",
        )
    cross = Cylinder(moved(HIP, (-0.064, 0.0, 0.0)), moved(HIP, (0.064, 0.0, 0.0)), radius=0.014)
    robot.body(
        "left_gimbal",
        revolute("left_free_hip_x", "left_hip", HIP, FORWARD, degrees=(-25.0, 25.0)),
        cross,
        material="leg",
        solid=published(0.4433, moved(HIP, (-0.0027, 0.0, 0.0258)), (0.0018, 0.0017, 0.0015)),
    )
    motors = [Cylinder(beside(HIP, y), beside(HIP, math.copysign(0.058, y)), radius=0.044) for y in (0.016, -0.016)]
    corners = [moved(HIP, (-CRANK, side * HALF_WIDTH, 0.0)) for side in (1.0, -1.0)]
    arms = [Cylinder(beside(HIP, math.copysign(0.058, tip[1] - HIP[1])), tip, radius=0.009) for tip in corners]
    bone = Box((0.0, HIP[1], -0.335), (0.05, 0.04, 0.17))
    fork = [Box((0.0, HIP[1] + y, -0.435), (0.045, 0.008, 0.09)) for y in (0.03, -0.03)]
    collar = Box((0.0, HIP[1], -0.398), (0.045, 0.068, 0.02))
    thigh = published(1.5424, moved(HIP, (0.003, -0.0001, -0.0323)), (0.0103, 0.0097, 0.0027), xz=-0.0005)
    robot.body(
        "left_thigh",
        revolute("left_free_hip_y", "left_gimbal", HIP, LEFT, degrees=(-60.0, 35.0)),
        *motors,
        *arms,
        *(Sphere(corner, 0.012) for corner in corners),
        bone,
        collar,
        *fork,
        material="shell",
        contacts=(bone,),
        solid=solid_of([thigh, *(rotor(beside(HIP, y), LEFT) for y in (0.02655, -0.02655))]),
    )
    for number, tip in enumerate(tips, start=1):
        rod = f"left_hip_rod_{number}"
        robot.distance(rod, (f"left_hip_crank_{number}", tip), ("left_thigh", corners[number - 1]))


def draw_shank(robot: Drawing) -> None:
    """The shin and the foot. Two motors in the thigh move both: their sum the knee, their difference a crank."""
    for number, y in ((1, 0.063), (2, -0.063)):
        robot.body(
            f"left_pulley_{number}",
            revolute(f"left_motor_knee_{number}", "left_thigh", HIP, LEFT, degrees=(-40.0, 160.0), motor=MOTOR),
            Cylinder(beside(HIP, y - 0.004), beside(HIP, y + 0.004), radius=0.03, mass=0.03),
            material="crank",
        )
    bone = Box((-0.004, KNEE[1], -0.6), (0.028, 0.03, 0.2))
    robot.body(
        "left_shin",
        revolute("left_free_knee", "left_thigh", KNEE, LEFT, degrees=(-5.0, 125.0)),
        Cylinder(beside(KNEE, -0.037), beside(KNEE, 0.037), radius=0.02),
        Box((-0.006, KNEE[1], -0.4785), (0.03, 0.03, 0.06)),
        bone,
        Cylinder(beside(ANKLE, -0.015), beside(ANKLE, 0.015), radius=0.014),
        material="leg",
        contacts=(bone,),
        solid=published(0.3072, moved(KNEE, (0.0047, -0.0003, -0.1043)), (0.0054, 0.0054, 0.0001), xz=-0.0002),
    )
    pivot = moved(ANKLE, ANKLE_PIVOT)
    drawn = ankle_crank(0.0)
    tip = moved(pivot, turned(ANKLE_CRANK, drawn))
    lever = moved(ANKLE, ANKLE_LEVER)
    robot.body(
        "left_ankle_crank",
        revolute(
            "left_free_crank", "left_shin", pivot, LEFT, degrees=(-50.0, 40.0), drawn=round(math.degrees(drawn), 1)
        ),
        Cylinder(beside(pivot, 0.022), beside(pivot, -0.022), radius=0.01, mass=0.02),
        Cylinder(pivot, tip, radius=0.006, mass=0.015),
        Sphere(tip, radius=0.009, mass=0.01),
        material="crank",
    )
    sole = Box((0.5 * (TOE + HEEL), ANKLE[1], ANKLE[2] + SOLE + 0.006), (TOE - HEEL, 0.045, 0.012))
    robot.body(
        "left_foot",
        revolute("left_free_ankle", "left_shin", ANKLE, LEFT, degrees=(-50.0, 35.0)),
        sole,
        *(Cylinder(beside(ANKLE, y), (0.0, ANKLE[1] + y, ANKLE[2] - 0.032), radius=0.008) for y in (0.021, -0.021)),
        Cylinder(beside(ANKLE, -0.028), beside(ANKLE, 0.028), radius=0.008),
        Cylinder(moved(ANKLE, (0.0, 0.0, -0.03)), lever, radius=0.008),
        Sphere(lever, radius=0.01),
        material="motor",
        contacts=(sole,),
        solid=published(0.1025, moved(ANKLE, (0.0042, 0.0, -0.0251)), (9.4e-5, 1.773e-4, 9.01e-5), xz=-3.8e-6),
    )
    robot.couple("left_knee_sum", left_free_knee=2.0, left_motor_knee_1=-1.0, left_motor_knee_2=-1.0)
    robot.couple("left_knee_difference", left_free_crank=2.0, left_motor_knee_1=1.0, left_motor_knee_2=-1.0)
    robot.distance("left_ankle_rod", ("left_ankle_crank", tip), ("left_foot", lever))


def pose(hip_x: float = 0.0, hip_y: float = 0.0, knee: float = 0.0, ankle: float = 0.0) -> dict[str, float]:
    """Coordinates (rad) of all joints of both legs at given angles of roll, pitch, knee and ankle."""
    drawn = hip_cranks(0.0, 0.0)[0]
    first, second = hip_cranks(hip_x, hip_y)
    crank = ankle_crank(ankle) - ankle_crank(0.0)
    leg = {
        "motor_hip_1": first - drawn,
        "motor_hip_2": second - drawn,
        "free_hip_x": hip_x,
        "free_hip_y": hip_y,
        "motor_knee_1": knee - crank,
        "motor_knee_2": knee + crank,
        "free_knee": knee,
        "free_crank": crank,
        "free_ankle": ankle,
    }
    return {f"{side}_{joint}": angle for side in ("left", "right") for joint, angle in leg.items()}


def published(mass: float, center: Vector3, moments: Vector3, *, xz: float = 0.0, yz: float = 0.0) -> Solid:
    """A solid of known mass (kg), centre of mass in the world (m) and inertia about it (kg·m²)."""
    inertia = np.diag(moments)
    inertia[0, 2] = inertia[2, 0] = xz
    inertia[1, 2] = inertia[2, 1] = yz
    return Solid(mass, center, inertia)


def rotor(at: Vector3, axis: Vector3) -> Solid:
    """A rotor as part of the body that carries it. Its spin is left to the gear ratio and the rotor inertia."""
    along = np.outer(axis, axis)
    return Solid(ROTOR, at, ROTOR_ACROSS * (np.eye(3) - along) + MOTOR.rotor_inertia * along)


def moved(point: Vector3, by: Vector3) -> Vector3:
    """A point moved by a vector."""
    return (point[0] + by[0], point[1] + by[1], point[2] + by[2])


def beside(point: Vector3, y: float) -> Vector3:
    """A point moved to the left, m."""
    return moved(point, (0.0, y, 0.0))


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
