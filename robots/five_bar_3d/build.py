"""Draws the five-bar linkage with a hinge across a forearm. Run as ``python -m robots.five_bar_3d.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Cylinder, Drawing, revolute, write
from robots.five_bar.build import (
    BAR,
    ELBOWS,
    FOREARM_PLANES,
    RISE,
    TIP,
    bar,
    draw_arms,
    drawing,
    elbow,
    forearm,
    tool,
)

# The hinge is on forearm 1, 18 cm from the tip. Its axis lies in the plane of the linkage, across the bar.
ACROSS_BAR = (RISE / BAR, 0.0, -0.2788 / BAR)
HINGE = (TIP[0] - 0.2788 * 0.18 / BAR, 0.0, TIP[2] - RISE * 0.18 / BAR)


def draw() -> Drawing:
    """The linkage with every joint at zero."""
    robot = drawing("five_bar_3d", "Five-bar linkage, isostatic with a hinge across one forearm and a 3d closure")
    draw_arms(robot)
    robot.body("forearm_1", elbow(1), bar(ELBOWS[1], HINGE, FOREARM_PLANES[1]), material="bar")
    robot.body(
        "hand_1",
        revolute("free_hinge", "forearm_1", HINGE, ACROSS_BAR, degrees=(-20.0, 20.0)),
        *(knuckles(), bar(HINGE, TIP, FOREARM_PLANES[1])),
        material="bar",
    )
    robot.body("forearm_2", elbow(2), *(forearm(2), *tool()), material="bar")
    robot.close("tip", "3d", "hand_1", "forearm_2", TIP)
    return robot


def knuckles() -> Cylinder:
    """The knuckles of the hinge."""
    start, end = (
        (HINGE[0] + side * ACROSS_BAR[0], HINGE[1], HINGE[2] + side * ACROSS_BAR[2]) for side in (-0.025, 0.025)
    )
    return Cylinder(start, end, radius=0.015, mass=0.06)


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
