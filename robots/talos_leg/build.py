"""Draws the left leg of Talos. Run as ``python -m robots.talos_leg.build [FOLDER]``.

The whole humanoid has legs drawn by the same functions; there, what moves has a prefix to its name.

World: origin at the base frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Literal

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, midpoint, revolute, write
from robots.builder.drawing import End

# Points of the published description, to 0.1 mm, in the pose with the hip pitched by -24 degrees, the knee by 50
# and the ankle by -26, so that the sole is flat. The three axes of the hip meet in one point.
HIP = (-0.0200, 0.0850, -0.2711)
KNEE = (0.1346, 0.0850, -0.6182)
ANKLE = (-0.0079, 0.0850, -0.9103)
SOLE = (-0.0079, 0.0850, -1.0073)

# The parallelogram that pitches the ankle, outside the shin: the motor, and the balls at the ends of the rod.
CRANK = (0.0915, 0.1785, -0.7310)
CRANK_BALL = (0.0198, 0.1785, -0.7104)
ANKLE_BALL = (-0.0796, 0.1785, -0.8897)

FORWARD = (1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
UP = (0.0, 0.0, 1.0)

#: How thigh and shin lean in the drawn pose, forward and backward: turned about y, rad.
THIGH_TURN, SHIN_TURN = math.radians(-24.0), math.radians(26.0)

# Efforts and velocities as published. The crank turns as the ankle does, so its motor has those of the ankle.
HIP_Z_MOTOR = Motor(effort=100.0, velocity=3.87)
HIP_X_MOTOR = Motor(effort=160.0, velocity=5.8)
HIP_Y_MOTOR = Motor(effort=160.0, velocity=5.8)
KNEE_MOTOR = Motor(effort=300.0, velocity=7.0)
ANKLE_PITCH_MOTOR = Motor(effort=160.0, velocity=5.8)
ANKLE_ROLL_MOTOR = Motor(effort=100.0, velocity=4.8)

MATERIALS = {
    "shell": (0.58, 0.62, 0.68, 1.0),
    "leg": (0.2, 0.21, 0.23, 1.0),
    "motor": (0.36, 0.38, 0.41, 1.0),
    "foot": (0.45, 0.47, 0.5, 1.0),
    "rod": (0.85, 0.5, 0.15, 1.0),
}


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = draw_pelvis("talos_leg", "Left leg of PAL Robotics' Talos on a fixed pelvis, drawn from primitive shapes")
    draw_leg(robot)
    return robot


def draw_pelvis(name: str, description: str, root: Literal["fixed", "floating"] = "fixed") -> Drawing:
    """A robot that is nothing but the pelvis yet, with the motors of hip yaw."""
    robot = Drawing(
        name,
        materials=MATERIALS,
        metadata={
            "description": description,
            "license": "BSD-3-Clause",
            "source": "Figures of PAL Robotics' URDF talos_full_v2.urdf",
        },
        root=root,
    )
    pelvis = Box((-0.07, 0.0, -0.05), (0.22, 0.34, 0.14), mass=11.363)
    motors = (Cylinder((-0.02, y, -0.19), (-0.02, y, -0.08), radius=0.055, mass=2.0) for y in (0.085, -0.085))
    robot.body("pelvis", None, pelvis, *motors, material="shell", contacts=(pelvis,))
    return robot


def draw_leg(robot: Drawing, prefix: str = "", ends: tuple[End, End] = ("ball", "ball")) -> None:
    """The left leg, from the hip to the foot.

    Args:
        robot: What it is drawn into: it has a pelvis.
        prefix: Of all names.
        ends: What the rod has at its ends, at the crank and at the ankle.
    """
    draw_hip(robot, prefix)
    draw_thigh(robot, prefix)
    draw_shin(robot, prefix)
    draw_foot(robot, prefix)
    draw_linkage(robot, prefix, ends)


def draw_hip(robot: Drawing, prefix: str) -> None:
    """The hip, from yaw to roll, with the motors of roll and pitch."""
    robot.body(
        f"{prefix}hip_z",
        revolute(f"{prefix}motor_hip_z", "pelvis", HIP, UP, degrees=(-20.0, 90.0), motor=HIP_Z_MOTOR),
        Cylinder((-0.02, 0.085, -0.215), (-0.02, 0.085, -0.175), radius=0.05, mass=0.75),
        Cylinder((-0.015, 0.085, -0.2711), (0.055, 0.085, -0.2711), radius=0.045, mass=1.0956),
        material="motor",
    )
    robot.body(
        f"{prefix}hip_x",
        revolute(f"{prefix}motor_hip_x", f"{prefix}hip_z", HIP, FORWARD, degrees=(-30.0, 30.0), motor=HIP_X_MOTOR),
        Cylinder((-0.027, 0.07, -0.2683), (-0.027, 0.152, -0.2683), radius=0.055, mass=1.491),
        material="leg",
    )


def draw_thigh(robot: Drawing, prefix: str) -> None:
    """The thigh, beside the joints of hip and knee, with the motor of the knee."""
    joint = revolute(
        f"{prefix}motor_hip_y",
        f"{prefix}hip_x",
        HIP,
        LEFT,
        degrees=(-120.0, 40.1),
        drawn=-24.0,
        motor=HIP_Y_MOTOR,
    )
    limb = Box(beside(midpoint(HIP, KNEE), 0.135), (0.13, 0.11, 0.34), mass=3.0, rpy=(0.0, THIGH_TURN, 0.0))
    robot.body(
        f"{prefix}thigh",
        joint,
        Cylinder(beside(HIP, 0.152), beside(HIP, 0.218), radius=0.06, mass=1.65),
        limb,
        Cylinder(beside(KNEE, 0.07), beside(KNEE, 0.19), radius=0.055, mass=1.59),
        material="leg",
        contacts=(limb,),
    )


def draw_shin(robot: Drawing, prefix: str) -> None:
    """The shin, with the motor of the crank."""
    joint = revolute(
        f"{prefix}motor_knee", f"{prefix}thigh", KNEE, LEFT, degrees=(0.0, 150.0), drawn=50.0, motor=KNEE_MOTOR
    )
    limb = Box((0.09, 0.1, -0.7346), (0.1, 0.09, 0.25), mass=1.67, rpy=(0.0, SHIN_TURN, 0.0))
    robot.body(
        f"{prefix}shin",
        joint,
        Cylinder(beside(KNEE, 0.045), beside(KNEE, 0.07), radius=0.05, mass=0.4),
        limb,
        Cylinder(beside(CRANK, 0.095), beside(CRANK, 0.168), radius=0.05, mass=1.3),
        Cylinder(between(KNEE, ANKLE, 0.7), ANKLE, radius=0.028, mass=0.2),
        material="leg",
        contacts=(limb,),
    )


def draw_foot(robot: Drawing, prefix: str) -> None:
    """The ankle, from pitch to roll, with the lever that the rod pulls, and the foot."""
    ankle = f"{prefix}ankle"
    robot.body(
        ankle,
        revolute(f"{prefix}free_ankle", f"{prefix}shin", ANKLE, LEFT, degrees=(-75.0, 44.0), drawn=-26.0),
        Cylinder(beside(ANKLE, 0.05), beside(ANKLE, 0.165), radius=0.03, mass=0.4),
        Box((-0.045, 0.135, -0.857), (0.06, 0.06, 0.085), mass=0.671),
        Cylinder(beside(ANKLE, 0.165), beside(ANKLE_BALL, 0.165), radius=0.014, mass=0.15),
        material="foot",
    )
    sole = Box(SOLE, (0.205, 0.122, 0.02), mass=0.608)
    joint = revolute(f"{prefix}motor_ankle", ankle, ANKLE, FORWARD, degrees=(-30.0, 30.0), motor=ANKLE_ROLL_MOTOR)
    robot.body(
        f"{prefix}foot",
        joint,
        sole,
        Box((-0.04, 0.085, -0.98), (0.1, 0.07, 0.04), mass=0.3),
        Cylinder((-0.1, 0.085, -0.9303), (-0.0079, 0.085, -0.9303), radius=0.035, mass=0.7),
        material="foot",
        contacts=(sole,),
    )


def draw_linkage(robot: Drawing, prefix: str, ends: tuple[End, End]) -> None:
    """The crank, and the rod from there to the ankle."""
    robot.body(
        f"{prefix}crank",
        revolute(
            f"{prefix}motor_shin",
            f"{prefix}shin",
            CRANK,
            LEFT,
            degrees=(-72.8, 39.0),
            drawn=-26.0,
            motor=ANKLE_PITCH_MOTOR,
        ),
        Cylinder(beside(CRANK, 0.1685), beside(CRANK, 0.1885), radius=0.025, mass=0.06),
        Cylinder(CRANK, CRANK_BALL, radius=0.012, mass=0.06),
        material="rod",
    )
    robot.rod(
        f"{prefix}rod",
        (f"{prefix}crank", CRANK_BALL),
        (f"{prefix}ankle", ANKLE_BALL),
        radius=0.009,
        mass=0.14,
        material="rod",
        ends=ends,
    )


def beside(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


def between(start: Vector3, end: Vector3, part: float) -> Vector3:
    """The point at that part of the line from one point to another."""
    x, y, z = (a + part * (b - a) for a, b in zip(start, end, strict=True))
    return (x, y, z)


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
