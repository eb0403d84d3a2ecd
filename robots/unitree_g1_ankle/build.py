"""Draws the left ankle of Unitree's G1. Run as ``python -m robots.unitree_g1_ankle.build [FOLDER]``.

World: origin in the middle of the ankle's pitch axis, x forward, y to the left, z up along the shank; m, kg.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, revolute, write

KNEE = (0.0, 0.0, 0.3000)
PITCH = (0.0, 0.0, 0.0)
ROLL = (0.0, 0.0, -0.0176)
SOLE = (0.035, 0.0, -0.0426)

# Motor A, the lower one, pulls the outer side of the foot, motor B the inner side: where their axes leave the motors,
# the balls on their cranks, and the universal joints on the foot.
MOTOR_A = (0.022, 0.0, 0.1509)
CRANK_A = (0.035, 0.0165, 0.1469)
FOOT_A = (0.022, 0.015, -0.0096)
MOTOR_B = (0.022, 0.0, 0.2159)
CRANK_B = (0.0395, -0.0164, 0.2112)
FOOT_B = (0.022, -0.015, -0.0096)

FORWARD = (1.0, 0.0, 0.0)
LEFT = (0.0, 1.0, 0.0)

#: The actuator that Unitree calls 5020.
ANKLE_MOTOR = Motor(effort=25.0, velocity=37.0)

#: Plane in which the cranks turn: x, m.
CRANK_PLANE = 0.028


def draw() -> Drawing:
    """The ankle with every joint at zero: the sole level, the cranks across."""
    robot = Drawing(
        "unitree_g1_ankle",
        materials={
            "shell": (0.58, 0.62, 0.68, 1.0),
            "motor": (0.2, 0.21, 0.24, 1.0),
            "foot": (0.35, 0.37, 0.42, 1.0),
            "rod": (0.85, 0.5, 0.15, 1.0),
        },
        metadata={
            "description": "Left ankle of Unitree's G1 on a fixed shank, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of Unitree's description of the G1 and of feidedao's model of its ankle",
        },
    )
    draw_shank(robot)
    draw_foot(robot)
    draw_side(robot, "a", MOTOR_A, CRANK_A, FOOT_A, degrees=(-47.0, 85.0), rod_mass=0.011)
    draw_side(robot, "b", MOTOR_B, CRANK_B, FOOT_B, degrees=(-85.0, 47.0), rod_mass=0.015)
    return robot


def draw_shank(robot: Drawing) -> None:
    """The shank, with the two motors one above the other and a fork at the ankle."""
    robot.body(
        "shank",
        None,
        Cylinder(beside(KNEE, -0.04), beside(KNEE, 0.04), radius=0.045, mass=0.5),
        Cylinder(KNEE, (-0.012, 0.0, 0.03), radius=0.022, mass=0.55),
        Cylinder((-0.022, 0.0, MOTOR_A[2]), MOTOR_A, radius=0.027, mass=0.3),
        Cylinder((-0.022, 0.0, MOTOR_B[2]), MOTOR_B, radius=0.027, mass=0.3),
        Box((-0.012, 0.0, 0.035), (0.024, 0.058, 0.02), mass=0.08),
        Box((-0.004, 0.026, 0.012), (0.02, 0.006, 0.05), mass=0.04),
        Box((-0.004, -0.026, 0.012), (0.02, 0.006, 0.05), mass=0.04),
        material="shell",
    )


def draw_foot(robot: Drawing) -> None:
    """The ankle's cross, from pitch to roll, and the foot."""
    robot.body(
        "ankle",
        revolute("free_pitch", "shank", PITCH, LEFT, degrees=(-50.0, 30.0)),
        Cylinder(beside(PITCH, -0.023), beside(PITCH, 0.023), radius=0.007, mass=0.04),
        Cylinder((-0.015, 0.0, ROLL[2]), (0.015, 0.0, ROLL[2]), radius=0.006, mass=0.034),
        material="motor",
    )
    sole = Box(SOLE, (0.18, 0.066, 0.02), mass=0.408)
    robot.body(
        "foot",
        revolute("free_roll", "ankle", ROLL, FORWARD, degrees=(-15.0, 15.0)),
        sole,
        Box((0.02, 0.0, -0.021), (0.012, 0.022, 0.026), mass=0.1),
        Box((-0.02, 0.0, -0.024), (0.012, 0.022, 0.02), mass=0.06),
        Cylinder(FOOT_A, FOOT_B, radius=0.004, mass=0.04),
        material="foot",
        contacts=(sole,),
    )


def draw_side(
    robot: Drawing,
    side: str,
    motor: Vector3,
    ball: Vector3,
    foot: Vector3,
    degrees: tuple[float, float],
    rod_mass: float,
) -> None:
    """A motor's crank, which turns about the shank's x, and the rod that joins it to the foot."""
    in_plane = (CRANK_PLANE, ball[1], ball[2])
    robot.body(
        f"crank_{side}",
        revolute(f"motor_{side}", "shank", motor, FORWARD, degrees=degrees, motor=ANKLE_MOTOR),
        Cylinder(motor, (0.032, 0.0, motor[2]), radius=0.012, mass=0.03),
        Cylinder((CRANK_PLANE, 0.0, motor[2]), in_plane, radius=0.005, mass=0.012),
        Cylinder(in_plane, ball, radius=0.003, mass=0.006),
        material="motor",
    )
    robot.rod(
        f"rod_{side}",
        ("foot", foot),
        (f"crank_{side}", ball),
        radius=0.003,
        mass=rod_mass,
        material="rod",
        ends=("universal", "point"),
    )


def beside(point: Vector3, y: float) -> Vector3:
    """The point moved along y, to ``y`` (m)."""
    return (point[0], y, point[2])


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
