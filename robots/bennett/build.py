"""Draws Bennett's linkage. Run as ``python -m robots.bennett.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, midpoint, revolute, write

# The corners of a skew quadrilateral, in m. A half turn about z maps it onto itself, so that opposite sides are equal:
# A B and C D are 14 cm, B C and D A 18 cm.
A = (0.08, 0.0, 0.10)
B = (0.04, 0.12, 0.16)
C = (-0.08, 0.0, 0.10)
D = (-0.04, -0.12, 0.16)

# The axis at each corner is perpendicular to both sides that meet there. This makes the sides the common perpendiculars
# of the axes, and with opposite sides equal it is Bennett's condition.
AXIS_A = (3.0, -1.0, 4.0)
AXIS_B = (0.0, -1.0, 2.0)
AXIS_C = (-3.0, 1.0, 4.0)
AXIS_D = (0.0, 1.0, 2.0)


def bar(start: Vector3, end: Vector3) -> Cylinder:
    """A round bar of 0.9 kg a metre."""
    whole = Cylinder(start, end, radius=0.008, mass=0.0)
    return Cylinder(start, end, whole.radius, mass=0.9 * whole.length)


def barrel(at: Vector3, axis: Vector3, radius: float = 0.012) -> Cylinder:
    """The hinge at a corner, about its axis."""
    half = 0.02 / sum(part * part for part in axis) ** 0.5
    start, end = (
        (at[0] + side * half * axis[0], at[1] + side * half * axis[1], at[2] + side * half * axis[2])
        for side in (-1.0, 1.0)
    )
    return Cylinder(start, end, radius, mass=0.05)


def draw() -> Drawing:
    """The linkage with every joint at zero."""
    robot = Drawing(
        "bennett",
        materials={"ground": (0.3, 0.3, 0.33, 1.0), "driven": (0.8, 0.35, 0.15, 1.0), "bar": (0.45, 0.55, 0.7, 1.0)},
        metadata={"description": "Bennett's spatial linkage of four revolutes", "license": "BSD-3-Clause"},
    )
    middle = midpoint(B, C)
    robot.body(
        "ground",
        None,
        Box((0.02, -0.06, 0.005), (0.2, 0.2, 0.01), mass=1.1),
        Cylinder((A[0], A[1], 0.01), A, radius=0.01, mass=0.08),
        Cylinder((D[0], D[1], 0.01), D, radius=0.01, mass=0.13),
        material="ground",
    )
    robot.body(
        "crank",
        revolute("motor_a", "ground", A, AXIS_A, motor=Motor(effort=2.0, velocity=10.0)),
        *(barrel(A, AXIS_A, radius=0.016), bar(A, B)),
        material="driven",
    )
    robot.body(
        "coupler_start",
        revolute("free_b", "crank", B, AXIS_B),
        *(barrel(B, AXIS_B), bar(B, middle)),
        material="bar",
    )
    robot.body(
        "follower",
        revolute("free_d", "ground", D, AXIS_D),
        *(barrel(D, AXIS_D), bar(D, C)),
        material="bar",
    )
    robot.body(
        "coupler_end",
        revolute("free_c", "follower", C, AXIS_C),
        *(barrel(C, AXIS_C), bar(C, middle)),
        material="bar",
    )
    robot.close("coupler", "6d", "coupler_start", "coupler_end", middle)
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
