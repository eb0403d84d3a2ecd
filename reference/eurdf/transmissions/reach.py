"""Which positions of the serial joints can be reached from others, and what stops the joints."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.batch import forward_kinematics
from eurdf.kinematics.position_limit import position_limits
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.mechanism.joint import LIMIT_TOLERANCE
from eurdf.pinocchio.robot import build_robot
from eurdf.transmissions.selection import Selection
from eurdf.transmissions.transmission import at_many

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Steps of the joints, rad or characteristic lengths. A loop that has to be found open takes long.
_LONGEST_STEP = 0.04

#: What stops the serial joints: the range that is looked at, or their own limits; the limit of a motor, or of a passive
#: joint; a pose at which motors do not hold the joints; or one beyond which the loops do not close.
StopKind = Literal["range", "joint", "motor", "passive", "singular", "not closed"]

Side = Literal["lower", "upper"]
_SIDES: tuple[Side, Side] = ("lower", "upper")


@dataclass(frozen=True, slots=True, repr=False)
class Stop:
    """What stops the serial joints at a point of the boundary.

    Attributes:
        kind: What it is.
        joint: Name of the joint at its limit; empty if none is.
        side: Which limit; None if there is none.
    """

    kind: StopKind
    joint: str = ""
    side: Side | None = None

    def __str__(self) -> str:
        words = {"singular": "singular pose", "not closed": "the loops do not close beyond"}
        end = "end of the range" if self.kind == "range" else "limit"
        return words.get(self.kind, f"{self.side} {end} of '{self.joint}'")

    def __repr__(self) -> str:
        return f"<Stop: {self}>"


class Examined(NamedTuple):
    """What was found at B positions.

    Attributes:
        q: Configurations (B, nq).
        reached: Whether the joints can be there (B,).
        stop: Index (B,) in `Reach.stops`; -1 where they can.
    """

    q: Matrix
    reached: Mask
    stop: Indices


class Reach:
    """Moves the serial joints of a robot along straight paths, many at once.

    Attributes:
        stops: Everything that can stop them.
    """

    def __init__(self, robot: Robot, joints: Selection, motors: Selection, q: Vector, axes: tuple[Vector, ...]) -> None:
        """Take a robot, a pose (nq,) at which the joints can be, and for each joint its range, from first to last."""
        self._robot, self._joints, self._motors = robot, joints, motors
        driven = replace(robot.mechanism, actuators=joints.joints, motors={})
        self._driven = build_robot(driven, geometry=False)
        self._limits = position_limits(robot)
        self._unit = robot.cached(TangentSpaces).scale[joints.velocities]
        nv = robot.tree.nv
        self.stops = [self._at_limit(v, side) for side in _SIDES for v in range(nv)]
        self.stops += [Stop("singular"), Stop("not closed")]
        self._singular, self._not_closed = 2 * nv, 2 * nv + 1
        self._lower, self._upper = np.array([(axis[0], axis[-1]) for axis in axes]).T
        own = self._limits.lower[joints.velocities] == self._lower, self._limits.upper[joints.velocities] == self._upper
        for side, is_limit in zip(_SIDES, own, strict=True):
            for name, limit in zip(joints.names, is_limit.tolist(), strict=True):
                self.stops.append(Stop("joint" if limit else "range", name, side))
        self._sign = self._signs(q[None])[0]

    def examine(self, q: Matrix, positions: Matrix) -> Examined:
        """Move the joints from configurations (B, nq), where they can be, straight to positions (B, nJ).

        They move in short steps, and stop after the first one that they cannot make.
        """
        own = self._joints
        start = own.nearest(own.read(q), positions)
        longest = np.abs((positions - start) / self._unit).max(initial=0.0)
        steps = max(1, math.ceil(longest / _LONGEST_STEP))
        end, stop = q.copy(), np.full(len(q), -1, np.intp)
        for step in range(1, steps + 1):
            left = np.flatnonzero(stop < 0)
            if not len(left):
                break
            to = start[left] + step / steps * (positions - start)[left]
            end[left], stop[left] = self._moved(end[left], to if step < steps else positions[left])
        return Examined(end, stop < 0, stop)

    def _moved(self, q: Matrix, positions: Matrix) -> tuple[Matrix, Indices]:
        """The configurations (B, nq) after a step, and what stops the joints (B,)."""
        over = np.concatenate((self._lower - positions, positions - self._upper), axis=1)
        stop = np.where(over.max(axis=1) > LIMIT_TOLERANCE, self._not_closed + 1 + over.argmax(axis=1), -1)
        end, left = q.copy(), np.flatnonzero(stop < 0)
        found = forward_kinematics(self._driven, self._values(positions[left]), q[left])
        end[left] = found.q
        stop[left[~found.converged]] = self._not_closed
        left = left[found.converged]
        beyond, worst = self._beyond(end[left])
        stop[left[beyond]] = worst[beyond]
        left = left[~beyond]
        stop[left[self._signs(end[left]) != self._sign]] = self._singular
        return end, stop

    def beyond_limits(self, q: Vector) -> Stop | None:
        """The limit that a configuration (nq,) is beyond, if it is."""
        beyond, worst = self._beyond(q[None])
        return self.stops[int(worst[0])] if beyond[0] else None

    def _values(self, positions: Matrix) -> Matrix:
        """Positions (B, nJ) as the driven robot's actuated coordinates (B, nu)."""
        columns = []
        for column, turns in zip(positions.T, self._joints.circular.tolist(), strict=True):
            columns += [np.cos(column), np.sin(column)] if turns else [column]
        return np.stack(columns, axis=1)

    def _beyond(self, q: Matrix) -> tuple[Mask, Indices]:
        """Whether configurations are beyond position limits, and the index of the stop that they are most beyond."""
        over = self._limits.excess(q)
        return over.max(axis=1, initial=-np.inf) > LIMIT_TOLERANCE, over.argmax(axis=1)

    def _signs(self, q: Matrix) -> Vector:
        """Sign of det G (B,), which changes where motors do not hold the joints; 0 where there is no G or B_J."""
        at = at_many(self._robot, self._joints, q, self._motors)
        holds = np.isfinite(at.condition) & np.isfinite(at.B_J).all(axis=(1, 2))
        sign = np.zeros(len(q))
        G = at.G[holds]
        sign[holds] = np.sign(np.linalg.det(G)) if len(self._joints) == len(self._motors) else 1.0
        return sign

    def _at_limit(self, velocity: int, side: Side) -> Stop:
        own, actuated = velocity in self._joints.velocities, velocity in self._robot.actuation.idx_v
        return Stop("joint" if own else "motor" if actuated else "passive", self._limits.joints[velocity], side)
