"""Draws the left leg of Digit. Run as ``python -m robots.digit_leg.build [FOLDER]``.

The other robots with legs of Digit are drawn by the same functions; there, what moves has a prefix to its name.

World: origin at the base frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Literal

from robots.builder import Box, Cylinder, Drawing, End, Motor, Spring, Vector3, midpoint, revolute, write

# Points of the published description, to 0.1 mm, in the pose with the knee at 0.3 rad, the springs at rest, the
# yaw axis upright, the sole flat and the middle of the foot below the hip.
HIP_ROLL = (-0.0010, 0.0910, 0.0000)
HIP_YAW = (-0.0450, 0.0910, -0.0505)
HIP_PITCH = (-0.0450, 0.0950, -0.1185)
KNEE = (0.0127, 0.0905, -0.2237)
SHIN_TOP = (0.0046, 0.0905, -0.3003)
HOCK = (-0.2832, 0.0905, -0.6267)
HEEL = (-0.3170, 0.0895, -0.6328)
TOE_MOTOR_1 = (-0.2700, 0.1181, -0.6935)
TOE_MOTOR_2 = (-0.2358, 0.0629, -0.7326)
ANKLE = (-0.0450, 0.0905, -0.9603)
SOLE = (-0.0452, 0.0905, -1.0109)

# Centres of the balls at the ends of the three rods.
ACHILLES_THIGH = (-0.0450, 0.0490, -0.1185)
ACHILLES_TARSUS = (-0.3398, 0.0845, -0.5208)
ROD_1_CRANK = (-0.3073, 0.1101, -0.7366)
ROD_1_FOOT = (-0.0871, 0.1084, -0.9956)
ROD_2_CRANK = (-0.2731, 0.0709, -0.7758)
ROD_2_FOOT = (-0.0871, 0.0724, -0.9956)

BACK = (-1.0, 0.0, 0.0)
DOWN = (0.0, 0.0, -1.0)
LEFT = (0.0, 1.0, 0.0)
RIGHT = (0.0, -1.0, 0.0)
#: The roll axis of the foot rises forward, 30 degrees from the sole.
TOE_ROLL_AXIS = (math.cos(math.radians(30.0)), 0.0, 0.5)

#: Axis of the spring at the heel, of which the achilles rod pulls.
HEEL_AXIS = (-0.0550, -0.9969, -0.0555)

# Efforts, velocities, damping and friction as published.
ROLL_MOTOR = Motor(effort=113.0, velocity=4.58, damping=1.0, friction=1.0)
YAW_MOTOR = Motor(effort=79.2, velocity=7.33, damping=1.0, friction=1.0)
PITCH_MOTOR = Motor(effort=216.9, velocity=8.51, damping=1.0, friction=0.5)
KNEE_MOTOR = Motor(effort=231.3, velocity=8.51, damping=1.0, friction=0.5)
TOE_MOTOR = Motor(effort=42.0, velocity=11.52, damping=1.0, friction=1.0)

#: The leaf springs.
SHIN_SPRING = Spring(stiffness=6000.0)
HEEL_SPRING = Spring(stiffness=4375.0)


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = draw_torso("digit_leg", "Left leg of Agility Robotics' Digit on a fixed torso, drawn from primitive shapes")
    draw_leg(robot)
    return robot


def draw_torso(name: str, description: str, root: Literal["fixed", "floating"] = "fixed") -> Drawing:
    """A robot that is nothing but the torso yet."""
    robot = Drawing(
        name,
        materials={
            "shell": (0.58, 0.62, 0.68, 1.0),
            "leg": (0.2, 0.45, 0.55, 1.0),
            "motor": (0.25, 0.26, 0.3, 1.0),
            "rod": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": description,
            "license": "BSD-3-Clause",
            "source": "Figures of Agility Robotics' MuJoCo description digit-v3.xml",
        },
        root=root,
    )
    torso = Box((0.008, 0.0, 0.21), (0.195, 0.174, 0.49), mass=15.028)
    robot.body("torso", None, torso, material="shell", contacts=(torso,))
    return robot


def draw_leg(robot: Drawing, prefix: str = "", ends: tuple[End, End] = ("ball", "ball"), springs: bool = False) -> None:
    """The left leg, from the hip to the foot.

    Args:
        robot: What it is drawn into: it has a torso.
        prefix: Of all names.
        ends: What the three rods have at their ends: at the thigh or the crank, and at the tarsus or the foot.
        springs: Whether the leaf springs at the shin and at the heel can bend.
    """
    draw_hip(robot, prefix)
    draw_shank(robot, prefix, springs)
    draw_foot(robot, prefix)
    draw_rods(robot, prefix, ends, f"{prefix}heel" if springs else f"{prefix}tarsus")


def draw_hip(robot: Drawing, prefix: str) -> None:
    """The hip from roll through yaw to pitch, and the thigh."""
    hip, yoke = f"{prefix}hip", f"{prefix}hip_yoke"
    robot.body(
        hip,
        revolute(f"{prefix}motor_hip_x", "torso", HIP_ROLL, BACK, degrees=(-60.0, 60.0), drawn=21.5, motor=ROLL_MOTOR),
        Cylinder((-0.045, 0.091, -0.04), (-0.045, 0.091, 0.04), radius=0.045, mass=0.665),
        Cylinder((-0.045, 0.091, 0.0), HIP_ROLL, radius=0.04, mass=0.25),
        material="motor",
    )
    robot.body(
        yoke,
        revolute(f"{prefix}motor_hip_z", hip, HIP_YAW, DOWN, degrees=(-40.0, 40.0), motor=YAW_MOTOR),
        Box((-0.045, 0.089, -0.0925), (0.09, 0.06, 0.14), mass=0.819),
        material="leg",
    )
    pitch_motor = Cylinder(beside(HIP_PITCH, 0.0615), beside(HIP_PITCH, 0.2055), radius=0.05, mass=2.8)
    knee_motor = Cylinder(beside(KNEE, 0.0615), beside(KNEE, 0.2055), radius=0.05, mass=2.8)
    slope = math.atan2(KNEE[0] - HIP_PITCH[0], KNEE[2] - HIP_PITCH[2])
    housing = Box(beside(midpoint(HIP_PITCH, KNEE), 0.1335), (0.08, 0.13, 0.12), mass=0.644, rpy=(0.0, slope, 0.0))
    robot.body(
        f"{prefix}thigh",
        revolute(f"{prefix}motor_hip_y", yoke, HIP_PITCH, LEFT, degrees=(-60.0, 90.0), drawn=16.2, motor=PITCH_MOTOR),
        *(pitch_motor, knee_motor, housing),
        material="motor",
        contacts=(pitch_motor, knee_motor, housing),
    )


def draw_shank(robot: Drawing, prefix: str, springs: bool) -> None:
    """The shin, with the spring at its top at rest, and the tarsus, with the two motors of the foot."""
    thigh, knee, shin, tarsus = f"{prefix}thigh", f"{prefix}knee", f"{prefix}shin", f"{prefix}tarsus"
    turn = revolute(f"{prefix}motor_knee", thigh, KNEE, RIGHT, degrees=(-71.0, 49.0), drawn=17.2, motor=KNEE_MOTOR)
    top = Cylinder(KNEE, (0.0100, 0.0905, -0.3480), radius=0.035, mass=1.227)
    tube = Cylinder(SHIN_TOP, HOCK, radius=0.03, mass=0.896)
    lever = Cylinder(HEEL if springs else HOCK, ACHILLES_TARSUS, radius=0.012, mass=0.23)
    if springs:
        robot.body(knee, turn, top, material="leg")
        bend = revolute(f"{prefix}spring_shin", knee, SHIN_TOP, RIGHT, degrees=(-6.0, 6.0), spring=SHIN_SPRING)
        robot.body(shin, bend, tube, material="leg", contacts=(tube,))
    else:
        robot.body(shin, turn, top, tube, material="leg", contacts=(tube,))
    robot.body(
        tarsus,
        revolute(f"{prefix}free_knee", shin, HOCK, RIGHT, degrees=(-50.3, 71.6), drawn=-17.8),
        Cylinder(HOCK, ANKLE, radius=0.016, mass=0.553 if springs else 0.603),
        *((Cylinder(HOCK, HEEL, radius=0.012, mass=0.05),) if springs else (lever,)),
        Cylinder(beside(TOE_MOTOR_1, 0.0905), TOE_MOTOR_1, radius=0.028, mass=0.36),
        Cylinder(beside(TOE_MOTOR_2, 0.0905), TOE_MOTOR_2, radius=0.028, mass=0.36),
        material="leg",
    )
    if springs:
        bend = revolute(f"{prefix}spring_heel", tarsus, HEEL, HEEL_AXIS, degrees=(-6.0, 6.0), spring=HEEL_SPRING)
        robot.body(f"{prefix}heel", bend, lever, material="rod")


def draw_foot(robot: Drawing, prefix: str) -> None:
    """The ankle's cross, from pitch to roll, and the foot."""
    robot.body(
        f"{prefix}ankle",
        revolute(f"{prefix}free_foot1", f"{prefix}tarsus", ANKLE, RIGHT, degrees=(-44.0, 34.0), drawn=7.1),
        Cylinder(beside(ANKLE, 0.0705), beside(ANKLE, 0.1105), radius=0.012, mass=0.044),
        material="motor",
    )
    sole = Box(SOLE, (0.235, 0.08, 0.023), mass=0.431)
    robot.body(
        f"{prefix}foot",
        revolute(f"{prefix}free_foot2", f"{prefix}ankle", ANKLE, TOE_ROLL_AXIS, degrees=(-37.0, 33.0)),
        sole,
        Cylinder(SOLE, ANKLE, radius=0.015, mass=0.1),
        material="leg",
        contacts=(sole,),
    )


