"""The points of a grid that serial joints can reach from one of them, and the boundary of these points."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from eurdf.array import Mask, Matrix, Vector, numbers
from eurdf.transmissions.reach import Reach, Stop

# Bisections of the step from a point that the joints reach to one that they do not.
_BISECTIONS = 20
# Corners of an outline are looked for until its points are this part of a cell apart.
_FINEST = 1.0 / 64.0

#: A node of the grid.
Node = tuple[int, ...]
#: Two neighbouring nodes, of which the first one alone is in the set; the second can be outside of the grid.
Edge = tuple[Node, Node]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class BoundaryPoint:
    """A point at which the joints stop.

    Attributes:
        position: Positions (nJ,) of the joints, rad or m.
        q: The configuration (nq,).
        stop: What stops them.
    """

    position: Vector
    q: Vector
    stop: Stop

    def __repr__(self) -> str:
        return f"<BoundaryPoint {numbers(self.position)} rad or m: {self.stop}>"


class GridSearch:
    """What was found on the grid.

    Attributes:
        reach: Moves the joints.
        reached: Which points of the grid are reached.
        q: Configurations (..., nq) there.
    """

    def __init__(self, reach: Reach, axes: tuple[Vector, ...]) -> None:
        self.reach, self._axes = reach, axes
        self._shape = tuple(map(len, axes))
        self.reached = np.zeros(self._shape, dtype=bool)
        self.q: Matrix = np.zeros(0)
        self._cell = np.array([(axis[-1] - axis[0]) / (len(axis) - 1) for axis in axes])

    def flood(self, start: Node, pose: Vector) -> None:
        """Find all points that can be reached from one."""
        self.q = np.full((*self._shape, len(pose)), np.nan)
        self.reached[start], self.q[start] = True, pose
        seen = self.reached.copy()
        wave = [start]
        while wave:
            new: dict[Node, Node] = {}
            for node in wave:
                for other in self._around(node):
                    if self._on_grid(other) and not seen[other]:
                        new.setdefault(other, node)
            if not new:
                return
            nodes, origins = list(new), list(new.values())
            found = self.reach.examine(self.q[tuple(np.transpose(origins))], self._positions(nodes))
            wave = []
            for node, q, reached in zip(nodes, found.q, found.reached.tolist(), strict=True):
                seen[node] = True
                if reached:
                    self.reached[node], self.q[node] = True, q
                    wave.append(node)

    def boundary(self) -> tuple[BoundaryPoint, ...]:
        """The points between a point that is reached and a neighbour that is not."""
        edges = [
            (node, other)
            for node in map(tuple, np.argwhere(self.reached).tolist())
            for other in self._around(node)
            if not self._is_reached(other)
        ]
        return self._crossings(edges)

    def outlined(self) -> tuple[tuple[BoundaryPoint, ...], tuple[Node, ...]]:
        """The boundary in two dimensions, and the curves that it consists of."""
        points: list[BoundaryPoint] = []
        curves = []
        for edges in outlines(self.reached):
            curve = self._with_corners(_distinct(self._crossings(edges)))
            curves.append(tuple(range(len(points), len(points) + len(curve))))
            points += curve
        positions = np.array([point.position for point in points])
        curves.sort(key=lambda curve: -_area(positions[list(curve)]))
        return tuple(points), tuple(curves)

    def _is_reached(self, node: Node) -> bool:
        return self._on_grid(node) and bool(self.reached[node])

    def _on_grid(self, node: Node) -> bool:
        return all(0 <= own < n for own, n in zip(node, self._shape, strict=True))

    def _around(self, node: Node) -> list[Node]:
        """The neighbours of a node, also outside of the grid."""
        return [(*node[:axis], node[axis] + step, *node[axis + 1 :]) for axis in range(len(node)) for step in (-1, 1)]

    def _positions(self, nodes: Iterable[Node]) -> Matrix:
        """Positions (B, nJ) of nodes, also outside of the grid."""
        first = np.array([axis[0] for axis in self._axes])
        return np.asarray(first + np.array(list(nodes)) * self._cell)

    def _crossings(self, edges: Iterable[Edge]) -> tuple[BoundaryPoint, ...]:
        """Where the joints stop on the way from the first node of each edge to the second."""
        edges = list(edges)
        if not edges:
            return ()
        inner, outer = [edge[0] for edge in edges], [edge[1] for edge in edges]
        q = self.q[tuple(np.transpose(inner))]
        return tuple(self._bisected(q, self._positions(inner), self._positions(outer)))

    def _bisected(self, q: Matrix, inner: Matrix, outer: Matrix) -> list[BoundaryPoint]:
        """Where the joints stop between positions (B, nJ) that they reach at q (B, nq), and others."""
        inner, q, outer = inner.copy(), q.copy(), outer.copy()
        stop = self.reach.examine(q, outer).stop
        for _ in range(_BISECTIONS):
            middle = 0.5 * (inner + outer)
            found = self.reach.examine(q, middle)
            yes = found.reached
            inner[yes], q[yes] = middle[yes], found.q[yes]
            outer[~yes], stop[~yes] = middle[~yes], found.stop[~yes]
        return [
            BoundaryPoint(position, own, self.reach.stops[which])
            for position, own, which in zip(inner, q, stop.tolist(), strict=True)
        ]

    def _with_corners(self, curve: list[BoundaryPoint]) -> list[BoundaryPoint]:
        """The curve with points near its corners, where one stop follows on another."""
        part = 1.0
        while part > _FINEST:
            part *= 0.5
            pairs = [
                (a, b)
                for a, b in pairwise([*curve, curve[0]])
                if a.stop != b.stop and np.abs((b.position - a.position) / self._cell).max() > _FINEST
            ]
            if not pairs:
                break
            between = self._between(pairs)
            longer: list[BoundaryPoint] = []
            for a, b in pairwise([*curve, curve[0]]):
                longer.append(a)
                added = between.get((id(a), id(b)))
                if added is not None:
                    longer.append(added)
            curve = longer
        return curve

    def _between(self, pairs: list[tuple[BoundaryPoint, BoundaryPoint]]) -> dict[tuple[int, int], BoundaryPoint]:
        """For points of an outline that follow on each other, a point of it between them."""
        a, b = np.array([one.position for one, _ in pairs]), np.array([other.position for _, other in pairs])
        q = np.array([one.q for one, _ in pairs])
        middle, along = 0.5 * (a + b), (b - a) / self._cell
        out = np.stack((along[:, 1], -along[:, 0]), axis=1) * self._cell  # the inside is on the left
        there = self.reach.examine(q, middle)
        found: dict[tuple[int, int], BoundaryPoint] = {}
        for outwards in (True, False):
            which = np.flatnonzero(there.reached == outwards)
            if not len(which):
                continue
            far = middle[which] + (out[which] if outwards else -out[which])
            end = self.reach.examine(there.q[which] if outwards else q[which], far)
            bracketed = end.reached != outwards
            which, far = which[bracketed], far[bracketed]
            if not len(which):
                continue
            inner, outer = (middle[which], far) if outwards else (far, middle[which])
            start = there.q[which] if outwards else end.q[bracketed]
            for index, point in zip(which.tolist(), self._bisected(start, inner, outer), strict=True):
                found[id(pairs[index][0]), id(pairs[index][1])] = point
        return found


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


def _distinct(points: Iterable[BoundaryPoint]) -> list[BoundaryPoint]:
    """The points of a closed curve, without those at the place of the one before."""
    found: list[BoundaryPoint] = []
    for point in points:
        if not found or np.abs(point.position - found[-1].position).max() > 1e-9:
            found.append(point)
    return found


def _area(curve: Matrix) -> float:
    """The area inside a closed curve (k, 2), negative if it is clockwise."""
    x, y = curve.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
