"""Logarithms of rotations and of poses, and their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

Vector = npt.NDArray[np.float64]
Matrix = npt.NDArray[np.float64]


def log3(rotation: Matrix) -> Vector:
    """The rotation vector (3,) of a rotation (3, 3), rad."""
    return np.asarray(pin.log3(rotation))


def log3_derivative(rotation: Matrix) -> Matrix:
    """The derivative (3, 3) of `log3` by the angular velocity in the axes of the rotated frame."""
    return np.asarray(pin.Jlog3(rotation))


def log6(placements: Sequence[Any]) -> Matrix:
    """The logarithms (k, 6) of poses, `pin.SE3`: linear, m, and angular, rad."""
    return np.array([pin.log6(placement).vector for placement in placements])


def log6_derivative(placements: Sequence[Any]) -> Matrix:
    """The derivatives (k, 6, 6) of `log6` by the twists in the axes of the moved frames."""
    return np.array([pin.Jlog6(placement) for placement in placements])
