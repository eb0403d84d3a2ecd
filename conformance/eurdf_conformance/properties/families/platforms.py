"""Platforms on legs of variable length, each between two joints."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.families.building import Building, along, angle, at
from eurdf_conformance.properties.placement import Matrix, quaternion_of


def with_universals(n: int) -> Example:
    """N legs UPS, each with a motor: mobility 6; the motors determine n of these."""
    return _platform(n, "universal").example(nv=3 * n + 3, rank=3 * (n - 1), uncontrolled=max(6 - n, 0))


def with_balls(n: int) -> Example:
    """N legs SPS, each with a motor: mobility 6 + n, since each leg can spin about itself."""
    return _platform(n, "spherical").example(nv=4 * n + 3, rank=3 * (n - 1), uncontrolled=max(6 - n, 0) + n)


def _platform(n: int, lower: Literal["universal", "spherical"]) -> Building:
    robot = Building(f"platform on {n} legs, {lower}")
    for i in range(n):
        # Pairs of legs lean on one another, as they must: on parallel ones the platform would be loose.
        base = np.array([math.cos(math.tau * i / n), math.sin(math.tau * i / n), 0.05 * (i % 3)])
        turn = math.tau * (i + (0.8 if i % 2 else -0.7)) / n
        tip = np.array([0.5 * math.cos(turn), 0.6 * math.sin(turn), 0.8 + 0.07 * (i % 4)])
        foot, q = _foot(base, tip, lower, i)
        length = 0.2 + 0.03 * i
        rod = foot @ at([0, 0, 0.3])
        robot.joint(lower, "ground", f"cylinder{i}", foot, q)
        robot.joint("prismatic", f"cylinder{i}", f"rod{i}", rod, (length,), motor=True)
        if i == 0:
            hold = quaternion_of(along([0.2, angle(i), 1.0]))
            robot.joint("spherical", "rod0", "platform", at(tip, foot[:3, :3] @ along([0.3, 0.1, 1.0])), hold)
        else:
            robot.close("3d", "platform", f"rod{i}", at(tip))
    return robot


def _foot(base: Matrix, tip: Matrix, lower: str, i: int) -> tuple[Matrix, tuple[float, ...]]:
    """The frame of a leg's lower half, whose z leads to its tip, and the coordinates of the joint that it is on."""
    q = (0.6, 0.0, 0.0, 0.8) if lower == "spherical" else (angle(i), angle(i + 1))
    return at(base, along(tip - base)), q
