"""Draws the left leg of Cassie. Run as ``python -m robots.cassie_leg.build [FOLDER]``.

World: origin at the pelvis frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, End, Motor, Spring, Vector3, midpoint, revolute, write

# Points of the published description, to 0.1 mm, in the pose with the knee at -68.7 degrees as in its keyframe,
# roll and yaw at zero, the springs at rest, the sole flat and its middle below the hip.
HIP_ROLL = (0.0210, 0.1350, 0.0000)
HIP_YAW = (-0.0490, 0.1350, 0.0000)
HIP_PITCH = (-0.0490, 0.1350, -0.0900)
KNEE = (0.0023, 0.1305, -0.1985)
KNEE_SPRING = (0.0206, 0.1305, -0.2992)
KNEE_SPRING_END = (-0.0886, 0.1305, -0.4260)
SHIN_TOP = (-0.0048, 0.1305, -0.2751)
HOCK = (-0.2888, 0.1305, -0.6049)
HEEL_SPRING = (-0.3207, 0.1296, -0.6138)
TOE_MOTOR = (-0.2799, 0.1078, -0.6716)
ANKLE = (-0.0690, 0.1305, -0.9510)
SOLE = (-0.0490, 0.1305, -0.9980)

# Centres of the balls at the ends of the two rods.
ACHILLES_THIGH = (-0.0490, 0.0900, -0.0900)
ACHILLES_TARSUS = (-0.3409, 0.1261, -0.4958)
PLANTAR_CRANK = (-0.3179, 0.1157, -0.7113)
PLANTAR_FOOT = (-0.1074, 0.1157, -0.9910)

FORWARD = (1.0, 0.0, 0.0)
UP = (0.0, 0.0, 1.0)
RIGHT = (0.0, -1.0, 0.0)
HEEL_AXIS = (-0.0580, -0.9970, -0.0517)

# As published: torques are gear ratio times the motor's own, velocities its speed without load over the gear ratio, and
# the rotor's inertia is the published armature over the square of the gear ratio.
ROLL_YAW_MOTOR = Motor(effort=112.5, velocity=12.15, damping=1.0, gear_ratio=25.0, rotor_inertia=6.1e-5)
LEG_MOTOR = Motor(effort=195.2, velocity=8.51, damping=1.0, gear_ratio=16.0, rotor_inertia=3.65e-4)
FOOT_MOTOR = Motor(effort=45.0, velocity=11.52, damping=1.0, gear_ratio=50.0, rotor_inertia=4.9e-6)

SHIN_SPRING = Spring(stiffness=1500.0, damping=0.1)
HEEL_LEAF = Spring(stiffness=1250.0)

MATERIALS = {
    "shell": (0.9, 0.5, 0.1, 1.0),
    "leg": (0.6, 0.62, 0.65, 1.0),
    "spring": (0.3, 0.6, 0.35, 1.0),
    "motor": (0.22, 0.22, 0.25, 1.0),
    "rod": (0.15, 0.4, 0.65, 1.0),
}
SOURCE = "Figures of Agility Robotics' MuJoCo description of Cassie, in MuJoCo Menagerie"


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = Drawing(
        "cassie_leg",
        materials=MATERIALS,
        metadata={
            "description": "Left leg of Agility Robotics' Cassie on a fixed pelvis, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": SOURCE,
        },
    )
    draw_pelvis(robot)
    draw_leg(robot)
    return robot


def draw_leg(robot: Drawing, side: str = "", ends: tuple[End, End] = ("ball", "ball")) -> None:
    """The left leg, from a body ``pelvis``; ``side`` begins the names of all that it has. The rods have these ends."""
    draw_hip(robot, side)
    draw_shank(robot, side)
    draw_foot(robot, side)
    draw_rods(robot, side, ends)


def draw_pelvis(robot: Drawing) -> None:
    """The pelvis with the motors of both legs, and its inertial measurement unit."""
    pelvis = Cylinder((-0.075, 0.0, 0.04), (0.185, 0.0, 0.04), radius=0.12, mass=7.33)
    roll_motors = [Cylinder((-0.015, y, 0.0), (0.095, y, 0.0), radius=0.06, mass=1.5) for y in (0.135, -0.135)]
    robot.body("pelvis", None, pelvis, *roll_motors, material="shell", contacts=(pelvis, *roll_motors))
    robot.frame("imu", "pelvis", (0.03155, 0.0, -0.07996))


def draw_hip(robot: Drawing, side: str) -> None:
    """The hip from roll through yaw to pitch, and the thigh."""
    robot.body(
        f"{side}hip",
        revolute(f"{side}motor_hip_x", "pelvis", HIP_ROLL, FORWARD, degrees=(-15.0, 22.5), motor=ROLL_YAW_MOTOR),
        Cylinder(HIP_YAW, HIP_ROLL, radius=0.05, mass=0.72),
        Cylinder((-0.049, 0.135, -0.02), (-0.049, 0.135, 0.07), radius=0.055, mass=1.1),
        material="motor",
    )
    robot.body(
        f"{side}hip_yoke",
        revolute(f"{side}motor_hip_z", f"{side}hip", HIP_YAW, UP, degrees=(-22.5, 22.5), motor=ROLL_YAW_MOTOR),
        Box((-0.049, 0.135, -0.05), (0.08, 0.07, 0.1), mass=1.171),
        material="leg",
    )
    pitch_motor = Cylinder(beside(HIP_PITCH, 0.121), beside(HIP_PITCH, 0.221), radius=0.06, mass=2.4)
    knee_motor = Cylinder(beside(KNEE, 0.121), beside(KNEE, 0.221), radius=0.06, mass=2.4)
    slope = math.atan2(KNEE[0] - HIP_PITCH[0], KNEE[2] - HIP_PITCH[2])
    housing = Box(beside(midpoint(HIP_PITCH, KNEE), 0.171), (0.1, 0.09, 0.12), mass=0.72, rpy=(0.0, slope, 0.0))
    robot.body(
        f"{side}thigh",
        revolute(
            f"{side}motor_hip_y",
            f"{side}hip_yoke",
            HIP_PITCH,
            RIGHT,
            degrees=(-50.0, 80.0),
            drawn=25.3,
            motor=LEG_MOTOR,
        ),
        *(pitch_motor, knee_motor, housing),
        material="shell",
        contacts=(pitch_motor, knee_motor, housing),
    )


def draw_shank(robot: Drawing, side: str) -> None:
    """The knee, the shin on its spring, and the tarsus with the leaf spring of the heel and the motor of the foot."""
    robot.body(
        f"{side}knee",
        revolute(
            f"{side}motor_knee", f"{side}thigh", KNEE, RIGHT, degrees=(-158.0, -37.0), drawn=-68.7, motor=LEG_MOTOR
        ),
        Cylinder(KNEE, KNEE_SPRING, radius=0.03, mass=0.758),
        Cylinder(KNEE_SPRING, KNEE_SPRING_END, radius=0.01, mass=0.186),
        material="spring",
    )
    bone = Cylinder(SHIN_TOP, HOCK, radius=0.027, mass=0.577)
    robot.body(
        f"{side}shin",
        revolute(f"{side}spring_shin", f"{side}knee", SHIN_TOP, RIGHT, degrees=(-20.0, 20.0), spring=SHIN_SPRING),
        bone,
        material="leg",
        contacts=(bone,),
    )
    bone = Cylinder(HEEL_SPRING, ANKLE, radius=0.018, mass=0.382)
    robot.body(
        f"{side}tarsus",
        revolute(f"{side}free_knee", f"{side}shin", HOCK, RIGHT, degrees=(50.0, 170.0), drawn=81.4),
        bone,
        Cylinder(beside(HOCK, 0.1), beside(HOCK, 0.161), radius=0.03, mass=0.1),
        Cylinder(beside(TOE_MOTOR, 0.1505), TOE_MOTOR, radius=0.03, mass=0.3),
        material="leg",
        contacts=(bone,),
    )
    robot.body(
        f"{side}heel_spring",
        revolute(
            f"{side}spring_heel", f"{side}tarsus", HEEL_SPRING, HEEL_AXIS, degrees=(-20.0, 20.0), spring=HEEL_LEAF
        ),
        Cylinder(HEEL_SPRING, ACHILLES_TARSUS, radius=0.01, mass=0.126),
        material="spring",
    )


def draw_foot(robot: Drawing, side: str) -> None:
    """The foot, which only pitches."""
    sole = Box(SOLE, (0.2, 0.04, 0.02), mass=0.1)
    robot.body(
        f"{side}foot",
        revolute(f"{side}free_ankle", f"{side}tarsus", ANKLE, RIGHT, degrees=(-140.0, -30.0), drawn=-88.0),
        sole,
        Cylinder(ANKLE, beside((-0.069, 0.0, -0.99), 0.1305), radius=0.012, mass=0.05),
        material="motor",
        contacts=(sole,),
    )
    robot.frame(f"{side}sole", f"{side}foot", (SOLE[0], SOLE[1], SOLE[2] - 0.01))


def draw_rods(robot: Drawing, side: str, ends: tuple[End, End]) -> None:
    """The achilles rod, and the crank that moves the foot through the plantar rod."""
    robot.rod(
        f"{side}achilles",
        (f"{side}thigh", ACHILLES_THIGH),
        (f"{side}heel_spring", ACHILLES_TARSUS),
        radius=0.007,
        mass=0.157,
        material="rod",
        ends=ends,
    )
    robot.body(
        f"{side}crank",
        revolute(
            f"{side}motor_ankle",
            f"{side}tarsus",
            TOE_MOTOR,
            RIGHT,
            degrees=(-134.0, -30.0),
            drawn=-81.8,
            motor=FOOT_MOTOR,
        ),
        Cylinder(beside(TOE_MOTOR, 0.1018), beside(TOE_MOTOR, 0.1138), radius=0.022, mass=0.096),
        Cylinder(TOE_MOTOR, PLANTAR_CRANK, radius=0.008, mass=0.03),
        material="rod",
    )
    robot.rod(
        f"{side}plantar",
        (f"{side}crank", PLANTAR_CRANK),
        (f"{side}foot", PLANTAR_FOOT),
        radius=0.007,
        mass=0.119,
        material="rod",
        ends=ends,
    )


def beside(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
