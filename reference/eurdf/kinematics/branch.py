"""Steps along the branch of closed configurations through which one actuator leads its loops, the others held.

The passive joints follow along the tangent, K_p v_p = -K_a v_a with the least v_p, and the loops are closed again after
the step. Here K_a is the actuator's column of K, and K_p has those of the joints that nothing drives or holds. Two
branches meet where K_p loses rank, in a dead point: there the passive joints no longer follow from the actuator.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Mask, Matrix, Vector
from eurdf.kinematics.evaluation import evaluations
from eurdf.kinematics.loop import independent_groups
from eurdf.kinematics.position_limit import BEYOND, PositionLimits
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A step is short enough where two things hold. The correction that closes the loops after it is at most this part of
# it. Toward a dead point at distance d the passive joints go as √d does, and a step h needs a correction of h / 4d of
# it: so it goes less than half the way there, and does not come to another branch. ...
_MOST_CORRECTION = 0.1
# ... And K_p changes by less than the sum of its smallest singular values before and after: by as much it would have to
# change to lose rank and to get it back (Eckart, Young, 1936), so there is no dead point within the step.

# The corrections use the Jacobian from before the step: they converge fast where it changes little.
_MOST_CORRECTIONS = 12
_CLOSED = 1e-13  # what each row of the residual is brought to, m or rad, ...
_ROUNDING = 1e-14  # ... unless the corrections come to this (rad, or characteristic lengths), as with redundant rows

_SAME = 1e-6  # how far apart configurations may be that count as one (rad, or characteristic lengths)


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """A closed configuration on a branch, and K there, free of unit.

    Attributes:
        q: The configuration (nq,).
        residual: Its largest row, m or rad.
        correction: What closed the loops after the step that led here, in parts of the step.
        K: Its columns (m, n) for the loops that the actuator moves.
        rank: Of K_p.
        smallest: The smallest singular value of K_p that is not zero; inf if there is none.
        inverse: K_p⁺ (n, m), with a row of zeros for the actuator.
    """

    q: Vector
    residual: float
    correction: float
    K: Matrix
    rank: int
    smallest: float
    inverse: Matrix


class Branch:
    """Takes steps of one actuator of one robot."""

    def __init__(self, robot: Robot, actuator: int, limits: PositionLimits | None, data: Any = None) -> None:
        """Prepare the loops that an actuator moves.

        Args:
            robot: The robot.
            actuator: Index in v of the actuator that is led.
            limits: The position limits at which passive joints stop, if any.
            data: A `pin.Data` to compute in.
        """
        model = self._model = robot.model
        held = set(robot.actuation.idx_v.tolist()) - {actuator}
        groups = [group for group in independent_groups(robot, held) if actuator in group.velocities]
        length = characteristic_length(robot)
        rows, unit = row_scale(robot, length), velocity_scale(robot, length)
        # A joint that mimics another has columns of its own, which only the loops know to add up.
        mimics = model.nv < model.nvExtended
        if data is None and not mimics:
            data = model.createData()
        self._loops = evaluations(robot, groups, rows, unit, None if mimics else data)[0] if groups else None
        self._rows = self._loops.row_scale if self._loops else np.empty(0)
        self._velocities = groups[0].velocities if groups else np.array([actuator])
        self._unit = unit[self._velocities]
        self._passive = self._velocities != actuator
        self._limits = limits
        self._turns = _whole_turns(model)[self._velocities]

    def at(self, q: Vector, correction: float = 0.0) -> Point:
        """The point that is the closed configuration q (nq,)."""
        residual = float(np.abs(self._residual(q)).max(initial=0.0))
        K = self._loops.jacobian() if self._loops else np.zeros((0, len(self._unit)))
        left, values, right = np.linalg.svd(K[:, self._passive], full_matrices=False)
        rank = numerical_rank(values, values.max(initial=0.0))
        inverse = np.zeros(K.T.shape)
        inverse[self._passive] = (right[:rank].T / values[:rank]) @ left[:, :rank].T
        smallest = float(values[rank - 1]) if rank else math.inf
        return Point(q, residual, correction, K, rank, smallest, inverse)

    def step(self, here: Point, h: float) -> Point | None:
        """The point to which a step h of the actuator, rad or m, leads; None if it is too long."""
        step = np.where(self._passive, 0.0, h / self._unit)
        step -= here.inverse @ (here.K @ step)
        q = self._moved(here.q, step)
        correction = np.zeros(len(step))
        for _ in range(_MOST_CORRECTIONS):
            r = self._residual(q)
            if np.abs(r).max(initial=0.0) <= _CLOSED:
                break
            more = here.inverse @ -(self._rows * r)
            q = self._moved(q, more)
            correction += more
            if np.abs(more).max() <= _ROUNDING:
                break
        else:
            return None
        part = float(np.linalg.norm(correction) / np.linalg.norm(step))
        if part > _MOST_CORRECTION:
            return None
        there = self.at(q, part)
        change = float(np.linalg.norm((there.K - here.K)[:, self._passive]))
        return there if change <= here.smallest + there.smallest else None

    def passive_stop(self, here: Point, there: Point) -> tuple[str, float] | None:
        """The passive joint that comes first to its stop between two points, and after what part of the step.

        A joint that is beyond its stop already, as it may be at the start, may come back, but not go farther.
        """
        if self._limits is None:
            return None
        passive = self._velocities[self._passive]
        coordinates, lower, upper = (
            values[passive] for values in (self._limits.coordinates, self._limits.lower, self._limits.upper)
        )
        before, after = here.q[coordinates], there.q[coordinates]
        over = np.maximum(after - np.maximum(upper, before), np.minimum(lower, before) - after) - BEYOND
        if not over.max(initial=0.0) > 0.0:
            return None
        part = np.full(len(over), -np.inf)
        np.divide(over, np.abs(after - before), out=part, where=over > 0.0)  # what goes farther has moved
        first = int(np.argmax(part))
        return self._limits.joints[passive[first]], 1.0 - float(part[first])

    def same(self, one: Point, other: Point) -> bool:
        """Whether two points with the actuator in one place are one, but for motions that the actuators leave free.

        An angle is in one place with all that differ from it by whole turns.
        """
        apart = np.asarray(pin.difference(self._model, one.q, other.q))[self._velocities]
        apart = np.where(self._turns, np.remainder(apart + math.pi, 2.0 * math.pi) - math.pi, apart) / self._unit
        # K_p⁺ K takes out of it what K_p lets move.
        return bool(np.abs(one.inverse @ (one.K @ apart)).max() <= _SAME)

    def _residual(self, q: Vector) -> Vector:
        """Rows (m,) of the loops, m and rad."""
        return self._loops.residual(q) if self._loops else np.empty(0)

    def _moved(self, q: Vector, step: Vector) -> Vector:
        v = np.zeros(self._model.nv)
        v[self._velocities] = self._unit * step
        # Pinocchio brings quaternions back to unit length to first order alone.
        return np.asarray(pin.normalize(self._model, pin.integrate(self._model, q, v)))


def _whole_turns(model: Any) -> Mask:
    """Which velocities (nv,) drive a plain angle that whole turns leave where it is: nothing counts its turns."""
    turns: Mask = np.zeros(model.nv, dtype=bool)
    neutral = pin.neutral(model)
    for joint in model.joints[1:]:
        if joint.nv and joint.nq == joint.nv:
            data = joint.createData()
            joint.calc(data, neutral)
            S = data.S.reshape(6, -1)
            turns[joint.idx_v : joint.idx_v + joint.nv] = ~S[:3].any(axis=0)
    for joint in model.mimicking_joints:  # one that follows by half an angle does count them
        turns[model.joints[joint].idx_v] = False
    return turns
