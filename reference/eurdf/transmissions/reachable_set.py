"""The reachable set of serial joints, with what bounds it and how the transmission varies in it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import numbers
from eurdf.errors import NoTransmission
from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.blocks import checked_configurations, checked_rows
from eurdf.kinematics.named import Named
from eurdf.kinematics.position_limit import position_limits
from eurdf.loading import of_any_robot
from eurdf.pinocchio.arguments import checked_array
from eurdf.transmissions.drive import closed_pose
from eurdf.transmissions.joint_coordinates import coordinates_of
from eurdf.transmissions.motors import motors_of
from eurdf.transmissions.outline import outlines
from eurdf.transmissions.reach import Examined, Reach, Stop
from eurdf.transmissions.selection import Selection, selection
from eurdf.transmissions.transmission import Transmission, Transmissions, at_many, at_one

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Bisections of the step from a point that the joints reach to one that they do not.
_BISECTIONS = 20
# Corners of an outline are looked for until its points are this part of a cell apart.
_FINEST = 1.0 / 64.0
# Number of points of a grid, about, and along one joint, at most, where the caller does not say how fine it is.
_POINTS, _MOST_ALONG = 1681, 101


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


@dataclass(frozen=True, eq=False, repr=False)
class Workspace:
    """The positions that serial joints can reach on one branch, on a grid.

    Attributes:
        robot: The robot.
        joints: Name of each joint velocity, nJ of them.
        motors: Name of each motor velocity.
        axes: For each joint the positions on the grid, rad or m.
        index: Indices (N, nJ) on the grid of the points reached.
        positions: Positions (N, nJ) there.
        q: Configurations (N, nq) there.
    """

    robot: Robot
    joints: tuple[str, ...]
    motors: tuple[str, ...]
    axes: tuple[Vector, ...]
    index: Indices
    positions: Matrix
    q: Matrix
    _joints: Selection
    _motors: Selection
    _search: _Search

    @property
    def boundary(self) -> tuple[BoundaryPoint, ...]:
        """Points between neighbours on the grid of which one is reached; computed on first use.

        For two joints they are those of the outlines, with their corners.
        """
        return self._bounds[0]

    @property
    def outlines(self) -> tuple[tuple[int, ...], ...]:
        """For two joints, indices in `boundary` of the points of closed curves; else empty.

        The curves are counterclockwise around what is reached, and clockwise around holes; the one around all is first.
        """
        return self._bounds[1]

    @cached_property
    def _bounds(self) -> tuple[tuple[BoundaryPoint, ...], tuple[tuple[int, ...], ...]]:
        return self._search.outlined() if len(self.axes) == 2 else (self._search.boundary(), ())

    @property
    def units(self) -> tuple[Literal["m", "rad"], ...]:
        """Unit of the position of each joint."""
        return coordinates_of(self.robot, self._joints).units

    @property
    def selections(self) -> tuple[Selection, Selection]:
        """The joints and the motors."""
        return self._joints, self._motors

    @cached_property
    def transmissions(self) -> Transmissions:
        """The transmissions at the points reached, with G and its condition number."""
        return self.transmissions_at(self.q)

    def transmissions_at(self, q: Matrix) -> Transmissions:
        """The transmissions at other closed configurations (B, nq).

        Raises:
            ValueError: ``q`` has another shape, or is not finite.
        """
        return at_many(self.robot, self._joints, checked_configurations(self.robot, "q", q), self._motors)

    def moved(self, q: Matrix, positions: Matrix) -> Matrix:
        """Configurations (B, nq) after straight motions to positions (B, nJ) of the joints; NaN where they stop before.

        Args:
            q: Where to start (B, nq): configurations in the workspace.
            positions: Positions (B, nJ).

        Raises:
            ValueError: An argument has another shape, or is not finite.
        """
        q = checked_configurations(self.robot, "q", q)
        found = self._search.moved(q, checked_rows("positions", positions, len(self.joints)))
        return np.where(found.reached[:, None], found.q, np.nan)

    @property
    def polygon(self) -> Matrix:
        """For two joints the outline (k, 2), counterclockwise.

        Raises:
            ValueError: There are not two joints.
        """
        if not self.outlines:
            raise ValueError(f"a workspace of {len(self.joints)} joints has no polygon; it has samples")
        return np.array([self.boundary[index].position for index in self.outlines[0]])

    @property
    def stops(self) -> Mapping[Stop, int]:
        """What bounds the workspace, with the number of points of the boundary at which it does, most first."""
        counts: dict[Stop, int] = {}
        for point in self.boundary:
            counts[point.stop] = counts.get(point.stop, 0) + 1
        return dict(sorted(counts.items(), key=lambda each: -each[1]))

    def on_grid(self, values: Matrix) -> Matrix:
        """Values (N, ...) at the points reached as an array over the grid, (n₁, …, n_nJ, ...); NaN elsewhere."""
        values = np.asarray(values, dtype=np.float64)
        found = np.full((*map(len, self.axes), *values.shape[1:]), np.nan)
        found[tuple(self.index.T)] = values
        return found

    def __repr__(self) -> str:
        return f"<Workspace of {', '.join(self.joints)}: {len(self.q)} of {math.prod(map(len, self.axes))} points>"


@of_any_robot
def workspace(
    robot: Robot,
    joints: str | Iterable[str],
    q: Named | None = None,
    *,
    motors: str | Iterable[str] | None = None,
    grid: int | None = None,
    ranges: Mapping[str, Sequence[float]] | None = None,
) -> Workspace:
    """The positions that serial joints can reach, with what stops them.

    From the pose q, the joints move from each point of a grid to its neighbours, all on one branch. They stop where a
    joint of the loops, passive or a motor, would leave its limits; where det G changes its sign or a map between motors
    and joints does not exist, so that motors would not hold the joints; and where the loops do not close. The boundary
    between a point that is reached and one that is not is bisected to a millionth of a cell.

    Args:
        robot: The robot.
        joints: As in `transmission`.
        q: A pose (nq,) in the workspace; it decides on the branch. The default is the `assembled` configuration, or the
            neutral one if there is none.
        motors: As in `transmission`.
        grid: Number of points along each joint; by default 101 for one joint, 41 for two, and about 1,700 in all.
        ranges: Smallest and largest position of a joint, by name, rad or m, where its own limits do not bound it or a
            part is enough.

    Raises:
        NotClosable: The loops cannot be closed near q.
        NoTransmission: The motors do not hold the joints at q.
        ValueError: A joint is beyond its limits at q, or has none and no range; or an argument is wrong.
    """
    chosen = selection(robot, joints)
    by = motors_of(robot, chosen) if motors is None else selection(robot, motors, "motors")
    first = closed_pose(robot, q)
    coordinates = coordinates_of(robot, chosen)
    axes = _axes(robot, chosen, coordinates.read(first), grid, ranges or {})
    _require_both_ways(at_one(robot, chosen, first, by))
    reach = Reach(robot, chosen, by, first, axes)
    stop = reach.beyond_limits(first)
    if stop is not None:
        raise ValueError(f"q is beyond the {stop}; give a pose within the limits")
    start, pose = _first_node(reach, axes, coordinates.read(first), first)
    search = _Search(reach, axes)
    search.flood(start, pose)
    index = np.argwhere(search.reached)
    return Workspace(
        robot,
        chosen.names,
        by.names,
        axes,
        index,
        np.stack([axis[own] for axis, own in zip(axes, index.T, strict=True)], axis=1),
        search.q[tuple(index.T)],
        chosen,
        by,
        search,
    )


class _Search:
    """What was found on the grid.

    Attributes:
        reached: Which points of the grid are reached.
        q: Configurations (..., nq) there.
    """

    def __init__(self, reach: Reach, axes: tuple[Vector, ...]) -> None:
        self._reach, self._axes = reach, axes
        self._shape = tuple(map(len, axes))
        self.reached = np.zeros(self._shape, dtype=bool)
        self.q: Matrix = np.zeros(0)
        self._cell = np.array([(axis[-1] - axis[0]) / (len(axis) - 1) for axis in axes])

    def flood(self, start: tuple[int, ...], pose: Vector) -> None:
        """Find all points that can be reached from one."""
        self.q = np.full((*self._shape, len(pose)), np.nan)
        self.reached[start], self.q[start] = True, pose
        seen = self.reached.copy()
        wave = [start]
        while wave:
            new: dict[tuple[int, ...], tuple[int, ...]] = {}
            for node in wave:
                for other in self._around(node):
                    if self._on_grid(other) and not seen[other]:
                        new.setdefault(other, node)
            if not new:
                return
            nodes, origins = list(new), list(new.values())
            found = self._reach.examine(self.q[tuple(np.transpose(origins))], self._positions(nodes))
            wave = []
            for node, q, reached in zip(nodes, found.q, found.reached.tolist(), strict=True):
                seen[node] = True
                if reached:
                    self.reached[node], self.q[node] = True, q
                    wave.append(node)

    def moved(self, q: Matrix, positions: Matrix) -> Examined:
        """Motions from configurations (B, nq) straight to positions (B, nJ)."""
        return self._reach.examine(q, positions)

    def boundary(self) -> tuple[BoundaryPoint, ...]:
        """The points between a point that is reached and a neighbour that is not."""
        edges = [
            (node, other)
            for node in map(tuple, np.argwhere(self.reached).tolist())
            for other in self._around(node)
            if not self._is_reached(other)
        ]
        return self._crossings(edges)

    def outlined(self) -> tuple[tuple[BoundaryPoint, ...], tuple[tuple[int, ...], ...]]:
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

    def _is_reached(self, node: tuple[int, ...]) -> bool:
        return self._on_grid(node) and bool(self.reached[node])

    def _on_grid(self, node: tuple[int, ...]) -> bool:
        return all(0 <= own < n for own, n in zip(node, self._shape, strict=True))

    def _around(self, node: tuple[int, ...]) -> list[tuple[int, ...]]:
        """The neighbours of a node, also outside of the grid."""
        return [(*node[:axis], node[axis] + step, *node[axis + 1 :]) for axis in range(len(node)) for step in (-1, 1)]

    def _positions(self, nodes: Iterable[tuple[int, ...]]) -> Matrix:
        """Positions (B, nJ) of nodes, also outside of the grid."""
        first = np.array([axis[0] for axis in self._axes])
        return np.asarray(first + np.array(list(nodes)) * self._cell)

    def _crossings(self, edges: Iterable[tuple[tuple[int, ...], tuple[int, ...]]]) -> tuple[BoundaryPoint, ...]:
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
        stop = self._reach.examine(q, outer).stop
        for _ in range(_BISECTIONS):
            middle = 0.5 * (inner + outer)
            found = self._reach.examine(q, middle)
            yes = found.reached
            inner[yes], q[yes] = middle[yes], found.q[yes]
            outer[~yes], stop[~yes] = middle[~yes], found.stop[~yes]
        return [
            BoundaryPoint(position, own, self._reach.stops[which])
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
        there = self._reach.examine(q, middle)
        found: dict[tuple[int, int], BoundaryPoint] = {}
        for outwards in (True, False):
            which = np.flatnonzero(there.reached == outwards)
            if not len(which):
                continue
            far = middle[which] + (out[which] if outwards else -out[which])
            end = self._reach.examine(there.q[which] if outwards else q[which], far)
            bracketed = end.reached != outwards
            which, far = which[bracketed], far[bracketed]
            if not len(which):
                continue
            inner, outer = (middle[which], far) if outwards else (far, middle[which])
            start = there.q[which] if outwards else end.q[bracketed]
            for index, point in zip(which.tolist(), self._bisected(start, inner, outer), strict=True):
                found[id(pairs[index][0]), id(pairs[index][1])] = point
        return found


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


def _axes(
    robot: Robot, joints: Selection, start: Vector, grid: int | None, ranges: Mapping[str, Sequence[float]]
) -> tuple[Vector, ...]:
    """For each joint the positions on the grid."""
    if grid is None:
        grid = min(_MOST_ALONG, round(_POINTS ** (1.0 / len(joints))))
    if grid < 3:
        raise ValueError(f"grid is {grid}; a grid has at least 3 points along each joint")
    unknown = next((name for name in ranges if name not in joints.names), None)
    if unknown is not None:
        raise ValueError(f"ranges has '{unknown}', which is none of the joints: {', '.join(joints.names)}")
    limits = position_limits(robot)
    axes = []
    for name, velocity, own in zip(joints.names, joints.velocities.tolist(), start.tolist(), strict=True):
        lower, upper = float(limits.lower[velocity]), float(limits.upper[velocity])
        if name in ranges:
            lower, upper = checked_array(f"ranges['{name}']", ranges[name], (2,)).tolist()
        if not (math.isfinite(lower) and math.isfinite(upper)):
            raise ValueError(f"joint '{name}' has no limits; give ranges={{'{name}': (smallest, largest)}}")
        if not lower < upper:
            raise ValueError(f"the range of joint '{name}' is {lower:g} to {upper:g}; expected smallest, largest")
        if not lower <= own <= upper:
            raise ValueError(f"q has joint '{name}' at {own:.6g}, outside its range {lower:g} to {upper:g}")
        axes.append(np.linspace(lower, upper, grid))
    return tuple(axes)


def _require_both_ways(at: Transmission) -> None:
    """Refuse joints that their motors do not hold, or do not move alone."""
    if at.G is None:
        raise NoTransmission("G", at.reason or "")
    if at.B_J is None:
        raise NoTransmission("B_J", at.inverse_reason or "")


def _first_node(reach: Reach, axes: tuple[Vector, ...], start: Vector, q: Vector) -> tuple[tuple[int, ...], Vector]:
    """A point of the grid next to the start that can be reached from there, and the configuration (nq,) at it."""
    parts = [(own - axis[0]) / (axis[1] - axis[0]) for axis, own in zip(axes, start.tolist(), strict=True)]
    corners = list(product(*({math.floor(part), math.ceil(part)} for part in parts)))
    corners.sort(key=lambda corner: sum((own - part) ** 2 for own, part in zip(corner, parts, strict=True)))
    corners = [
        tuple(min(max(own, 0), len(axis) - 1) for own, axis in zip(corner, axes, strict=True)) for corner in corners
    ]
    positions = np.array([[axis[own] for axis, own in zip(axes, corner, strict=True)] for corner in corners])
    found = reach.examine(np.tile(q, (len(corners), 1)), positions)
    if not found.reached.any():
        stop = reach.stops[int(found.stop[0])]
        raise ValueError(f"no point of the grid next to q can be reached, first because of: {stop}; use a finer grid")
    index = int(found.reached.argmax())
    return corners[index], found.q[index]
