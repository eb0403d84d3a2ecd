"""Position limits of joints, as kinematics respects them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.mechanism.joint import LIMIT_TOLERANCE, is_no_range

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, repr=False)
class JointAtLimit:
    """A joint whose coordinate is at one of its limits.

    Attributes:
        joint: Name of the joint.
        limit: The limit, rad or m.
        side: Whether it is the lower or the upper limit.
    """

    joint: str
    limit: float
    side: Literal["lower", "upper"]

    def __str__(self) -> str:
        return f"'{self.joint}' ({self.side} limit {self.limit:.6g})"

    def __repr__(self) -> str:
        return f"<JointAtLimit: {self} rad or m>"


@dataclass(frozen=True, eq=False)
class PositionLimits:
    """Limits of the coordinates that are angles or lengths, by the velocity that drives them.

    Quaternions, (cos, sin) pairs and mimic joints have no limits here.

    Attributes:
        joints: For each velocity (nv) the name of its joint.
        coordinates: Index (nv,) in q of the coordinate that each velocity drives; 0 if there is none.
        lower: Lower limits (nv,), rad or m; -inf if there is none.
        upper: Upper limits (nv,); inf if there is none.
    """

    joints: tuple[str, ...]
    coordinates: Indices
    lower: Vector
    upper: Vector

    @cached_property
    def _bounded(self) -> Mask:
        """Which velocities (nv,) have a limit."""
        return np.isfinite(self.lower) | np.isfinite(self.upper)

    @cached_property
    def _of_bounded(self) -> tuple[Indices, Vector, Vector]:
        """The coordinates that have a limit, and their limits."""
        return self._limits_of(np.flatnonzero(self._bounded))

    def _limits_of(self, bounded: Indices) -> tuple[Indices, Vector, Vector]:
        return self.coordinates[bounded], self.lower[bounded], self.upper[bounded]

    def clip(self, q: Matrix, velocities: Indices | None = None) -> Matrix:
        """Configurations (…, nq) with the coordinates that the given velocities, all if None, drive within limits."""
        within = np.array(q)
        coordinates, lower, upper = (
            self._of_bounded if velocities is None else self._limits_of(velocities[self._bounded[velocities]])
        )
        within[..., coordinates] = np.minimum(np.maximum(q[..., coordinates], lower), upper)
        return within

    def room(self, q: Matrix, velocities: Indices | slice = slice(None)) -> tuple[Matrix, Matrix]:
        """Distances from q (…, nq) to the lower limits (at most 0) and to the upper ones (at least 0), by velocity."""
        at = q[..., self.coordinates[velocities]]
        return np.minimum(self.lower[velocities] - at, 0.0), np.maximum(self.upper[velocities] - at, 0.0)

    def are_exceeded(self, q: Matrix) -> bool:
        """Whether a coordinate of q (B, nq) is outside of its limits."""
        coordinates, lower, upper = self._of_bounded
        at = q[:, coordinates]
        return bool(np.count_nonzero((at < lower) | (at > upper)))

    def are_kept(self, q: Matrix) -> Mask:
        """Whether (B,) every coordinate of q (B, nq) is within its limits."""
        coordinates, lower, upper = self._of_bounded
        at = q[:, coordinates]
        return np.asarray(np.logical_and.reduce((at >= lower) & (at <= upper), axis=1))

    def excess(self, q: Matrix) -> Matrix:
        """How far q (…, nq) is beyond the lower, then beyond the upper limits (…, 2 nv); negative within them."""
        at = q[..., self.coordinates]
        return np.concatenate((self.lower - at, at - self.upper), axis=-1)

    def pressed(self, q: Vector, v: Vector) -> tuple[JointAtLimit, ...]:
        """The joints that are within 1e-9 of a limit at q, and that v (nv,) would move beyond it."""
        at, least = q[self.coordinates], 1e-6 * float(np.abs(v).max(initial=0.0))
        low = (at - self.lower <= LIMIT_TOLERANCE) & (v < -least)
        high = (self.upper - at <= LIMIT_TOLERANCE) & (v > least)
        found = [self._at(index, "lower") for index in np.flatnonzero(low).tolist()]
        return (*found, *(self._at(index, "upper") for index in np.flatnonzero(high).tolist()))

    def _at(self, velocity: int, side: Literal["lower", "upper"]) -> JointAtLimit:
        limit = (self.lower if side == "lower" else self.upper)[velocity]
        return JointAtLimit(self.joints[velocity], float(limit), side)


def position_limits(robot: Robot) -> PositionLimits:
    """Position limits of a robot, as its model has them now; those that are both 0 are none, as in `Joint.ranges`."""
    lowest, highest = robot.tree.position_limits
    # They are kept as long as the model has the same ones.
    stated = lowest.tobytes() + highest.tobytes()
    kept: tuple[bytes, PositionLimits] | None = robot.derived.get(position_limits)
    if kept is not None and kept[0] == stated:
        return kept[1]
    driven, coordinates = robot.cached(driven_coordinates)
    lower, upper = np.full(robot.tree.nv, -np.inf), np.full(robot.tree.nv, np.inf)
    lower[driven], upper[driven] = lowest[coordinates[driven]], highest[coordinates[driven]]
    none = list(map(is_no_range, lower.tolist(), upper.tolist()))
    lower[none], upper[none] = -np.inf, np.inf
    limits = PositionLimits(tuple(robot.tree.velocity_names), coordinates, lower, upper)
    robot.derived[position_limits] = stated, limits
    return limits


def chosen_limits(robot: Robot, limits: bool) -> PositionLimits | None:
    """The position limits of a robot to respect, or None.

    Raises:
        ValueError: ``limits`` is not True or False.
    """
    if not isinstance(limits, (bool, np.bool_)):
        raise ValueError(f"limits is {limits!r}; use True or False")
    return position_limits(robot) if limits else None


def driven_coordinates(robot: Robot) -> tuple[Indices, Indices]:
    """The velocities that drive one coordinate each, and for each velocity (nv,) that coordinate; 0 if it has none."""
    coordinates = np.zeros(robot.tree.nv, dtype=np.intp)
    driven: list[int] = []
    for q, v in zip(robot.tree.own_coordinates, robot.tree.own_velocities, strict=True):
        if len(q) == len(v):
            coordinates[v.start : v.stop] = q
            driven.extend(v)
    return np.array(driven, dtype=np.intp), coordinates
