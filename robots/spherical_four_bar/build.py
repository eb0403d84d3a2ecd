"""Draws the spherical four-bar linkage. Run as ``python -m robots.spherical_four_bar.build [FOLDER]``."""

from __future__ import annotations

import math
import sys
from pathlib import Path

from robots.builder import Box, Cylinder, Drawing, Motor, Vector3, revolute, write

# The four pins, in m: all on the sphere of 18 cm about the origin. Through each runs an axis, and all axes meet there.
CRANK_PIVOT = (0.18, 0.0, 0.0)
CRANK_PIN = (0.16, 0.02, 0.08)
ROCKER_PIN = (0.02, -0.08, 0.16)
ROCKER_PIVOT = (0.0, -0.18, 0.0)

#: How much larger the sphere is on which the coupler runs, outside crank and rocker.
OUTSIDE = 1.1


def scaled(point: Vector3, scale: float) -> Vector3:
    """The point on the same ray from the origin, farther out."""
    return (scale * point[0], scale * point[1], scale * point[2])


def arc(start: Vector3, end: Vector3, mass: float, scale: float = 1.0) -> tuple[Cylinder, ...]:
    """A bar bent along the great circle between two pins, of straight pieces of about 5 degrees."""
    radius = math.hypot(*start)
    angle = math.acos(sum(a * b for a, b in zip(start, end, strict=True)) / radius**2)
    count = math.ceil(angle / math.radians(5.0))

    def at(part: float) -> Vector3:
        a, b = (scale * math.sin(share * angle) / math.sin(angle) for share in (1.0 - part, part))
        return (a * start[0] + b * end[0], a * start[1] + b * end[1], a * start[2] + b * end[2])

    return tuple(
        Cylinder(at(piece / count), at((piece + 1) / count), radius=0.007, mass=mass / count) for piece in range(count)
    )


def pin(at: Vector3, inner: float = 0.95, outer: float = 1.15) -> Cylinder:
    """A pin along the ray from the origin, between two multiples of the radius of the sphere."""
    return Cylinder(scaled(at, inner), scaled(at, outer), radius=0.006, mass=0.01)


def draw() -> Drawing:
    """The linkage with every joint at zero."""
    robot = Drawing(
        "spherical_four_bar",
        materials={"ground": (0.3, 0.3, 0.33, 1.0), "driven": (0.8, 0.35, 0.15, 1.0), "bar": (0.45, 0.55, 0.7, 1.0)},
        metadata={"description": "Spherical four-bar linkage, a crank and rocker", "license": "BSD-3-Clause"},
    )
    robot.body(
        "ground",
        None,
        Box((0.08, -0.08, -0.15), (0.36, 0.36, 0.02), mass=7.0),
        Box((0.24, 0.0, -0.06), (0.04, 0.05, 0.16), mass=0.9),
        Box((0.0, -0.24, -0.06), (0.05, 0.04, 0.16), mass=0.9),
        material="ground",
    )
    robot.body(
        "crank",
        revolute("motor_crank", "ground", CRANK_PIVOT, CRANK_PIVOT, motor=Motor(effort=2.0, velocity=20.0)),
        *arc(CRANK_PIVOT, CRANK_PIN, mass=0.04),
        *(pin(CRANK_PIVOT, outer=1.3), pin(CRANK_PIN)),
        material="driven",
    )
    robot.body(
        "coupler",
        revolute("free_coupler", "crank", CRANK_PIN, CRANK_PIN),
        *arc(CRANK_PIN, ROCKER_PIN, mass=0.09, scale=OUTSIDE),
        material="bar",
    )
    robot.body(
        "rocker",
        # The loop lets the rocker swing from 26.0 to 91.0 degrees above the plane of the pivots; it is drawn at 82.9.
        revolute("free_rocker", "ground", ROCKER_PIVOT, ROCKER_PIVOT, degrees=(20.0, 97.0), drawn=82.9),
        *arc(ROCKER_PIVOT, ROCKER_PIN, mass=0.08),
        *(pin(ROCKER_PIVOT, outer=1.3), pin(ROCKER_PIN)),
        material="bar",
    )
    robot.close("rocker_pin", "3d", "coupler", "rocker", ROCKER_PIN)
    return robot


if __name__ == "__main__":
    write(draw(), Path(sys.argv[1]) if sys.argv[1:] else Path(__file__).parent)
