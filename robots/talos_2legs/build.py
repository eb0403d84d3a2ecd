"""Draws the whole of Talos. Run as ``python -m robots.talos_2legs.build [FOLDER]``.

World: origin at the base frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, midpoint, revolute, write
from robots.builder.drawing import End
from robots.talos_leg.build import FORWARD, LEFT, UP, draw_leg, draw_pelvis

BACK = (-1.0, 0.0, 0.0)
DOWN = (0.0, 0.0, -1.0)

# Points of the published description, to 0.1 mm, where torso and head are straight, the upper arm is 10 degrees off
# the body and the elbow bent by 90: the forearm points forward.
TORSO = (0.0000, 0.0000, 0.0722)
HEAD = (0.0200, 0.0000, 0.3932)
SHOULDER = (0.0000, 0.1575, 0.3042)
UPPER_ARM = (0.0049, 0.2940, 0.3509)
ELBOW = (0.0249, 0.3414, 0.0821)
WRIST = (0.2892, 0.3449, 0.0624)

#: Axis of the upper arm, and of the elbow across it.
ALONG_ARM = (0.0, -math.sin(math.radians(10.0)), math.cos(math.radians(10.0)))
ACROSS_ARM = (0.0, ALONG_ARM[2], -ALONG_ARM[1])


@dataclass(frozen=True, slots=True)
class Finger:
    """A finger of the gripper, closed by 20 degrees: two parallel links on the hand, and tips on the second.

    Attributes:
        crank: Hinge of the first link, m.
        crank_stop: How far it closes, degrees.
        crank_mass: kg.
        link: Hinge of the second link, m.
        link_mass: kg.
        tips: Hinges of the tips, m.
    """

    crank: Vector3
    crank_stop: float
    crank_mass: float
    link: Vector3
    link_mass: float
    tips: tuple[Vector3, ...]


OUTER = Finger(
    crank=(0.4117, 0.3651, 0.0624),
    crank_stop=55.0,
    crank_mass=0.1344,
    link=(0.4377, 0.3501, 0.0624),
    link_mass=0.088,
    tips=((0.5150, 0.3708, 0.0944), (0.5150, 0.3708, 0.0304)),
)
INNER = Finger(
    crank=(0.4117, 0.3246, 0.0624),
    crank_stop=60.0,
    crank_mass=0.1079,
    link=(0.4377, 0.3396, 0.0624),
    link_mass=0.0472,
    tips=((0.5150, 0.3189, 0.0624),),
)

# Efforts, velocities, damping and friction as published.
TORSO_MOTOR = Motor(effort=200.0, velocity=5.4, damping=1.0, friction=1.0)
NECK_TILT_MOTOR = Motor(effort=8.0, velocity=1.0, damping=0.5, friction=1.0)
NECK_PAN_MOTOR = Motor(effort=4.0, velocity=1.0, damping=0.5, friction=1.0)
ARM_1_MOTOR = Motor(effort=100.0, velocity=2.7, damping=1.0, friction=1.0)
ARM_2_MOTOR = Motor(effort=100.0, velocity=3.66, damping=1.0, friction=1.0)
ELBOW_MOTOR = Motor(effort=70.0, velocity=4.58, damping=1.0, friction=1.0)
FOREARM_MOTOR = Motor(effort=20.0, velocity=1.95, damping=1.0, friction=1.0)
WRIST_MOTOR = Motor(effort=8.0, velocity=1.76, damping=1.0, friction=1.0)
GRIPPER_MOTOR = Motor(effort=1.0, velocity=1.0, damping=1.0, friction=1.0)


def draw() -> Drawing:
    """The robot with every joint at zero."""
    return draw_talos("talos_2legs", "PAL Robotics' humanoid Talos, drawn from primitive shapes", ("ball", "point"))


def draw_talos(name: str, description: str, ends: tuple[End, End]) -> Drawing:
    """The robot, with what the rods of its ankles have at the crank and at the ankle."""
    robot = draw_pelvis(name, description, "floating")
    draw_torso(robot)
    draw_leg(robot, prefix="left_", ends=ends)
    draw_arm(robot)
    draw_forearm(robot)
    draw_gripper(robot)
    robot.mirror("left", "right")
    return robot


def draw_torso(robot: Drawing) -> None:
    """The torso, from yaw to pitch, and the head, from tilt to pan."""
    robot.body(
        "waist",
        revolute("motor_torso_1", "pelvis", TORSO, UP, degrees=(-72.0, 72.0), motor=TORSO_MOTOR),
        Cylinder((0.0, 0.0, 0.02), (0.0, 0.0, 0.0722), radius=0.06, mass=1.295),
        Cylinder((0.0, -0.06, 0.0722), (0.0, 0.06, 0.0722), radius=0.045, mass=1.0),
        material="motor",
    )
    chest = Box((-0.045, 0.0, 0.2022), (0.28, 0.34, 0.26), mass=12.0)
    robot.body(
        "torso",
        revolute("motor_torso_2", "waist", TORSO, LEFT, degrees=(-13.0, 42.0), motor=TORSO_MOTOR),
        chest,
        Box((-0.19, 0.0, 0.21), (0.07, 0.3, 0.34), mass=1.5),
        Cylinder((0.0, -0.17, 0.2642), (0.0, 0.17, 0.2642), radius=0.07, mass=3.284),
        Cylinder((0.02, 0.0, 0.33), (0.02, 0.0, 0.38), radius=0.05, mass=0.2),
        material="shell",
        contacts=(chest,),
    )
    robot.body(
        "neck",
        revolute("motor_head_1", "torso", HEAD, LEFT, degrees=(-12.0, 45.0), motor=NECK_TILT_MOTOR),
        Cylinder((0.02, -0.045, 0.3932), (0.02, 0.045, 0.3932), radius=0.035, mass=0.4375),
        Cylinder((0.02, 0.0, 0.3932), (0.02, 0.0, 0.4532), radius=0.04, mass=0.3),
        material="motor",
    )
    face = Box((0.033, 0.0, 0.5532), (0.16, 0.14, 0.2), mass=1.264)
    robot.body(
        "head",
        revolute("motor_head_2", "neck", HEAD, UP, degrees=(-75.0, 75.0), motor=NECK_PAN_MOTOR),
        face,
        Cylinder((0.02, 0.0, 0.4032), (0.02, 0.0, 0.4632), radius=0.045, mass=0.22),
        material="shell",
        contacts=(face,),
    )


def draw_arm(robot: Drawing) -> None:
    """The left arm from the shoulder to the elbow."""
    robot.body(
        "left_shoulder",
        revolute("left_motor_arm_1", "torso", SHOULDER, UP, degrees=(-90.0, 45.0), motor=ARM_1_MOTOR),
        Cylinder((0.0, 0.1575, 0.3342), (0.0, 0.1575, 0.3742), radius=0.055, mass=0.4),
        Box((0.0, 0.225, 0.3509), (0.08, 0.135, 0.06), mass=0.6146),
        Cylinder((-0.055, 0.294, 0.3509), (0.055, 0.294, 0.3509), radius=0.05, mass=1.7),
        material="motor",
    )
    robot.body(
        "left_upper_arm",
        revolute(
            "left_motor_arm_2",
            "left_shoulder",
            UPPER_ARM,
            FORWARD,
            degrees=(0.5, 164.5),
            drawn=10.0,
            motor=ARM_2_MOTOR,
        ),
        Cylinder((0.0193, 0.294, 0.3509), (0.0193, 0.3242, 0.1795), radius=0.048, mass=2.4251),
        material="leg",
    )
    robot.body(
        "left_elbow",
        revolute(
            "left_motor_arm_3",
            "left_upper_arm",
            UPPER_ARM,
            ALONG_ARM,
            degrees=(-139.0, 139.0),
            motor=ELBOW_MOTOR,
        ),
        Cylinder((0.0193, 0.3242, 0.1795), ELBOW, radius=0.042, mass=0.8),
        Cylinder((0.0249, 0.3119, 0.0768), (0.0249, 0.4094, 0.094), radius=0.042, mass=1.4087),
        material="leg",
    )
    robot.body(
        "left_forearm",
        revolute(
            "left_motor_arm_4",
            "left_elbow",
            ELBOW,
            ACROSS_ARM,
            degrees=(-128.0, 0.2),
            drawn=-90.0,
            motor=ELBOW_MOTOR,
        ),
        Cylinder((0.0149, 0.3265, 0.071), (0.1249, 0.3449, 0.0624), radius=0.038, mass=0.8773),
        material="leg",
    )


def draw_forearm(robot: Drawing) -> None:
    """The left forearm beyond the elbow, the wrist, and the hand with the force sensor."""
    tube = Cylinder((0.1252, 0.3449, 0.0624), (0.2692, 0.3449, 0.0624), radius=0.04, mass=1.8779)
    robot.body(
        "left_wrist",
        revolute(
            "left_motor_arm_5",
            "left_forearm",
            WRIST,
            BACK,
            degrees=(-144.0, 144.0),
            drawn=10.0,
            motor=FOREARM_MOTOR,
        ),
        tube,
        material="shell",
        contacts=(tube,),
    )
    robot.body(
        "left_wrist_cross",
        revolute("left_motor_arm_6", "left_wrist", WRIST, UP, degrees=(-78.5, 78.5), motor=WRIST_MOTOR),
        Cylinder((0.2892, 0.3449, 0.0373), (0.2892, 0.3449, 0.0873), radius=0.025, mass=0.4093),
        material="shell",
    )
    palm = Box((0.4042, 0.3449, 0.0624), (0.06, 0.09, 0.07), mass=0.6375)
    robot.body(
        "left_hand",
        revolute("left_motor_arm_7", "left_wrist_cross", WRIST, LEFT, degrees=(-39.0, 39.0), motor=WRIST_MOTOR),
        Cylinder((0.2942, 0.3449, 0.0624), (0.3742, 0.3449, 0.0624), radius=0.026, mass=0.4044),
        palm,
        material="leg",
        contacts=(palm,),
    )


def draw_gripper(robot: Drawing) -> None:
    """The left gripper."""
    draw_finger(robot, "outer", OUTER, DOWN, UP)
    draw_finger(robot, "inner", INNER, UP, DOWN)


def draw_finger(robot: Drawing, name: str, finger: Finger, closing: Vector3, opening: Vector3) -> None:
    """A finger of the left hand. As it closes, its links turn in one direction, and its tips back by the same angle."""
    end = midpoint(finger.tips[0], finger.tips[-1])
    bar = (end[0] - finger.link[0], end[1] - finger.link[1], 0.0)
    robot.body(
        f"left_{name}_crank",
        revolute(
            f"left_motor_{name}_crank",
            "left_hand",
            finger.crank,
            closing,
            degrees=(0.0, finger.crank_stop),
            drawn=20.0,
            motor=GRIPPER_MOTOR,
        ),
        Cylinder(finger.crank, along(finger.crank, bar, 0.6), radius=0.01, mass=finger.crank_mass),
        material="rod",
    )
    robot.body(
        f"left_{name}_link",
        revolute(
            f"left_motor_{name}_link",
            "left_hand",
            finger.link,
            closing,
            degrees=(0.0, 60.0),
            drawn=20.0,
            motor=GRIPPER_MOTOR,
        ),
        *(Cylinder(finger.link, tip, radius=0.007, mass=finger.link_mass / len(finger.tips)) for tip in finger.tips),
        material="rod",
    )
    for number, tip in enumerate(finger.tips, start=1):
        robot.body(
            f"left_{name}_tip{number}",
            revolute(
                f"left_motor_{name}_tip{number}",
                f"left_{name}_link",
                tip,
                opening,
                degrees=(0.0, 60.0),
                drawn=20.0,
                motor=GRIPPER_MOTOR,
            ),
            Box((tip[0] + 0.005, tip[1], tip[2]), (0.04, 0.012, 0.02), mass=0.0263),
            material="leg",
        )


def along(point: Vector3, bar: Vector3, part: float) -> Vector3:
    """The point moved along a part of a bar (m)."""
    return (point[0] + part * bar[0], point[1] + part * bar[1], point[2] + part * bar[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
