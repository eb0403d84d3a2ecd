"""Draws Disney Research's biped with hybrid legs. Run as ``python -m robots.disney_2legs.build [FOLDER]``.

World and figures are those of ``disney_leg``; the right leg is the left one mirrored in the plane y = 0.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Drawing, write
from robots.disney_leg.build import MATERIALS, draw_leg, draw_pelvis


def draw() -> Drawing:
    """The biped with every joint at zero."""
    robot = Drawing(
        "disney_2legs",
        materials=MATERIALS,
        metadata={
            "description": "Disney Research's biped with two hybrid legs, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": "Figures of Disney Research's USD description dr_legs_no_meshes.usda",
        },
        root="floating",
    )
    draw_pelvis(robot)
    draw_leg(robot, prefix="left_")
    robot.mirror("left", "right")
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
