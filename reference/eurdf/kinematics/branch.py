"""Steps along the branch of closed configurations on which one actuator moves its loops, the others held.

The passive joints move along the tangent, K_p v_p = -K_a v_a with the least v_p, and the loops are closed again after
the step. K_a is the actuator's column of K, K_p has the columns of the passive joints. Two branches meet at a dead
point, where K_p loses rank: there the actuator no longer determines the passive joints.
"""

from __future__ import annotations

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.kinematics.position_limit import PositionLimits
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.tolerances import BRANCH, CLOSED, KEPT, ROUNDED_CORRECTION, SAME
from eurdf.mechanism.joint import LIMIT_TOLERANCE

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A step is short enough if two conditions hold.
# 1. The correction that closes the loops after it is at most this fraction of the step. At distance d from a dead point
#    the passive joints move as √d does, and a step h needs a correction of h / 4d of it: so the step covers less than
#    half the distance to the dead point, and cannot reach another branch.
_MOST_CORRECTION = 0.1
# 2. K_p changes by less than the sum of its smallest singular values before and after the step. It would have to change
#    by as much to lose rank and to regain it (Eckart, Young, 1936), so there is no dead point within the step.

# The corrections use the Jacobian from before the step: they converge fast if it changes little.
_MOST_CORRECTIONS = 12


@dataclass(frozen=True, slots=True, eq=False)
class BranchPoint:
    """A closed configuration on a branch, and K there, dimensionless.

    Attributes:
        q: The configuration (nq,).
        residual: Its largest row, m or rad.
        correction: Size of the correction that closed the loops after the step to this point, relative to the step.
        K: Its columns (m, n) for the loops that the actuator moves.
        rank: Of K_p.
        smallest: The smallest singular value of K_p that is not zero; inf if there is none.
        inverse: K_p⁺ (n, m), with rows of zeros for the actuator and what is held.
    """

    q: Vector
    residual: float
    correction: float
    K: Matrix
    rank: int
    smallest: float
    inverse: Matrix


class Branch:
    """Takes steps of one actuator of one robot.

    Attributes:
        velocities: Indices in v of the joints of the loops that the actuator moves, its own included.
        passive: Those of them that are neither the actuator nor held.
    """

    def __init__(
        self, robot: Robot, actuator: int, limits: PositionLimits | None, follow: Collection[int] = ()
    ) -> None:
        """Prepare the loops that an actuator moves.

        Args:
            robot: The robot.
            actuator: Index in v of the actuator that is moved.
            limits: The position limits of the passive joints, if any.
            follow: Indices in v of other actuators that are not held: they follow as passive joints do.
        """
        self._tree = robot.tree
        held = set(robot.actuation.idx_v.tolist()) - {actuator, *follow}
        self._problem = Problem(robot, sorted(held))
        moved = [group for group in self._problem.groups if actuator in group.loops.velocities]
        self._group = moved[0] if moved else None
        self._rows = np.empty(0) if self._group is None else self._group.row_scale
        self.velocities = np.array([actuator]) if self._group is None else self._group.loops.velocities
        self._unit = self._problem.spaces.scale[self.velocities]
        self._driven = self.velocities == actuator
        # The group has all velocities of a joint with several, those held too.
        self._passive = ~self._driven & ~np.isin(self.velocities, list(held))
        self.passive = self.velocities[self._passive]
        self._limits = limits
        self._turns = robot.tree.whole_turns[self.velocities]

    def at(self, q: Vector, correction: float = 0.0) -> BranchPoint:
        """The point at the closed configuration q (nq,)."""
        residual, K = 0.0, np.zeros((0, len(self._unit)))
        if self._group is not None:
            at = self._group.evaluator.at(q[None])
            residual = float(np.abs(self._group.evaluator.residual(at)).max(initial=0.0))
            K = self._group.jacobian(at)[0]
        left, values, right = np.linalg.svd(K[:, self._passive], full_matrices=False)
        rank = numerical_rank(values)
        inverse = np.zeros(K.T.shape)
        inverse[self._passive] = (right[:rank].T / values[:rank]) @ left[:, :rank].T
        smallest = float(values[rank - 1]) if rank else math.inf
        return BranchPoint(q, residual, correction, K, rank, smallest, inverse)

    def step(self, here: BranchPoint, h: float) -> BranchPoint | None:
        """The point after a step h of the actuator, rad or m; None if the step is too long."""
        step = np.where(self._driven, h / self._unit, 0.0)
        step -= here.inverse @ (here.K @ step)
        q = self._moved(here.q, step)
        correction = np.zeros(len(step))
        for _ in range(_MOST_CORRECTIONS):
            r = np.empty(0) if self._group is None else self._group.residual(q[None])[0]
            if np.abs(r).max(initial=0.0) <= BRANCH:
                break
            more = here.inverse @ -(self._rows * r)
            q = self._moved(q, more)
            correction += more
            if np.abs(more).max() <= ROUNDED_CORRECTION:
                break
        else:
            return None
        part = float(np.linalg.norm(correction) / np.linalg.norm(step))
        if part > _MOST_CORRECTION:
            return None
        there = self.at(q, part)
        # Loops that cannot follow are open by more, in spite of the corrections.
        if there.residual > max(KEPT, here.residual, min(2.0 * here.residual, CLOSED)):
            return None
        change = float(np.linalg.norm((there.K - here.K)[:, self._passive]))
        return there if change <= here.smallest + there.smallest else None

    def passive_limit(self, here: BranchPoint, there: BranchPoint) -> tuple[str, float] | None:
        """The passive joint that first reaches its position limit between two points, and after what part of the step.

        A joint that is already beyond its limit, which is possible at the start, can move back, but not farther out.
        """
        if self._limits is None:
            return None
        coordinates, lower, upper = (
            values[self.passive] for values in (self._limits.coordinates, self._limits.lower, self._limits.upper)
        )
        before, after = here.q[coordinates], there.q[coordinates]
        # Within the tolerance it is at its limit, so that the steps of a motion do not add their tolerances up.
        highest = np.where(before > upper + LIMIT_TOLERANCE, before, upper)
        lowest = np.where(before < lower - LIMIT_TOLERANCE, before, lower)
        over = np.maximum(after - highest, lowest - after)
        if not over.max(initial=0.0) > LIMIT_TOLERANCE:
            return None
        part = np.full(len(over), -np.inf)
        # A joint that goes beyond has moved. Half the tolerance is left, so that a search for the limit ends within it.
        np.divide(over - 0.5 * LIMIT_TOLERANCE, np.abs(after - before), out=part, where=over > LIMIT_TOLERANCE)
        first = int(np.argmax(part))
        return self._limits.joints[self.passive[first]], max(0.0, 1.0 - float(part[first]))

    def same(self, one: BranchPoint, other: BranchPoint) -> bool:
        """Whether two points at the same actuator position are equal, except for motions that no actuator controls.

        Angles that differ by whole turns are equal.
        """
        apart = self._tree.difference(one.q, other.q)[self.velocities]
        apart = np.where(self._turns, np.remainder(apart + math.pi, 2.0 * math.pi) - math.pi, apart) / self._unit
        # K_p⁺ K removes the motions that K_p leaves free.
        return bool(np.abs(one.inverse @ (one.K @ apart)).max() <= SAME)

    def _moved(self, q: Vector, step: Vector) -> Vector:
        v = np.zeros((1, self._tree.nv))
        v[:, self.velocities] = self._unit * step
        return np.asarray(self._problem.tree.integrate(q[None], v)[0])
