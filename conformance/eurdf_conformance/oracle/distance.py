"""The residual of a distance and its derivative: chapter Closures, EU-CLO-015 and EU-CLO-010.

With p the origin of B in A: r = |p| − length, ṙ = u · ṗ with u = p / |p|.
"""

from __future__ import annotations

import numpy as np

from eurdf_conformance.oracle.kinematics import Kinematics
from eurdf_conformance.oracle.spatial import Array, skew
from eurdf_conformance.oracle.tree import Placed


def residual(at: Kinematics, a: Placed, b: Placed, length: float) -> Array:
    """By how much the origins of A and B are farther apart than the length; m."""
    return np.array([np.linalg.norm(at.pose(b)[:3, 3] - at.pose(a)[:3, 3]) - length])


def derivative(aMb: Array) -> Array:
    """D (1, 6), with ṙ = D ξ for the twist ξ of B relative to A, seen from A; p is not zero."""
    p = aMb[:3, 3]
    u = p / np.linalg.norm(p)
    return (u @ np.hstack([np.eye(3), -skew(p)]))[None, :]
