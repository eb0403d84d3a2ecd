"""Draws Battobot on its two legs. Run as ``python -m robots.battobot.build [FOLDER]``.

World: origin at the base frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, revolute, write

# Points of the published description, to 0.1 mm, in the pose in which it was exported, with the sole brought level and
# the cranks turned until the loops close.
HIP_YAW = (0.0000, 0.1250, -0.0512)
HIP_ROLL = (-0.0480, 0.1250, -0.1898)
HIP_PITCH = (0.0295, 0.1350, -0.1898)
KNEE = (0.1028, 0.1415, -0.3431)
ANKLE_PITCH = (0.0200, 0.1250, -0.5790)
ANKLE_ROLL = (0.0363, 0.1250, -0.5992)

# The motor of the knee shares the axis of hip pitch; its rod pulls a lever of the shin.
KNEE_MOTOR = (0.0295, 0.0840, -0.1898)
KNEE_ROD_CRANK = (0.0538, 0.1220, -0.1461)
KNEE_ROD_SHIN = (0.1604, 0.1115, -0.2998)

# The two motors of the ankle sit one below the other in the shin, the upper one outside.
ANKLE_MOTOR_1 = (0.0859, 0.1425, -0.3913)
ANKLE_MOTOR_2 = (0.0591, 0.1075, -0.4676)
ROD_1_CRANK = (0.0563, 0.1665, -0.3863)
ROD_1_FOOT = (-0.0475, 0.1610, -0.6082)
ROD_2_CRANK = (0.0296, 0.0835, -0.4624)
ROD_2_FOOT = (-0.0475, 0.0890, -0.6082)

FORWARD = (1.0, 0.0, 0.0)
BACK = (-1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
UP = (0.0, 0.0, 1.0)

# The three drives, by name: the peak torque is in the name, the velocity is the rated one.
X12_150 = Motor(effort=150.0, velocity=10.5)
X8_90 = Motor(effort=90.0, velocity=13.6)
X6_8 = Motor(effort=8.0, velocity=32.5)


def draw() -> Drawing:
    """The robot with every joint at zero."""
    robot = Drawing(
        "battobot",
        materials={
            "shell": (0.93, 0.86, 0.62, 1.0),
            "leg": (0.62, 0.78, 0.88, 1.0),
            "motor": (0.25, 0.26, 0.3, 1.0),
            "rod": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": "Battobot, a biped with knees and ankles moved through rods, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of the URDF battobot_6d in Gepetto/example-parallel-robots",
        },
        root="floating",
    )
    draw_torso(robot)
    draw_hip(robot)
    draw_thigh(robot)
    draw_shin(robot)
    draw_foot(robot)
    draw_knee_linkage(robot)
    draw_ankle_linkages(robot)
    robot.mirror("left", "right")
    return robot


def draw_torso(robot: Drawing) -> None:
    """The torso, with the motors of hip yaw and the ballast."""
    trunk = Box((0.0, 0.0, 0.152), (0.14, 0.18, 0.2), mass=4.763)
    motors = (Cylinder((0.0, y, -0.0512), (0.0, y, 0.01), radius=0.05, mass=1.4) for y in (0.125, -0.125))
    robot.body(
        "torso",
        None,
        trunk,
        Box((0.0, 0.0, 0.0275), (0.1, 0.25, 0.055), mass=0.6),
        *motors,
        material="shell",
        contacts=(trunk,),
    )


def draw_hip(robot: Drawing) -> None:
    """The hip, from yaw to roll, with the motors of roll and pitch."""
    robot.body(
        "left_hip_z",
        revolute("left_motor_hip_z", "torso", HIP_YAW, UP, degrees=(-40.0, 40.0), motor=X8_90),
        Box((-0.05, 0.125, -0.0557), (0.14, 0.07, 0.015), mass=0.15),
        Box((-0.118, 0.125, -0.12), (0.012, 0.07, 0.13), mass=0.15),
        Cylinder((-0.12, 0.125, -0.1898), (-0.06, 0.125, -0.1898), radius=0.05, mass=2.341),
        material="leg",
    )
    robot.body(
        "left_hip_x",
        revolute("left_motor_hip_x", "left_hip_z", HIP_ROLL, BACK, degrees=(-30.0, 30.0), motor=X8_90),
        Box((-0.025, 0.16, -0.1898), (0.07, 0.06, 0.07), mass=0.35),
        Cylinder((0.0295, 0.16, -0.1898), (0.0295, 0.212, -0.1898), radius=0.06, mass=1.901),
        material="motor",
    )


def draw_thigh(robot: Drawing) -> None:
    """The thigh, with the motor of the knee inside the hip."""
    limb = Cylinder(beside(HIP_PITCH, 0.135), beside(KNEE, 0.135), radius=0.022, mass=0.36)
    robot.body(
        "left_thigh",
        revolute("left_motor_hip_y", "left_hip_x", HIP_PITCH, LEFT, degrees=(-110.0, 20.0), drawn=-25.6, motor=X12_150),
        Cylinder(beside(KNEE_MOTOR, 0.03), beside(KNEE_MOTOR, 0.084), radius=0.05, mass=1.1995),
        Cylinder(beside(HIP_PITCH, 0.084), beside(HIP_PITCH, 0.16), radius=0.025, mass=0.1),
        limb,
        material="leg",
        contacts=(limb,),
    )


def draw_shin(robot: Drawing) -> None:
    """The shin, with the lever that the knee's rod pulls, and the motors of the ankle."""
    limb = Cylinder(beside(KNEE, 0.125), ANKLE_PITCH, radius=0.02, mass=0.45)
    robot.body(
        "left_shin",
        revolute("left_free_knee", "left_thigh", KNEE, LEFT, degrees=(27.0, 109.8), drawn=44.9),
        Cylinder(beside(KNEE, 0.1015), beside(KNEE, 0.16), radius=0.022, mass=0.1),
        Cylinder(beside(KNEE, 0.1115), KNEE_ROD_SHIN, radius=0.01, mass=0.08),
        limb,
        Cylinder(beside(ANKLE_MOTOR_1, 0.0975), ANKLE_MOTOR_1, radius=0.037, mass=0.41),
        Cylinder(beside(ANKLE_MOTOR_2, 0.1525), ANKLE_MOTOR_2, radius=0.037, mass=0.4103),
        material="leg",
        contacts=(limb,),
    )


