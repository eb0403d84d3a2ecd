"""Draws an offset slider-crank, as in a small press. Run as ``python -m robots.slider_crank.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, prismatic, revolute, write

# The three pins, in the plane y = 0, in m: crank 5 cm (4, 3), rod 13 cm (12, -5). The slide runs along x, 2 cm below
# the pivot of the crank.
CRANK_PIVOT = (0.0, 0.0, 0.0)
CRANK_PIN = (0.04, 0.0, 0.03)
SLIDER_PIN = (0.16, 0.0, -0.02)

ACROSS = (0.0, 1.0, 0.0)
ALONG = (1.0, 0.0, 0.0)

#: Plane of the rod, beside that of crank and slider, m.
BESIDE = -0.02


def pin(at: Vector3) -> Cylinder:
    """A pin from the plane of crank and slider to that of the rod."""
    return Cylinder(at, (at[0], BESIDE, at[2]), radius=0.004, mass=0.01)


def draw() -> Drawing:
    """The mechanism with every joint at zero."""
    robot = Drawing(
        "slider_crank",
        materials={"ground": (0.3, 0.3, 0.33, 1.0), "driven": (0.8, 0.35, 0.15, 1.0), "bar": (0.45, 0.55, 0.7, 1.0)},
        metadata={"description": "Planar slider-crank, its slide offset from the crank", "license": "BSD-3-Clause"},
    )
    robot.body(
        "ground",
        None,
        Box((0.09, 0.01, -0.09), (0.30, 0.08, 0.02), mass=1.3),
        Box((0.0, 0.025, -0.035), (0.04, 0.03, 0.09), mass=0.3),
        Box((0.135, 0.0, -0.0575), (0.16, 0.024, 0.045), mass=0.47),
        material="ground",
    )
    robot.body(
        "crank",
        revolute("motor_crank", "ground", CRANK_PIVOT, ACROSS, motor=Motor(effort=2.0, velocity=20.0)),
        Cylinder((0.0, -0.005, 0.0), (0.0, 0.005, 0.0), radius=0.055, mass=0.26),
        Cylinder((0.0, 0.005, 0.0), (0.0, 0.04, 0.0), radius=0.008, mass=0.02),
        pin(CRANK_PIN),
        material="driven",
    )
    robot.body(
        "rod",
        revolute("free_rod", "crank", CRANK_PIN, ACROSS),
        Cylinder((CRANK_PIN[0], BESIDE, CRANK_PIN[2]), (SLIDER_PIN[0], BESIDE, SLIDER_PIN[2]), radius=0.006, mass=0.04),
        material="bar",
    )
    robot.body(
        "slider",
        # The loop lets the slider be 77.5 to 178.9 mm from the pivot of the crank, measured along the slide.
        prismatic("free_slider", "ground", SLIDER_PIN, ALONG, metres=(0.074, 0.182), drawn=0.16),
        Box(SLIDER_PIN, (0.04, 0.024, 0.03), mass=0.2),
        pin(SLIDER_PIN),
        material="bar",
    )
    robot.close("slider_pin", "3d", "rod", "slider", SLIDER_PIN)
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
