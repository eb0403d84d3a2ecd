"""Draws Digit on its two legs. Run as ``python -m robots.digit_2legs.build [FOLDER]``."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

from robots.builder import Drawing, write
from robots.digit_leg.build import SOLE, draw_leg, draw_torso

#: Of each actuated joint of the left leg the gear ratio and the armature (kg·m²), as published.
GEARS = {
    "left_motor_hip_x": (80.0, 0.173824),
    "left_motor_hip_z": (50.0, 0.0679),
    "left_motor_hip_y": (16.0, 0.120473),
    "left_motor_knee": (16.0, 0.120473),
    "left_motor_shin1": (50.0, 0.036089),
    "left_motor_shin2": (50.0, 0.036089),
}


def draw() -> Drawing:
    """The robot with every joint at zero."""
    robot = draw_torso("digit_2legs", "Agility Robotics' Digit without arms, drawn from primitive shapes", "floating")
    draw_leg(robot, prefix="left_", ends=("ball", "universal"), springs=True)
    add_gears(robot)
    robot.frame("imu", "torso", (0.0, 0.0, 0.0), rpy=(0.0, -math.pi / 2.0, 0.0))
    robot.frame("left_sole", "left_foot", (SOLE[0], SOLE[1], SOLE[2] - 0.0115))
    robot.mirror("left", "right")
    return robot


def add_gears(robot: Drawing) -> None:
    """Gives the motors their gears and rotors: the armature is gear ratio² times the inertia of the rotor."""
    for name, body in robot.bodies.items():
        if body.joint and body.joint.motor:
            ratio, armature = GEARS[body.joint.name]
            motor = replace(body.joint.motor, gear_ratio=ratio, rotor_inertia=armature / ratio**2)
            robot.bodies[name] = replace(body, joint=replace(body.joint, motor=motor))


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