def draw_rods(robot: Drawing, prefix: str, ends: tuple[End, End], heel: str) -> None:
    """The achilles rod, from the thigh to the heel, and the two cranks that move the foot through a rod each."""
    robot.rod(
        f"{prefix}achilles",
        (f"{prefix}thigh", ACHILLES_THIGH),
        (heel, ACHILLES_TARSUS),
        radius=0.007,
        mass=0.178,
        material="rod",
        ends=ends,
    )
    for number, at, axis, degrees, drawn, crank_ball, foot_ball, mass in (
        (1, TOE_MOTOR_1, LEFT, (-46.3, 45.0), -7.0, ROD_1_CRANK, ROD_1_FOOT, 0.091),
        (2, TOE_MOTOR_2, RIGHT, (-45.9, 45.5), 7.0, ROD_2_CRANK, ROD_2_FOOT, 0.080),
    ):
        crank, motor = f"{prefix}crank{number}", f"{prefix}motor_shin{number}"
        robot.body(
            crank,
            revolute(motor, f"{prefix}tarsus", at, axis, degrees=degrees, drawn=drawn, motor=TOE_MOTOR),
            Cylinder(beside(at, at[1] - 0.006), beside(at, at[1] + 0.006), radius=0.028, mass=0.11),
            Cylinder(at, crank_ball, radius=0.008, mass=0.03),
            material="rod",
        )
        robot.rod(
            f"{prefix}rod{number}",
            (crank, crank_ball),
            (f"{prefix}foot", foot_ball),
            radius=0.007,
            mass=mass,
            material="rod",
            ends=ends,
        )


def beside(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
