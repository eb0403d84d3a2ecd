"""Draws the five-bar linkage with a ball at its tip. Run as ``python -m robots.five_bar_6d.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Drawing, Sphere, ball, universal, write
from robots.five_bar.build import ELBOWS, INWARD, RISE, TIP, draw_arms, drawing, elbow, forearm, tool

#: Across forearm 1, in the plane of the linkage; any length.
ACROSS_BAR = (RISE, 0.0, -0.2788)


def draw() -> Drawing:
    """The linkage with every joint at zero."""
    robot = drawing("five_bar_6d", "Five-bar linkage, isostatic with a universal elbow, a ball and a 6d closure")
    draw_arms(robot)
    cross = universal("cardan_elbow_1", "arm_1", ELBOWS[1], INWARD[1], ACROSS_BAR)
    robot.body(
        "forearm_1",
        cross,
        *(forearm(1), Sphere(ELBOWS[1], 0.018, mass=0.05), Sphere(TIP, 0.018, mass=0.05)),
        material="bar",
    )
    robot.body("forearm_2", elbow(2), forearm(2), material="bar")
    robot.body("tool", ball("ball_tip", "forearm_1", TIP), *tool(), material="tool")
    robot.close("tip", "6d", "tool", "forearm_2", TIP)
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
