"""Draws the four-bar linkage: a planar crank and rocker. Run as ``python -m robots.four_bar.build [FOLDER]``."""

from __future__ import annotations

import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, revolute, write

# The four pins, in the plane y = 0, in m. Every bar is a whole number of centimetres long:
# crank 10 (6, 8), coupler 34 (30, 16), rocker 25 (-7, 24), ground 43.
CRANK_PIVOT = (0.0, 0.0, 0.0)
CRANK_PIN = (0.06, 0.0, 0.08)
ROCKER_PIN = (0.36, 0.0, 0.24)
ROCKER_PIVOT = (0.43, 0.0, 0.0)

ACROSS = (0.0, 1.0, 0.0)

#: Plane of the coupler, beside that of crank and rocker, m.
BESIDE = 0.02


def bar(start: Vector3, end: Vector3, mass: float, y: float = 0.0) -> Cylinder:
    """A round bar between two pins, in the plane ``y`` (m)."""
    return Cylinder((start[0], y, start[2]), (end[0], y, end[2]), radius=0.008, mass=mass)


def pin(at: Vector3) -> Cylinder:
    """A pin from the plane of crank and rocker to that of the coupler."""
    return Cylinder((at[0], 0.0, at[2]), (at[0], BESIDE, at[2]), radius=0.005, mass=0.01)


def draw() -> Drawing:
    """The linkage with every joint at zero."""
    robot = Drawing(
        "four_bar",
        materials={"ground": (0.3, 0.3, 0.33, 1.0), "driven": (0.8, 0.35, 0.15, 1.0), "bar": (0.45, 0.55, 0.7, 1.0)},
        metadata={"description": "Planar four-bar linkage, a crank and rocker", "license": "BSD-3-Clause"},
    )
    robot.body("ground", None, Box((0.215, 0.0, -0.02), (0.47, 0.04, 0.02), mass=1.0), material="ground")
    robot.body(
        "crank",
        revolute("motor_crank", "ground", CRANK_PIVOT, ACROSS, motor=Motor(effort=2.0, velocity=20.0)),
        bar(CRANK_PIVOT, CRANK_PIN, mass=0.06),
        pin(CRANK_PIN),
        material="driven",
    )
    robot.body(
        "coupler",
        revolute("free_coupler", "crank", CRANK_PIN, ACROSS),
        bar(CRANK_PIN, ROCKER_PIN, mass=0.18, y=BESIDE),
        material="bar",
    )
    robot.body(
        "rocker",
        # The loop lets the rocker swing from 28.0 to 75.5 degrees above the ground; it is drawn at 73.7.
        revolute("free_rocker", "ground", ROCKER_PIVOT, ACROSS, degrees=(20.0, 80.0), drawn=73.7),
        bar(ROCKER_PIVOT, ROCKER_PIN, mass=0.14),
        pin(ROCKER_PIN),
        material="bar",
    )
    robot.close("rocker_pin", "3d", "coupler", "rocker", ROCKER_PIN)
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
