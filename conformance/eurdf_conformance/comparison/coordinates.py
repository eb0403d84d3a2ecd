"""Coordinates of one joint: equality, and neutral values."""

from __future__ import annotations

import math
from collections.abc import Sequence

from eurdf_conformance.comparison.json_value import same_number

#: Number of coordinates of each type, in files and answers.
COORDINATES = {
    "revolute": 1,
    "continuous": 1,
    "prismatic": 1,
    "helical": 1,
    "cylindrical": 2,
    "universal": 2,
    "planar": 3,
    "spherical": 4,
    "floating": 7,
}

#: Number of velocities of each type; if it is smaller, the last four coordinates are a quaternion.
VELOCITIES = {**COORDINATES, "spherical": 3, "floating": 6}


def neutral(joint_type: str) -> list[float]:
    """The neutral coordinates of a type of joint: zeros, and the unit quaternion (0, 0, 0, 1)."""
    zeros = [0.0] * COORDINATES[joint_type]
    if has_quaternion(joint_type):
        zeros[-1] = 1.0
    return zeros


def has_quaternion(joint_type: str) -> bool:
    """Whether the last four coordinates are a quaternion."""
    return VELOCITIES[joint_type] < COORDINATES[joint_type]


def same_coordinates(joint_type: str, expected: Sequence[float], given: Sequence[float]) -> bool:
    """EU-CAN-005, step 5: q and −q are one rotation, and the angle of a continuous joint counts modulo 2π.

    Coordinates that are too many or too few for a joint are the same as none.
    """
    if not len(expected) == len(given) == COORDINATES[joint_type]:
        return False
    if joint_type == "continuous":
        turn = math.remainder(given[0] - expected[0], math.tau) if math.isfinite(given[0] - expected[0]) else math.inf
        return same_number(expected[0], expected[0] + turn)
    if not has_quaternion(joint_type):
        return _all_same(expected, given)
    minus = [-number for number in given[-4:]]
    return _all_same(expected[:-4], given[:-4]) and (
        _all_same(expected[-4:], given[-4:]) or _all_same(expected[-4:], minus)
    )


def _all_same(expected: Sequence[float], given: Sequence[float]) -> bool:
    return all(same_number(one, other) for one, other in zip(expected, given, strict=True))
