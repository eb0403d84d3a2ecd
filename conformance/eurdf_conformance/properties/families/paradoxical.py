"""Loops that move although counting links and joints predicts that they cannot."""

from __future__ import annotations

import math

import numpy as np

from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.families.building import Building, along, angle, at
from eurdf_conformance.properties.placement import Matrix


def sarrus(n: int) -> Example:
    """Two legs of n + 1 parallel hinges each, square to each other: mobility 2 n − 3, and one row redundant.

    Each leg moves in its plane; the platform, which moves in both, can only rise along the line in which they meet.
    """
    ring = Building(f"Sarrus linkage with legs of {n + 1} hinges")
    height, before = 0.6, "ground"
    for leg, axis in enumerate(([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])):
        order = range(n + 1) if leg == 0 else range(n, -1, -1)
        for i in order:
            out = -0.5 - 0.2 * math.sin(math.pi * i / n) * (1 + 0.3 * i)
            z = height * i / n
            p = [0.0, out, z] if leg == 0 else [out, 0.0, z]
            ring.joint("revolute", before, f"plate{leg}{i}", at(p, along(axis)), (angle(i),))
            before = f"plate{leg}{i}"
    ring.close("6d", "ground", before, at([0.1, 0.2, 0.0]))
    nv = 2 * (n + 1)
    return ring.example(nv=nv, rank=5, uncontrolled=nv - 5)


def bennett(n: int) -> Example:
    """Four skew hinges (Bennett, 1903), with opposite sides alike, sines of twists as their lengths: mobility 1.

    Args:
        n: Three degrees times this is the twist of the shorter pair of sides; no more than 12, for the longer one has
            to twist by more.
    """
    ring = Building(f"Bennett linkage, twisted by {3 * n} degrees")
    alpha, a, b = math.radians(3 * n), 0.3, 0.5
    beta = math.asin(b / a * math.sin(alpha))
    first = 1.0
    second = 2.0 * math.atan(math.sin((beta + alpha) / 2) / math.sin((beta - alpha) / 2) / math.tan(first / 2))
    M, before = np.eye(4), "ground"
    for i, (turn, length, twist) in enumerate(
        zip((first, second, -first, -second), (a, b, a, b), (alpha, beta, alpha, beta), strict=True)
    ):
        ring.joint("revolute", before, f"bar{i}", M, (angle(i),), motor=i == 0)
        before = f"bar{i}"
        M = M @ _side(turn, length, twist)
    ring.close("6d", "ground", before, M)
    return ring.example(nv=4, rank=3, uncontrolled=0)


def _side(turn: float, length: float, twist: float) -> Matrix:
    """From one hinge to the next (Denavit and Hartenberg): turn about z, go along x, twist about x."""
    c, s, ct, st = math.cos(turn), math.sin(turn), math.cos(twist), math.sin(twist)
    return np.array([[c, -s * ct, s * st, length * c], [s, c * ct, -c * st, length * s], [0, st, ct, 0], [0, 0, 0, 1]])
