"""Draws a corner of a car with double wishbones. Run as ``python -m robots.double_wishbone.build [FOLDER]``.

World: origin on the ground in the middle of the front axle, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import (
    Cylinder,
    Drawing,
    Motor,
    Sphere,
    Spring,
    Vector3,
    assembled_at,
    ball,
    cross,
    prismatic,
    revolute,
    unit,
    universal,
    write,
)

WHEEL = (0.0, 0.78, 0.31)
LOWER_AXIS = (0.0, 0.4, 0.2)
LOWER_BALL = (0.0, 0.7, 0.18)
UPPER_AXIS = (-0.02, 0.45, 0.48)
UPPER_BALL = (-0.02, 0.67, 0.5)
RACK_END = (-0.12, 0.38, 0.23)
STEERING_ARM = (-0.12, 0.69, 0.21)
STRUT_TOP = (0.0, 0.5, 0.66)
STRUT_EYE = (0.0, 0.58, 0.2)

FORWARD = (1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)
#: Leans back by 3 degrees, so that the car dives less where it brakes.
UPPER_DIRECTION = (1.0, 0.0, -0.052)

STEERING = Motor(effort=8000.0, velocity=0.3, friction=150.0, name="steering", control=(-8000.0, 8000.0))
SPRING = Spring(stiffness=48000.0, rest=0.075, damping=3200.0)


def draw() -> Drawing:
    """The corner at ride height, steered straight ahead."""
    robot = Drawing(
        "double_wishbone",
        materials={
            "chassis": (0.25, 0.3, 0.42, 1.0),
            "arm": (0.75, 0.25, 0.2, 1.0),
            "upright": (0.55, 0.57, 0.6, 1.0),
            "tyre": (0.16, 0.16, 0.17, 1.0),
            "strut": (0.9, 0.65, 0.15, 1.0),
            "rack": (0.2, 0.5, 0.35, 1.0),
        },
        metadata={
            "description": "Front left corner of a car: double wishbones, spring and damper, rack steering",
            "license": "BSD-3-Clause",
            "source": "No particular car: estimates of the size of a middle-class one",
        },
    )
    draw_chassis(robot)
    draw_arms(robot)
    draw_strut(robot)
    draw_steering(robot)
    robot.frame("wheel_center", "upright", WHEEL)
    robot.frame("tyre_contact", "upright", (WHEEL[0], WHEEL[1], 0.0))
    for name, held in {
        "bump": {"spring_strut": -0.06, "motor_rack": 0.0},
        "droop": {"spring_strut": 0.06, "motor_rack": 0.0},
        "left_turn": {"spring_strut": 0.0, "motor_rack": -0.06},
    }.items():
        robot.configure(name, **assembled_at(robot, held))
    return robot


def draw_chassis(robot: Drawing) -> None:
    """The part of the chassis that carries the corner, and the housing of the rack."""
    rails = [Cylinder((-0.25, y, z), (0.25, y, z), radius=0.02, mass=4.0) for y, z in ((0.38, 0.2), (0.42, 0.5))]
    posts = [Cylinder((x, 0.38, 0.2), (x, 0.42, 0.5), radius=0.018, mass=2.0) for x in (-0.22, 0.22)]
    tower = [Cylinder((x, 0.42, 0.5), STRUT_TOP, radius=0.018, mass=2.0) for x in (-0.22, 0.22)]
    bushes = [Cylinder((x, 0.42, 0.5), (x, *UPPER_AXIS[1:]), radius=0.015, mass=0.3) for x in (-0.12, 0.08)]
    housing = Cylinder((-0.12, 0.18, 0.23), (-0.12, 0.365, 0.23), radius=0.026, mass=3.0)
    robot.body("chassis", None, *rails, *posts, *tower, *bushes, housing, material="chassis")


def draw_arms(robot: Drawing) -> None:
    """The arms, the upright between them, and the wheel. The bushes of the upper arm close the loop as a hinge."""
    legs = [Cylinder((x, *LOWER_AXIS[1:]), LOWER_BALL, radius=0.015, mass=1.6) for x in (-0.15, 0.15)]
    seat = Cylinder((-0.05, 0.58, 0.19), (0.05, 0.58, 0.19), radius=0.014, mass=0.4)
    robot.body(
        "lower_arm",
        revolute("free_lower_arm", "chassis", LOWER_AXIS, FORWARD, degrees=(-25.0, 25.0)),
        *legs,
        *(Sphere((x, *LOWER_AXIS[1:]), 0.025, mass=0.2) for x in (-0.15, 0.15)),
        seat,
        Sphere(LOWER_BALL, 0.025, mass=0.4),
        material="arm",
    )
    hub = Cylinder((WHEEL[0], 0.66, WHEEL[2]), (WHEEL[0], 0.73, WHEEL[2]), radius=0.05, mass=3.5)
    robot.body(
        "upright",
        ball("ball_lower", "lower_arm", LOWER_BALL),
        Cylinder(LOWER_BALL, UPPER_BALL, radius=0.02, mass=3.0),
        hub,
        Cylinder((0.0, 0.695, 0.2), STEERING_ARM, radius=0.012, mass=0.7),
        Sphere(STEERING_ARM, 0.018, mass=0.2),
        material="upright",
    )
    tyre = Cylinder((WHEEL[0], 0.72, WHEEL[2]), (WHEEL[0], 0.88, WHEEL[2]), radius=0.31, mass=18.0)
    robot.body("wheel", revolute("free_wheel", "upright", WHEEL, LEFT), tyre, material="tyre", contacts=(tyre,))
    ends = [(x, *UPPER_AXIS[1:]) for x in (-0.12, 0.08)]
    robot.body(
        "upper_arm",
        ball("ball_upper", "upright", UPPER_BALL),
        *(Cylinder(end, UPPER_BALL, radius=0.012, mass=0.7) for end in ends),
        *(Sphere(end, 0.022, mass=0.15) for end in ends),
        Sphere(UPPER_BALL, 0.022, mass=0.3),
        material="arm",
    )
    robot.hinge("upper_bush", "upper_arm", "chassis", UPPER_AXIS, UPPER_DIRECTION)


def draw_strut(robot: Drawing) -> None:
    """The spring with the damper, from the tower to the lower arm."""
    along = unit(minus(STRUT_EYE, STRUT_TOP))
    middle, low = at(STRUT_TOP, along, 0.3), at(STRUT_TOP, along, 0.2)
    robot.body(
        "damper",
        universal("universal_strut", "chassis", STRUT_TOP, FORWARD, cross(along, FORWARD)),
        Sphere(STRUT_TOP, 0.025, mass=0.2),
        Cylinder(STRUT_TOP, middle, radius=0.03, mass=1.8),
        material="strut",
    )
    robot.body(
        "piston",
        prismatic("spring_strut", "damper", STRUT_EYE, along, metres=(-0.08, 0.08), spring=SPRING),
        Cylinder(low, STRUT_EYE, radius=0.014, mass=1.0),
        Sphere(STRUT_EYE, 0.022, mass=0.2),
        material="upright",
    )
    robot.close("strut_eye", "3d", "piston", "lower_arm", STRUT_EYE)


def draw_steering(robot: Drawing) -> None:
    """The rack, and the tie rod as a distance."""
    robot.body(
        "rack",
        prismatic("motor_rack", "chassis", RACK_END, LEFT, metres=(-0.07, 0.07), motor=STEERING),
        Cylinder((-0.12, 0.1, 0.23), RACK_END, radius=0.012, mass=1.8),
        Sphere(RACK_END, 0.018, mass=0.2),
        material="rack",
    )
    robot.distance("tie_rod", ("rack", RACK_END), ("upright", STEERING_ARM))


def minus(end: Vector3, start: Vector3) -> Vector3:
    """The vector from one point to another."""
    return (end[0] - start[0], end[1] - start[1], end[2] - start[2])


def at(start: Vector3, direction: Vector3, length: float) -> Vector3:
    """The point so far from another in a direction, m."""
    return (start[0] + length * direction[0], start[1] + length * direction[1], start[2] + length * direction[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
