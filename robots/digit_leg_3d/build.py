"""Draws the left leg of Digit with whole rods. Run as ``python -m robots.digit_leg_3d.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Drawing, write
from robots.digit_leg.build import draw_leg, draw_torso


def draw() -> Drawing:
    """The leg with every joint at zero."""
    robot = draw_torso("digit_leg_3d", "Left leg of Agility Robotics' Digit, its whole rods held by 3d closures")
    draw_leg(robot, ends=("ball", "point"))
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
