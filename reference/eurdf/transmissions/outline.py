"""The outlines of a set of points of a grid in two dimensions."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from eurdf.kinematics.array import Mask

#: A node of the grid.
Node = tuple[int, int]
#: Two neighbouring nodes, of which the first one alone is in the set; the second can be outside of the grid.
Edge = tuple[Node, Node]


def outlines(inside: Mask) -> list[list[Edge]]:
    """The closed curves around the nodes that are inside, by marching squares.

    Args:
        inside: Which nodes (m, n) of the grid are inside; those around the grid are not.

    Returns:
        Of each curve the edges that it crosses, in order; the inside is on the left where the first index is to the
        right and the second one up.
    """
    padded = np.pad(inside, 1)
    following: dict[Edge, list[Edge]] = defaultdict(list)
    for i, j in np.argwhere(_mixed(padded)).tolist():
        # Counterclockwise corners of the cell, as nodes of the grid.
        corners = [(i - 1, j - 1), (i, j - 1), (i, j), (i - 1, j)]
        within = [bool(padded[a + 1, b + 1]) for a, b in corners]
        # Counterclockwise around the cell, the curve goes out of it where nodes change from inside to outside, and
        # comes in where they change back; a part of the set in one cell is cut off by itself.
        for k in range(4):
            if within[k] and not within[(k + 1) % 4]:
                first = next(k - back for back in range(4) if not within[(k - back - 1) % 4])
                leaves = corners[k], corners[(k + 1) % 4]
                enters = corners[first % 4], corners[(first - 1) % 4]
                following[leaves].append(enters)
    curves = []
    while following:
        start = next(iter(following))
        curve, edge = [], start
        while edge in following:
            curve.append(edge)
            after = following[edge]
            edge_after = after.pop()
            if not after:
                del following[edge]
            edge = edge_after
        curves.append(curve)
    return curves


def _mixed(padded: Mask) -> Mask:
    """Cells with nodes inside and nodes outside."""
    corners = padded[:-1, :-1].astype(int) + padded[1:, :-1] + padded[:-1, 1:] + padded[1:, 1:]
    return np.asarray((corners > 0) & (corners < 4))
