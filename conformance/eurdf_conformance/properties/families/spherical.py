"""Linkages whose axes all meet in one point, and rings of spherical joints."""

from __future__ import annotations

import math

import numpy as np

from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.families.building import Building, along, angle, at
from eurdf_conformance.properties.placement import quaternion_of


def polygon(n: int) -> Example:
    """N links in a ring, n revolutes through one point: mobility n − 3, three rows redundant."""
    ring = Building(f"spherical {n}-bar")
    before = "ground"
    for i in range(n):
        turn = math.tau * i / n
        axis = [math.cos(turn), (0.7 + 0.1 * math.sin(2 * i)) * math.sin(turn), 1.0]
        M = at([0.02 * i * a for a in axis], along(axis))  # somewhere on the axis
        ring.joint("revolute", before, f"bar{i}", M, (angle(i),), motor=i < n - 3)
        before = f"bar{i}"
    ring.close("6d", "ground", before, at([0.1, 0.2, 0.3]))
    return ring.example(nv=n, rank=3, uncontrolled=0)


def balls(n: int) -> Example:
    """N links in a ring, n spherical joints, the last one a 3d closure: mobility 3 n − 6, with the spin of each rod."""
    ring = Building(f"ring of {n} balls")
    before = "ground"
    for i in range(n):
        turn = math.tau * i / n
        M = at([0.5 * math.cos(turn), 0.4 * math.sin(turn), 0.1 * math.sin(2.3 * i)])
        if i == n - 1:
            ring.close("3d", before, "ground", M)
            break
        ring.joint("spherical", before, f"rod{i}", M, quaternion_of(along([1.0, angle(i), 0.5])))
        before = f"rod{i}"
    return ring.example(nv=3 * (n - 1), rank=3, uncontrolled=3 * n - 6)


def ball_chain(n: int) -> Example:
    """N spherical joints in a row, without closures: mobility 3 n."""
    chain = Building(f"chain of {n} balls")
    before = "ground"
    for i in range(n):
        q = quaternion_of(along([angle(i), 1.0, 0.3]))
        chain.joint("spherical", before, f"rod{i}", at(np.array([0.2, 0.1, 0.05]) * i), q)
        before = f"rod{i}"
    return chain.example(nv=3 * n, rank=0, uncontrolled=3 * n)
