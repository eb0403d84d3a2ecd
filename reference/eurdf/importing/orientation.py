"""Orientations from the axes of frames."""

from __future__ import annotations

import math

from eurdf.mechanism.pose import Pose, Vector3


def orientation(x: Vector3, y: Vector3, z: Vector3) -> Pose:
    """The orientation of a frame with these axes: the largest component is found first, so that none loses digits."""
    squares = (1.0 + x[0] - y[1] - z[2], 1.0 - x[0] + y[1] - z[2], 1.0 - x[0] - y[1] + z[2], 1.0 + x[0] + y[1] + z[2])
    products = {
        (0, 1): x[1] + y[0],
        (0, 2): x[2] + z[0],
        (1, 2): y[2] + z[1],
        (0, 3): y[2] - z[1],
        (1, 3): z[0] - x[2],
        (2, 3): x[1] - y[0],
    }
    largest = squares.index(max(squares))
    found = [
        squares[largest] if index == largest else products[min(index, largest), max(index, largest)]
        for index in range(4)
    ]
    norm = math.hypot(*found)
    return Pose(quaternion=(found[0] / norm, found[1] / norm, found[2] / norm, found[3] / norm))
