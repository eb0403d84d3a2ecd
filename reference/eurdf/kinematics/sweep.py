"""How far an actuator can move its mechanism, and what ends its path."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.errors import NotClosable
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.branch import Branch, BranchPoint
from eurdf.kinematics.named import Named
from eurdf.kinematics.path import Elements, follow
from eurdf.kinematics.position_limit import PositionLimits, chosen_limits
from eurdf.kinematics.rank import Numbers
from eurdf.kinematics.scale import characteristic_length
from eurdf.kinematics.tolerances import DEAD, START
from eurdf.pinocchio.arguments import checked_count

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: What ends a path: the position limit of the actuator; if it has none, half a turn, or the characteristic length if it
#: translates; the position limit of a passive joint; a dead point (singular configuration).
End = Literal["limit", "half turn", "characteristic length", "passive limit", "dead point"]

_SHORTEST_STEP = 2.0**-12  # steps are halved down to this fraction of one


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class MotionPath:
    """The path of an actuator from its start toward one of its position limits.

    Attributes:
        end: What ends the path.
        joint: The passive joint whose position limit ends the path, else None.
        reached: Coordinate of the actuator at the end, rad or m; for a continuous joint, relative to the start.
        configurations: Closed configurations (n, nq) on the path, from the start on, in equal steps of the actuator.
        residual: Largest row of their residuals, m or rad.
        correction: Largest correction that closed the loops after a step along the tangent, relative to the step.
        singularity: Smallest singular value of K_p on the path, relative to the largest one on both paths; 1 without
            loops.
    """

    end: End
    joint: str | None
    reached: float
    configurations: Matrix
    residual: float
    correction: float
    singularity: float

    def __repr__(self) -> str:
        by = f" of '{self.joint}'" if self.joint else ""
        return f"<MotionPath to {self.reached:.6g} rad or m: {self.end}{by}; {len(self.configurations)} configurations>"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sweep:
    """The range of motion of one actuator, as `sweep` returns it.

    Attributes:
        actuator: Name of the joint.
        bounds: Its lower and upper position limit, rad or m. Where it has no limit: half a turn, or the characteristic
            length, from the start. For a continuous joint, relative to the start.
        lower: The path toward the lower bound.
        upper: The path toward the upper bound.
        periodic: Whether a full turn of the actuator leads back to the same configuration, except for motions that the
            actuators do not control; None unless both paths end after half a turn.
    """

    actuator: str
    bounds: tuple[float, float]
    lower: MotionPath
    upper: MotionPath
    periodic: bool | None

    def __repr__(self) -> str:
        ends = (f"{path.reached:.6g} ({path.end})" for path in (self.lower, self.upper))
        return f"<Sweep of '{self.actuator}': {' to '.join(ends)} rad or m>"


def sweep(
    robot: Robot,
    actuator: str,
    q0: Named | None = None,
    *,
    steps: int = 200,
    limits: bool = True,
) -> Sweep:
    """Move one actuator from a closed configuration to its position limits, with the other actuators held.

    Let K_a be the actuator's column of K, and K_p the columns of the passive joints. The motion satisfies
    K_p v_p = -K_a v_a and r(q) = 0 with the least v_p; springs have no effect on it. It ends where the actuator or a
    passive joint reaches its position limit, or where K_p loses rank (a dead point). Steps are halved until none can
    jump over a dead point or to another branch.

    If an actuator has no limit in one direction (a continuous joint, or no range in the URDF), it moves at most half a
    turn from the start in that direction. If it translates, it moves at most by the characteristic length of the loops:
    the reach of the longest loop, 1 m without loops. A passive joint that starts beyond its limit can move back, but
    not farther out.

    Args:
        robot: The robot.
        actuator: Name of an actuated joint that has one coordinate.
        q0: Where to start (nq,); the loops are closed first if they are open. The default is the `assembled`
            configuration, or the neutral one if there is none.
        steps: Number of steps of each of the two paths.
        limits: Whether position limits end a path. Limits that are both 0 are no range (`urdf-no-range`).

    Raises:
        NotClosable: The loops cannot be closed at q0.
        ValueError: ``actuator`` is not actuated, or has several coordinates; ``q0`` is not a configuration;
            ``steps`` is less than 1.
    """
    steps, kept = checked_count("steps", steps, 1), chosen_limits(robot, limits)
    first = assemble(robot, q0, tolerance=START)
    if not first.closes:
        raise NotClosable("no closed configuration was found near the start", first.open, first.q)
    drive = _drive(robot, actuator, first.q, kept)
    branch = Branch(robot, drive.velocity, kept)
    start = branch.at(first.q)
    below = _follow(branch, start, drive.bounds[0] - drive.at, steps, start.smallest)
    above = _follow(branch, start, drive.bounds[1] - drive.at, steps, below.largest)
    largest = max(below.largest, above.largest)
    lower, upper = below.path(drive, drive.ends[0], largest), above.path(drive, drive.ends[1], largest)
    periodic = branch.same(below.points[-1], above.points[-1]) if lower.end == upper.end == "half turn" else None
    return Sweep(actuator, drive.bounds, lower, upper, periodic)


class _MovedActuator(NamedTuple):
    """The actuator that is moved.

    Attributes:
        velocity: Its index in v.
        at: Its coordinate at the start, rad or m; 0 for a continuous joint.
        bounds: The coordinates it is moved to.
        ends: What ends the path there.
    """

    velocity: int
    at: float
    bounds: tuple[float, float]
    ends: tuple[End, End]


def _drive(robot: Robot, actuator: str, q: Vector, limits: PositionLimits | None) -> _MovedActuator:
    if actuator not in robot.actuation.joints:
        raise ValueError(f"'{actuator}' is not an actuated joint of this robot")
    velocities = robot.tree.velocities_of(actuator)
    if len(velocities) != 1:
        raise ValueError(
            f"actuator '{actuator}' has {len(velocities)} velocities; sweep moves joints with one velocity"
        )
    (velocity,) = velocities
    kind = next(joint.type for joint in robot.mechanism.joints if joint.name == actuator)
    at = float(q[robot.tree.coordinate(actuator).idx_q]) if kind.limited else 0.0
    farthest = characteristic_length(robot) if kind.slides else math.pi
    without: End = "characteristic length" if kind.slides else "half turn"
    lower, upper, ends = at - farthest, at + farthest, [without, without]
    if limits is not None and math.isfinite(limits.lower[velocity]):
        lower, ends[0] = float(limits.lower[velocity]), "limit"
    if limits is not None and math.isfinite(limits.upper[velocity]):
        upper, ends[1] = float(limits.upper[velocity]), "limit"
    return _MovedActuator(velocity, at, (lower, upper), (ends[0], ends[1]))


@dataclass(frozen=True, slots=True, eq=False)
class _Trail:
    """The steps of one path.

    Attributes:
        points: All points, from the start on.
        configurations: Those after whole steps, from the start on.
        moved: How far the actuator moved, rad or m.
        end: What ended the path before the bound of the actuator, else None.
        joint: The passive joint that ended it, else None.
    """

    points: list[BranchPoint]
    configurations: list[Vector]
    moved: float
    end: End | None
    joint: str | None

    @property
    def largest(self) -> float:
        """The largest of the smallest singular values of K_p on it."""
        return max(point.smallest for point in self.points)

    def path(self, drive: _MovedActuator, end: End, largest: float) -> MotionPath:
        """The public form of the path; ``end`` is what ends it at its bound, ``largest`` is that of both paths."""
        smallest = min(point.smallest for point in self.points)
        return MotionPath(
            end=self.end or end,
            joint=self.joint,
            reached=drive.at + self.moved,
            configurations=np.array(self.configurations),
            residual=max(point.residual for point in self.points),
            correction=max(point.correction for point in self.points),
            singularity=smallest / largest if math.isfinite(largest) else 1.0,
        )


def _follow(branch: Branch, start: BranchPoint, reach: float, steps: int, largest: float) -> _Trail:
    """Move the actuator by at most ``reach`` (rad or m); ``largest`` is that of the points met before."""
    points, configurations = [start], [start.q]
    end: End | None = None
    joint, done, part = None, 0.0, 1.0  # fraction of a step that is done, and that is tried next

    def advance(_: Elements, so_far: Numbers, h: Numbers) -> tuple[Numbers, Numbers]:
        nonlocal end, joint, done, part, largest
        done = so_far
        there = branch.step(points[-1], h * reach / steps)
        if there is None:
            return h, False
        met = branch.passive_limit(points[-1], there)
        if met:
            end, (joint, until) = "passive limit", met
            done += h * until
        elif there.rank != start.rank or there.smallest < DEAD * max(largest, there.smallest):
            end = "dead point"
        if end is not None:
            return 0.0, False
        points.append(there)
        largest, part = max(largest, there.smallest), 2.0 * h
        return h, True

    while len(configurations) <= steps and reach:
        if follow(advance, shortest=_SHORTEST_STEP, first=min(part, 1.0))[0] < 1.0:
            end = end or "dead point"
            break
        done = 0.0
        configurations.append(points[-1].q)
    return _Trail(points, configurations, reach * (len(configurations) - 1 + done) / steps, end, joint)
