"""The reachable set of serial joints, with what bounds it and how the transmission varies in it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.kinematics.blocks import checked_configurations, checked_rows
from eurdf.kinematics.named import Named
from eurdf.kinematics.position_limit import position_limits
from eurdf.loading import of_any_robot
from eurdf.pinocchio.arguments import checked_array
from eurdf.transmissions.drive import closed_pose
from eurdf.transmissions.grid_search import BoundaryPoint, GridSearch
from eurdf.transmissions.motors import sides
from eurdf.transmissions.reach import Reach, Stop
from eurdf.transmissions.selection import Selection
from eurdf.transmissions.transmission import Transmissions, at_many, at_one, require

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Number of points of a grid, about, and along one joint, at most, where the caller does not say how fine it is.
_POINTS, _MOST_ALONG = 1681, 101


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
        first: The pose (nq,) that was given, closed.
        selections: The joints and the motors.
    """

    robot: Robot
    joints: tuple[str, ...]
    motors: tuple[str, ...]
    axes: tuple[Vector, ...]
    index: Indices
    positions: Matrix
    q: Matrix
    first: Vector
    selections: tuple[Selection, Selection]
    _search: GridSearch

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
        return self.selections[0].units

    @cached_property
    def transmissions(self) -> Transmissions:
        """The transmissions at the points reached, with G and its condition number."""
        return self.transmissions_at(self.q)

    def transmissions_at(self, q: Matrix) -> Transmissions:
        """The transmissions at other closed configurations (B, nq).

        Raises:
            ValueError: ``q`` has another shape, or is not finite.
        """
        joints, motors = self.selections
        return at_many(self.robot, joints, checked_configurations(self.robot, "q", q), motors)

    def moved(self, q: Matrix, positions: Matrix) -> Matrix:
        """Configurations (B, nq) after straight motions to positions (B, nJ) of the joints; NaN where they stop before.

        Args:
            q: Where to start (B, nq): configurations in the workspace.
            positions: Positions (B, nJ).

        Raises:
            ValueError: An argument has another shape, or is not finite.
        """
        q = checked_configurations(self.robot, "q", q)
        found = self._search.reach.examine(q, checked_rows("positions", positions, len(self.joints)))
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
        return dict(Counter(point.stop for point in self.boundary).most_common())

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
    chosen, by = sides(robot, joints, motors)
    first = closed_pose(robot, q)
    axes = grid_axes(robot, chosen, chosen.read(first), grid, ranges or {})
    require(at_one(robot, chosen, first, by), "G", "B_J")
    reach = Reach(robot, chosen, by, first, axes)
    stop = reach.beyond_limits(first)
    if stop is not None:
        raise ValueError(f"q is beyond the {stop}; give a pose within the limits")
    start, pose = _first_node(reach, axes, chosen.read(first), first)
    search = GridSearch(reach, axes)
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
        first,
        (chosen, by),
        search,
    )


def points_along(joints: int, points: int, most: int) -> int:
    """Number of points of a grid along each joint: about so many points in all, and at most so many along one."""
    along: int = round(points ** (1.0 / joints))
    return min(most, along)


def grid_axes(
    robot: Robot, joints: Selection, start: Vector, grid: int | None, ranges: Mapping[str, Sequence[float]]
) -> tuple[Vector, ...]:
    """For each joint the positions on the grid; the error is that of `workspace`."""
    grid = points_along(len(joints), _POINTS, _MOST_ALONG) if grid is None else grid
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
