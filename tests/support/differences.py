"""Derivatives by differences of the sixth order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np


def slope(f: Callable[[float], Any], step: float) -> Any:
    """The derivative of f at 0."""
    one, two, three = (f(k * step) - f(-k * step) for k in (1, 2, 3))
    return (45.0 * one - 9.0 * two + three) / (60.0 * step)


def near(found: Any, expected: Any, tolerance: float = 1e-10) -> None:
    """Equal but for the tolerance, relative to the largest entry, or to 1e-6 if all are smaller."""
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=tolerance * max(1e-6, np.abs(expected).max(initial=0.0)))


def near_slope(found: Any, f: Callable[[float], Any], steps: Sequence[float], tolerance: float = 1e-10) -> None:
    """Equal to the derivative of f at 0 by differences with one of the steps: what is wrong equals none of them."""
    slopes = [slope(f, step) for step in steps]
    near(found, min(slopes, key=lambda each: float(np.abs(found - each).max(initial=0.0))), tolerance)
