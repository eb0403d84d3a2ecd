"""Draws Cassie on its two legs. Run as ``python -m robots.cassie_2legs.build [FOLDER]``.

World and figures are those of ``cassie_leg``; the right leg is the left one mirrored in the plane y = 0.
"""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Drawing, write
from robots.cassie_leg.build import MATERIALS, SOURCE, draw_leg, draw_pelvis


def draw() -> Drawing:
    """The biped with every joint at zero."""
    robot = Drawing(
        "cassie_2legs",
        materials=MATERIALS,
        metadata={
            "description": "Agility Robotics' Cassie with its leaf springs, drawn from primitive shapes",
            "license": "BSD-3-Clause",
            "source": SOURCE,
        },
        root="floating",
    )
    draw_pelvis(robot)
    draw_leg(robot, "left_", ends=("ball", "universal"))
    robot.mirror("left", "right")
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
