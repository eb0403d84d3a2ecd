"""How far an actuator can move its mechanism, and what ends the way."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.branch import Branch, Point
from eurdf.kinematics.exceptions import NotClosable
from eurdf.kinematics.position_limit import Limits, PositionLimits, chosen_limits
from eurdf.kinematics.scale import characteristic_length
from eurdf.mechanism.joint_type import JointType
from eurdf.pinocchio.coordinates import slots

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: What ends a path: a stop of the actuator; without one, half a turn, or the characteristic length of an actuator that
#: translates; a stop of a passive joint; a dead point.
End = Literal["stop", "half turn", "characteristic length", "passive stop", "dead point"]

# A mechanism is at a dead point where the smallest singular value of K_p is below this part of the largest one met:
# there, forces are a hundredfold, and play and rounding decide where it goes.
_DEAD = 0.01

_SHORTEST_STEP = 2.0**-12  # steps are halved down to this part of one

_TOLERANCE = 1e-12  # what each row of the residual may be at the start, m or rad


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """The way of an actuator from where it stands toward one of its stops.

    Attributes:
        end: What ends it.
        joint: The passive joint that ends it at its stop, else None.
        reached: Coordinate of the actuator at its end, rad or m; of a continuous joint, seen from the start.
        configurations: Closed configurations (n, nq) on it, from the start on, in equal steps of the actuator.
        residual: Largest row of their residuals, m or rad.
        correction: Largest correction that closed the loops after a step along the tangent, in parts of the step.
        singularity: Smallest singular value of K_p on it, in parts of the largest one of both ways; 1 without loops.
    """

    end: End
    joint: str | None
    reached: float
    configurations: Matrix
    residual: float
    correction: float
    singularity: float


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """What `sweep` found.

    Attributes:
        actuator: Name of the joint.
        stops: Its lowest and its highest coordinate, rad or m. On a side without a stop: half a turn, or the
            characteristic length, from the start. Of a continuous joint, seen from the start.
        lower: The way toward the lower stop.
        upper: The way toward the upper stop.
        comes_round: Whether two ways of half a turn end in one configuration, but for motions that the actuators leave
            free; None where they are no such ways.
    """

    actuator: str
    stops: tuple[float, float]
    lower: Way
    upper: Way
    comes_round: bool | None


def sweep(
    robot: Robot,
    actuator: str,
    q0: Vector | None = None,
    *,
    steps: int = 200,
    limits: Limits = True,
    data: Any = None,
) -> Sweep:
    """Lead one actuator from a closed configuration to its stops, the other actuators held.

    With K_a the actuator's column of K, and K_p those of the joints that nothing drives or holds, it follows
    K_p v_p = -K_a v_a and r(q) = 0, the passive joints moving as little as they can, until the actuator or a passive
    joint comes to its stop, or K_p loses rank, in a dead point. Where the passive joints turn fast, steps are halved
    until none can lead through a dead point or to another branch.

    An actuator without a stop on one side, such as a continuous joint or one whose URDF gives no range, is led half a
    turn from the start there, at most; where it translates, by the characteristic length of the loops: the reach of
    the longest one, 1 m without loops. A passive joint that starts beyond its stop may come back, but not go farther.

    Args:
        robot: The robot.
        actuator: Name of an actuated joint that has one coordinate.
        q0: Where to start (nq,). It is closed first if it is not. The `assembled` configuration by default, or else the
            neutral one.
        steps: How many steps each of the two ways has.
        limits: Whether actuator and passive joints have stops at their position limits. A range of zero width counts as
            no range (`urdf-no-range`), unless it is ``"strict"``.
        data: A `pin.Data` of the model to compute in; it takes O(nv³) numbers, and else is made anew.

    Raises:
        NotClosable: The loops cannot be closed at q0.
        ValueError: ``actuator`` is not actuated, or has several coordinates; ``q0`` is no configuration.
    """
    kept = chosen_limits(robot.model, limits)
    first = assemble(robot, q0, tolerance=_TOLERANCE)
    if not first.closes:
        raise NotClosable("there is no closed configuration near the start", first.open, first.q)
    drive = _drive(robot, actuator, first.q, kept)
    branch = Branch(robot, drive.velocity, kept, data)
    start = branch.at(first.q)
    below = _follow(branch, start, drive.stops[0] - drive.at, steps, start.smallest)
    above = _follow(branch, start, drive.stops[1] - drive.at, steps, below.largest)
    largest = max(below.largest, above.largest)
    lower, upper = below.way(drive, drive.ends[0], largest), above.way(drive, drive.ends[1], largest)
    comes_round = branch.same(below.points[-1], above.points[-1]) if lower.end == upper.end == "half turn" else None
    return Sweep(actuator, drive.stops, lower, upper, comes_round)


@dataclass(frozen=True, slots=True)
class _Drive:
    """The actuator that is led.

    Attributes:
        velocity: Its index in v.
        at: Where it starts, rad or m; 0 for a continuous joint.
        stops: Where it is led to.
        ends: What ends the path there.
    """

    velocity: int
    at: float
    stops: tuple[float, float]
    ends: tuple[End, End]


def _drive(robot: Robot, actuator: str, q: Vector, limits: PositionLimits | None) -> _Drive:
    if actuator not in robot.actuation.joints:
        raise ValueError(f"'{actuator}' is no actuated joint of this robot")
    slot = slots(robot.mechanism, robot.model)[actuator]
    if slot.nv != 1:
        raise ValueError(f"actuator '{actuator}' has {slot.nv} velocities; a sweep leads one")
    at = 0.0 if slot.joint.type is JointType.CONTINUOUS else float(q[slot.idx_q])
    translates = slot.joint.type is JointType.PRISMATIC
    farthest = characteristic_length(robot) if translates else math.pi
    without: End = "characteristic length" if translates else "half turn"
    lower, upper = (-math.inf, math.inf) if limits is None else (limits.lower[slot.idx_v], limits.upper[slot.idx_v])
    return _Drive(
        slot.idx_v,
        at,
        (
            float(lower) if math.isfinite(lower) else at - farthest,
            float(upper) if math.isfinite(upper) else at + farthest,
        ),
        ("stop" if math.isfinite(lower) else without, "stop" if math.isfinite(upper) else without),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Trail:
    """A way as it was gone.

    Attributes:
        points: Every one, from the start on.
        configurations: Those after whole steps, from the start on.
        went: How far the actuator went, rad or m.
        end: What stopped it, if not the actuator itself.
        joint: The passive joint that did.
    """

    points: list[Point]
    configurations: list[Vector]
    went: float
    end: End | None
    joint: str | None

    @property
    def largest(self) -> float:
        """The largest of the smallest singular values of K_p on it."""
        return max(point.smallest for point in self.points)

    def way(self, drive: _Drive, end: End, largest: float) -> Way:
        """The path, where the smallest singular value of K_p is at most ``largest`` on both.

        Args:
            drive: The actuator.
            end: What ends the path where nothing stopped it.
            largest: See above.
        """
        smallest = min(point.smallest for point in self.points)
        return Way(
            end=self.end or end,
            joint=self.joint,
            reached=drive.at + self.went,
            configurations=np.array(self.configurations),
            residual=max(point.residual for point in self.points),
            correction=max(point.correction for point in self.points),
            singularity=smallest / largest if math.isfinite(largest) else 1.0,
        )


def _follow(branch: Branch, start: Point, reach: float, steps: int, largest: float) -> _Trail:
    """Lead the actuator as far as ``reach`` (rad or m); ``largest`` is that of the points met before."""
    points, configurations = [start], [start.q]
    end: End | None = None
    joint, done, part = None, 0.0, 1.0  # of a step: how much is done, how much is tried
    while len(configurations) <= steps and reach:
        there = branch.step(points[-1], part * reach / steps)
        if there is None and part > _SHORTEST_STEP:
            part *= 0.5
            continue
        met = branch.passive_stop(points[-1], there) if there else None
        if met:
            end, (joint, until) = "passive stop", met
            done += part * until
            break
        if there is None or there.rank != start.rank or there.smallest < _DEAD * max(largest, there.smallest):
            end = "dead point"
            break
        points.append(there)
        largest = max(largest, there.smallest)
        done += part
        if done == 1.0:
            configurations.append(there.q)
            done = 0.0
        part = min(2.0 * part, 1.0 - done)
    return _Trail(points, configurations, reach * (len(configurations) - 1 + done) / steps, end, joint)
