"""Draws ToddlerBot without arms. Run as ``python -m robots.toddlerbot_2legs.build [FOLDER]``.

World: origin at the base frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, revolute, write

FORWARD = (1.0, 0.0, 0.0)
BACK = (-1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
RIGHT = (0.0, -1.0, 0.0)
UP = (0.0, 0.0, 1.0)
DOWN = (0.0, 0.0, -1.0)

# Points of the published description, to 0.1 mm, where all joints are at zero: the legs stretched.
NECK_DRIVE = (-0.0050, 0.0, 0.1215)
NECK_YAW = (0.0160, 0.0, 0.1225)
NECK_PITCH = (0.0160, 0.0040, 0.1419)
NECK_HORN = (-0.0109, 0.0015, 0.1746)
WAIST_YAW = (0.0, 0.0, 0.0)
WAIST_ROLL = (0.0227, 0.0, -0.0140)
WAIST_ACT_1 = (0.0100, 0.0, -0.0336)
WAIST_ACT_2 = (-0.0100, 0.0, -0.0336)
HIP_PITCH = (0.0, 0.0560, -0.0541)
HIP_ROLL = (-0.0190, 0.0370, -0.0781)
HIP_YAW = (0.0, 0.0370, -0.1111)
HIP_DRIVE = (-0.0192, 0.0368, -0.1176)
KNEE = (0.0, 0.0457, -0.1971)
KNEE_HORN = (0.0, 0.0245, -0.1556)
ANKLE_PITCH = (0.0, 0.0180, -0.2971)
ANKLE_ROLL = (-0.0228, 0.0370, -0.2971)
SOLE = (0.0110, 0.0370, -0.3360)

# From the axis of a horn, and of the joint that it drives, to the pin of the front rod; the back one is opposite.
NECK_PIN = (-0.0072, 0.0, -0.0019)
KNEE_PIN = (0.0057, 0.0, 0.0139)

# The planes in which the rods of the neck and of the knee move: y, m.
NECK_PLANE = -0.0056
KNEE_PLANE = 0.0180

# The servos: torque, no-load velocity, damping, friction and armature as published. Their gears are part of the latter.
XC330 = Motor(effort=0.99, velocity=10.0, damping=0.134, friction=0.014, rotor_inertia=0.0035)
XC430 = Motor(effort=1.45, velocity=10.0, damping=0.127, friction=0.069, rotor_inertia=0.004)
TWO_XC430 = Motor(effort=1.74, velocity=10.0, damping=0.075, friction=0.252, rotor_inertia=0.0044)
XM430 = Motor(effort=1.86, velocity=10.0, damping=0.08, friction=0.134, rotor_inertia=0.0012)

#: Angles of the posture in which the robot stands, rad.
HIP, KNEES, ANKLES = 0.145689, -0.534732, -0.379457


def draw() -> Drawing:
    """The robot with every joint at zero: upright, the legs stretched."""
    robot = Drawing(
        "toddlerbot_2legs",
        materials={
            "shell": (0.55, 0.62, 0.45, 1.0),
            "servo": (0.22, 0.23, 0.26, 1.0),
            "bracket": (0.45, 0.47, 0.52, 1.0),
            "rod": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": "Stanford's ToddlerBot without arms, with its gears and rods, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of the description of ToddlerBot by Shi, Wang and others",
        },
        root="floating",
    )
    torso = Box((-0.0026, 0.0, 0.0654), (0.07, 0.12, 0.11), mass=1.085)
    robot.body("torso", None, torso, material="shell", contacts=(torso,))
    draw_neck(robot)
    draw_waist(robot)
    draw_hip(robot)
    draw_knee(robot)
    draw_foot(robot)
    robot.mirror("left", "right")
    standing = {}
    for side in ("left", "right"):
        standing[f"{side}_hip_pitch"] = HIP
        for joint in ("knee", "knee_act", "knee_front", "knee_back"):
            standing[f"{side}_{joint}"] = KNEES
        standing[f"{side}_ank_pitch"] = ANKLES
    robot.configure("home", **standing)
    return robot


def draw_neck(robot: Drawing) -> None:
    """The neck, which yaws through two spur gears of 20 and 22 teeth, and the head, which pitches through two rods."""
    robot.body(
        "neck_drive",
        revolute("neck_yaw_drive", "torso", NECK_DRIVE, UP, degrees=(-165.0, 165.0), motor=XC330),
        Cylinder((NECK_DRIVE[0], 0.0, 0.12), (NECK_DRIVE[0], 0.0, 0.1285), radius=0.01, mass=0.0016),
        material="rod",
    )
    robot.body(
        "neck",
        revolute("neck_yaw_driven", "torso", NECK_YAW, UP, degrees=(-150.0, 150.0)),
        Cylinder((NECK_YAW[0], 0.0, 0.12), (NECK_YAW[0], 0.0, 0.1285), radius=0.011, mass=0.003),
        Box((0.016, 0.0, 0.136), (0.018, 0.008, 0.016), mass=0.0037),
        material="bracket",
    )
    face = Box((0.0045, 0.0, 0.194), (0.075, 0.07, 0.06), mass=0.09)
    robot.body(
        "head",
        revolute("neck_pitch", "neck", NECK_PITCH, RIGHT, degrees=(-80.0, 35.0)),
        face,
        Box((-0.005, 0.0125, 0.175), (0.034, 0.02, 0.026), mass=0.0401),
        Cylinder((0.016, 0.004, 0.1419), (0.016, 0.010, 0.1419), radius=0.007, mass=0.003),
        Box((0.014, 0.010, 0.153), (0.012, 0.005, 0.026), mass=0.0041),
        material="shell",
        contacts=(face,),
    )
    robot.body(
        "neck_horn",
        revolute("neck_pitch_act", "head", NECK_HORN, LEFT, degrees=(-80.0, 35.0), motor=XC330),
        Cylinder(NECK_HORN, in_plane(NECK_HORN, -0.0035), radius=0.010, mass=0.0017),
        material="servo",
    )
    for name, sign in (("front", 1.0), ("back", -1.0)):
        pins = [in_plane(moved(at, NECK_PIN, sign), NECK_PLANE) for at in (NECK_PITCH, NECK_HORN)]
        draw_rod(robot, f"neck_{name}", "neck", "neck_horn", pins)
    robot.couple("neck_yaw", neck_yaw_driven=1.0, neck_yaw_drive=20.0 / 22.0)


def draw_waist(robot: Drawing) -> None:
    """The pelvis, which yaws and rolls below the torso: two motors turn bevel gears that share both motions."""
    robot.body(
        "waist_gears",
        revolute("waist_yaw", "torso", WAIST_YAW, UP, degrees=(-90.0, 90.0)),
        Cylinder((0.0, 0.0, 0.011), (0.0, 0.0, -0.014), radius=0.018, mass=0.02),
        Cylinder((-0.0227, 0.0, -0.014), WAIST_ROLL, radius=0.005, mass=0.0063),
        material="bracket",
    )
    hips = Box((0.0, 0.0, -0.0400), (0.044, 0.100, 0.026), mass=0.1082)
    robot.body(
        "pelvis",
        revolute("waist_roll", "waist_gears", WAIST_ROLL, FORWARD, degrees=(-30.0, 30.0)),
        hips,
        material="servo",
        contacts=(hips,),
    )
    for number, at, axis in ((1, WAIST_ACT_1, UP), (2, WAIST_ACT_2, DOWN)):
        robot.body(
            f"waist_bevel_{number}",
            revolute(f"waist_act_{number}", "pelvis", at, axis, degrees=(-268.0, 268.0), motor=XC330),
            Cylinder(at, (at[0], 0.0, -0.0185), radius=0.007, mass=0.0007),
            material="rod",
        )
    robot.couple("waist_roll_gears", waist_roll=1.0, waist_act_1=7.0 / 24.0, waist_act_2=-7.0 / 24.0)
    robot.couple("waist_yaw_gears", waist_yaw=1.0, waist_act_1=-5.0 / 24.0, waist_act_2=-5.0 / 24.0)


def draw_hip(robot: Drawing) -> None:
    """The left hip from pitch through roll to yaw, which two spur gears of 18 and 21 teeth drive, and the thigh."""
    robot.body(
        "left_hip",
        revolute("left_hip_pitch", "pelvis", HIP_PITCH, RIGHT, degrees=(-90.0, 135.0), motor=TWO_XC430),
        Box((0.0, 0.037, -0.066), (0.036, 0.036, 0.046), mass=0.1106),
        material="servo",
    )
    robot.body(
        "left_hip_bracket",
        revolute("left_hip_roll", "left_hip", HIP_ROLL, BACK, degrees=(-45.0, 45.0), motor=TWO_XC430),
        Box((0.0, 0.037, -0.1005), (0.044, 0.03, 0.021), mass=0.0104),
        Box((-0.020, 0.037, -0.087), (0.004, 0.026, 0.03), mass=0.005),
        material="bracket",
    )
    thigh = Box((-0.008, 0.0405, -0.155), (0.04, 0.03, 0.07), mass=0.13)
    robot.body(
        "left_thigh",
        revolute("left_hip_yaw_driven", "left_hip_bracket", HIP_YAW, DOWN, degrees=(-90.0, 90.0)),
        thigh,
        Cylinder(HIP_YAW, (0.0, 0.037, -0.121), radius=0.0105, mass=0.006),
        Box((0.0, 0.0457, -0.195), (0.016, 0.006, 0.02), mass=0.013),
        material="servo",
        contacts=(thigh,),
    )
    robot.body(
        "left_hip_gear",
        revolute("left_hip_yaw_drive", "left_thigh", HIP_DRIVE, UP, degrees=(-105.0, 105.0), motor=XC330),
        Cylinder(HIP_DRIVE, (HIP_DRIVE[0], HIP_DRIVE[1], -0.1105), radius=0.009, mass=0.0008),
        material="rod",
    )
    robot.couple("left_hip_yaw", left_hip_yaw_driven=1.0, left_hip_yaw_drive=18.0 / 21.0)


def draw_knee(robot: Drawing) -> None:
    """The left knee, which a horn on the thigh turns through two rods, and the shank."""
    shank = Box((0.0, 0.037, -0.242), (0.018, 0.024, 0.08), mass=0.021)
    robot.body(
        "left_shank",
        revolute("left_knee", "left_thigh", KNEE, RIGHT, degrees=(-120.0, 0.0)),
        shank,
        Cylinder((0.0, 0.0485, -0.1971), (0.0, 0.0525, -0.1971), radius=0.012, mass=0.002),
        Box((0.0, 0.0505, -0.215), (0.016, 0.004, 0.04), mass=0.003),
        Box((0.0, 0.0228, -0.210), (0.024, 0.005, 0.05), mass=0.005),
        material="bracket",
        contacts=(shank,),
    )
    robot.body(
        "left_knee_horn",
        revolute("left_knee_act", "left_thigh", KNEE_HORN, RIGHT, degrees=(-120.0, 0.0), motor=XM430),
        Cylinder(in_plane(KNEE_HORN, 0.0258), in_plane(KNEE_HORN, 0.0205), radius=0.018, mass=0.0027),
        material="bracket",
    )
    for name, sign in (("front", 1.0), ("back", -1.0)):
        pins = [in_plane(moved(at, KNEE_PIN, sign), KNEE_PLANE) for at in (KNEE_HORN, KNEE)]
        draw_rod(robot, f"left_knee_{name}", "left_knee_horn", "left_shank", pins)


def draw_foot(robot: Drawing) -> None:
    """The left ankle, from pitch to roll, and the foot."""
    robot.body(
        "left_ankle",
        revolute("left_ank_pitch", "left_shank", ANKLE_PITCH, LEFT, degrees=(-100.0, 45.0), motor=XM430),
        Box((-0.006, 0.037, -0.2960), (0.032, 0.036, 0.028), mass=0.1768),
        material="servo",
    )
    sole = Box((SOLE[0], SOLE[1], SOLE[2] + 0.004), (0.1, 0.052, 0.008), mass=0.03)
    robot.body(
        "left_foot",
        revolute("left_ank_roll", "left_ankle", ANKLE_ROLL, FORWARD, degrees=(-90.0, 90.0), motor=XC430),
        sole,
        Box((-0.025, 0.037, -0.312), (0.006, 0.026, 0.036), mass=0.0126),
        material="bracket",
        contacts=(sole,),
    )
    robot.frame("left_sole", "left_foot", SOLE)


def draw_rod(robot: Drawing, name: str, start: str, end: str, pins: list[Vector3]) -> None:
    """A rod of a parallelogram, carried by its pin on one body; a hinge closes its pin on the other."""
    first, last = pins
    robot.body(
        f"{name}_rod",
        revolute(name, start, first, LEFT, degrees=(-180.0, 180.0)),
        Cylinder(first, last, radius=0.0025, mass=0.0022),
        *(Cylinder(moved(pin, LEFT, -0.002), moved(pin, LEFT, 0.002), radius=0.004, mass=0.0005) for pin in pins),
        material="rod",
    )
    robot.hinge(f"{name}_pin", f"{name}_rod", end, last, LEFT)


def moved(point: Vector3, by: Vector3, factor: float) -> Vector3:
    """The point moved by a multiple of a vector (m)."""
    return (point[0] + factor * by[0], point[1] + factor * by[1], point[2] + factor * by[2])


def in_plane(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