def draw_foot(robot: Drawing) -> None:
    """The ankle's cross, from pitch to roll, and the foot."""
    robot.body(
        "left_ankle",
        revolute("left_free_ankle_y", "left_shin", ANKLE_PITCH, LEFT, degrees=(-20.0, 25.0)),
        Cylinder(beside(ANKLE_PITCH, 0.1), beside(ANKLE_PITCH, 0.15), radius=0.008, mass=0.04),
        Cylinder(ANKLE_PITCH, (0.02, 0.125, -0.5992), radius=0.009, mass=0.03),
        material="motor",
    )
    sole = Box((0.005, 0.125, -0.616), (0.14, 0.09, 0.012), mass=0.2)
    robot.body(
        "left_foot",
        revolute("left_free_ankle_x", "left_ankle", ANKLE_ROLL, FORWARD, degrees=(-15.0, 15.0)),
        sole,
        Cylinder((0.0, 0.125, -0.5992), (0.04, 0.125, -0.5992), radius=0.011, mass=0.0633),
        Cylinder(ROD_1_FOOT, ROD_2_FOOT, radius=0.006, mass=0.04),
        material="leg",
        contacts=(sole,),
    )


def draw_knee_linkage(robot: Drawing) -> None:
    """The crank on the motor of the knee, and the rod from there to the shin."""
    robot.body(
        "left_knee_crank",
        revolute("left_motor_knee", "left_thigh", KNEE_MOTOR, LEFT, degrees=(-34.0, 91.0), motor=X8_90),
        Cylinder(beside(KNEE_MOTOR, 0.084), beside(KNEE_MOTOR, 0.104), radius=0.04, mass=0.085),
        Cylinder(beside(KNEE_MOTOR, 0.104), KNEE_ROD_CRANK, radius=0.01, mass=0.05),
        material="rod",
    )
    robot.rod(
        "left_knee_rod",
        ("left_knee_crank", KNEE_ROD_CRANK),
        ("left_shin", KNEE_ROD_SHIN),
        radius=0.007,
        mass=0.0996,
        material="rod",
        ends=("ball", "universal"),
    )


def draw_ankle_linkages(robot: Drawing) -> None:
    """The cranks on the two motors of the ankle, and a rod from each to the foot."""
    for number, motor, crank_end, foot_end, mass in (
        (1, ANKLE_MOTOR_1, ROD_1_CRANK, ROD_1_FOOT, 0.0519),
        (2, ANKLE_MOTOR_2, ROD_2_CRANK, ROD_2_FOOT, 0.0349),
    ):
        crank = f"left_ankle_crank{number}"
        robot.body(
            crank,
            revolute(f"left_motor_ankle{number}", "left_shin", motor, LEFT, degrees=(-60.0, 80.0), motor=X6_8),
            Cylinder(motor, beside(motor, crank_end[1]), radius=0.014, mass=0.02),
            Cylinder(beside(motor, crank_end[1]), crank_end, radius=0.006, mass=0.01),
            material="rod",
        )
        robot.rod(
            f"left_ankle_rod{number}",
            (crank, crank_end),
            ("left_foot", foot_end),
            radius=0.004,
            mass=mass,
            material="rod",
            ends=("universal", "ball"),
        )


def beside(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
