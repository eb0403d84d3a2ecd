"""Planar linkages: all axes are parallel."""

from __future__ import annotations

import math
from typing import Literal

from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.families.building import Building, angle, at


def polygon(n: int) -> Example:
    """N links in a ring, n revolutes of which the last is in the closure, 3d: mobility n − 3."""
    return _polygon(n, "3d")


def spatial_polygon(n: int) -> Example:
    """The same ring with all n revolutes in the tree and a 6d closure: mobility n − 3, three rows redundant."""
    return _polygon(n, "6d")


def parallelograms(n: int) -> Example:
    """A coupler on n + 1 cranks, parallel and of one length: mobility 1, however many."""
    ring = Building(f"{n} parallelograms")
    lift = 0.4 * math.sin(1.1)
    ring.joint("revolute", "ground", "crank0", at([0, 0, 0]), (angle(0),), motor=True)
    ring.joint("revolute", "crank0", "coupler", at([0.2, lift, 0]), (angle(1),))
    for i in range(1, n + 1):
        x = 0.3 * i + 0.02 * i * i
        ring.joint("revolute", "ground", f"crank{i}", at([x, 0, 0]), (angle(i),))
        ring.close("3d", "coupler", f"crank{i}", at([x + 0.2, lift, 0]))
    return ring.example(nv=n + 2, rank=n + 1, uncontrolled=0)


def _polygon(n: int, kind: Literal["3d", "6d"]) -> Example:
    ring = Building(f"planar {n}-bar, closed in {kind}")
    # An irregular convex polygon, with no two sides in a line.
    corners = [
        at([(0.4 + 0.05 * math.sin(2 * i)) * math.cos(math.tau * i / n), 0.5 * math.sin(math.tau * i / n), 0])
        for i in range(n)
    ]
    before, count = "ground", n if kind == "6d" else n - 1
    for i in range(count):
        ring.joint("revolute", before, f"bar{i}", corners[i], (angle(i),), motor=i < n - 3)
        before = f"bar{i}"
    ring.close(kind, "ground", before, corners[-1])
    rank = 3 if kind == "6d" else 2
    return ring.example(nv=count, rank=rank, uncontrolled=0)
