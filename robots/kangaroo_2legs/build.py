"""Draws Kangaroo from the feet to the torso. Run as ``python -m robots.kangaroo_2legs.build [FOLDER]``.

World: origin at the base frame of the robot's published description, x forward, y to the left, z up; m, kg.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, write
from robots.kangaroo_leg.build import MATERIALS, PELVIS, draw_leg


def draw() -> Drawing:
    """The robot with every joint at zero."""
    robot = Drawing(
        "kangaroo_2legs",
        materials=MATERIALS,
        metadata={
            "description": "PAL Robotics' Kangaroo, both legs and the torso without arms, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of PAL Robotics' MuJoCo description kangaroo_full.xml",
        },
        root="floating",
    )
    draw_body(robot)
    draw_leg(robot, "left_")
    robot.mirror("left", "right")
    return robot


def draw_body(robot: Drawing) -> None:
    """The pelvis, and on it, without joints, the waist and the torso."""
    waist = Cylinder((-0.092, 0.0, 0.03), (-0.092, 0.0, 0.066), radius=0.06, mass=1.249)
    belly = Box((-0.101, 0.0, 0.137), (0.16, 0.18, 0.16), mass=3.0)
    chest = Box((-0.101, 0.0, 0.333), (0.21, 0.29, 0.3), mass=11.116)
    robot.body("pelvis", None, *PELVIS, waist, belly, chest, material="shell", contacts=(*PELVIS, belly, chest))


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
