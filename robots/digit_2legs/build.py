"""Draws Digit on its two legs. Run as ``python -m robots.digit_2legs.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Drawing, write
from robots.digit_leg.build import draw_leg, draw_torso


def draw() -> Drawing:
    """The robot with every joint at zero."""
    robot = draw_torso("digit_2legs", "Agility Robotics' Digit without arms, drawn from primitive shapes", "floating")
    draw_leg(robot, prefix="left_", ends=("ball", "universal"))
    robot.mirror("left", "right")
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
