"""The residual of a hinge and its derivative: chapter Closures, EU-CLO-014 and EU-CLO-010.

With a the axis in A and β = R b that in B, seen from A: s = θ n, where θ is the angle between them and n is the unit
vector of a × β. The rows are (p, Eᵀ s).
"""

from __future__ import annotations

import numpy as np

from eurdf_conformance.oracle.kinematics import Kinematics
from eurdf_conformance.oracle.spatial import Array, inverse, rotation, skew
from eurdf_conformance.oracle.tree import Placed

_Z = np.array([0.0, 0.0, 1.0])


def residual(at: Kinematics, a: Placed, b: Placed, axes: tuple[Array, ...]) -> Array:
    """The origin of B in A, m, and Eᵀ s, rad."""
    aMb = inverse(at.pose(a)) @ at.pose(b)
    n, theta = turn(axes[0], aMb[:3, :3] @ axes[1])
    return np.concatenate([aMb[:3, 3], plane(axes[0]).T @ (theta * n)])


def derivative(aMb: Array, axes: tuple[Array, ...]) -> Array:
    """D (5, 6), with ṙ = D ξ for the twist ξ of B relative to A, seen from A.

    n moves in the plane across a: s turns about a as β does. So ṡ = (n·ω) n + θ / sin θ ((β × n)·ω) a × n.
    """
    a, beta = axes[0], aMb[:3, :3] @ axes[1]
    n, theta = turn(a, beta)
    stretch = 1.0 / np.sinc(theta / np.pi)
    D = np.zeros((5, 6))
    D[:3] = np.hstack([np.eye(3), -skew(aMb[:3, 3])])
    D[3:, 3:] = plane(a).T @ (np.outer(n, n) + stretch * np.outer(np.cross(a, n), np.cross(beta, n)))
    return D


def turn(a: Array, beta: Array) -> tuple[Array, float]:
    """The unit vector about which the shortest rotation takes a to β, and its angle; parallel axes: any across a."""
    normal = np.cross(a, beta)
    sine = float(np.linalg.norm(normal))
    return (normal / sine if sine > 1e-14 else plane(a)[:, 0]), float(np.arctan2(sine, a @ beta))


def plane(a: Array) -> Array:
    """E (3, 2): the first two columns of the shortest rotation that takes z to a; of -z, of the half turn about x."""
    if np.linalg.norm(a + _Z) < 1e-9:
        return np.diag([1.0, -1.0, -1.0])[:, :2]
    normal = np.cross(_Z, a)
    sine = float(np.linalg.norm(normal))
    if sine == 0.0:
        return np.eye(3)[:, :2]
    return rotation(normal / sine, float(np.arctan2(sine, a[2])))[:, :2]
