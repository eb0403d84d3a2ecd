"""Constraints of any kinds, stacked: their residual, K and drift."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.constraints import KINDS
from eurdf.kinematics.constraints.kind import Kind, State
from eurdf.kinematics.constraints.relative_motion import RelativeMotions
from eurdf.kinematics.derived import derived
from eurdf.kinematics.tree_kinematics import PairMemory, TreeKinematics
from eurdf.mechanism.constraint import Constraint

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class ConstraintStack:
    """Some constraints of a robot, and the velocities by which K has columns.

    It holds nothing that depends on a configuration, so that threads may share it.

    Attributes:
        constraints: The constraints, in the order of their rows.
        m: Number of rows.
        n: Number of velocities.
    """

    def __init__(
        self, tree: TreeKinematics, constraints: Sequence[Constraint], velocities: Indices | None = None
    ) -> None:
        """Stack the constraints of a tree; ``velocities`` (n,) are indices in v, all if None."""
        self.constraints = tuple(constraints)
        self.n = tree.nv if velocities is None else len(velocities)
        anchors: list[Any] = []
        members: dict[type[Constraint], list[tuple[Any, Any, Any]]] = {}  # index, pair and rows of each
        self.m = 0
        for index, constraint in enumerate(constraints):
            rows = slice(self.m, self.m + constraint.rows)
            members.setdefault(type(constraint), []).append((index, len(anchors), rows))
            self.m = rows.stop
            if constraint.anchors:
                anchors.append(constraint.anchors)
        self._pairs = tree.pairs(anchors, velocities)
        columns = np.arange(tree.nv) if velocities is None else velocities
        #: Each kind, the indices of its constraints, and its rows (k r,).
        self._kinds: list[tuple[Kind[Any], list[int], Indices]] = []
        for data, found in members.items():
            indices, pairs, slices = ([each[part] for each in found] for part in range(3))
            kind = KINDS[data]([self.constraints[index] for index in indices], pairs, tree, columns)
            of_kind = np.concatenate([np.arange(each.start, each.stop) for each in slices])
            self._kinds.append((kind, indices, of_kind))

    def memory(self) -> PairMemory:
        """Memory to evaluate the constraints in."""
        return self._pairs.memory()

    def openings_once(self, q: Vector) -> list[tuple[float, float]]:
        """As `openings`, at q (nq,), sooner than memory to evaluate the constraints in is made."""
        return self.openings(State(q, self._pairs.placements_once(q)))

    def at(self, q: Vector, memory: PairMemory) -> State:
        """The constraints at q (nq,); another configuration in the same memory makes the state invalid."""
        return State(q, memory.placements(q), memory)

    def residual(self, at: State) -> Vector:
        """The residual (m,)."""
        return self._stacked([kind.residual(at).ravel() for kind, _, _ in self._kinds])

    def jacobian(self, at: State) -> Matrix:
        """K (m, n)."""
        if len(self._kinds) == 1:
            return self._kinds[0][0].jacobian(at)
        K = np.empty((self.m, self.n))
        for kind, _, rows in self._kinds:
            K[rows] = kind.jacobian(at)
        return K

    def drift(self, q: Vector, v: Vector, memory: PairMemory) -> Vector:
        """K̇ v (m,) at q (nq,) and v (nv,)."""
        motions = RelativeMotions(*memory.motions(q, v))
        return self._stacked([kind.drift(motions).ravel() for kind, _, _ in self._kinds])

    def scale(self, length: float) -> Vector:
        """Factors (m,) that make the rows dimensionless, with the robot's characteristic length, m."""
        return self._stacked([kind.scale(length).ravel() for kind, _, _ in self._kinds])

    def openings(self, at: State) -> list[tuple[float, float]]:
        """How far each constraint is open, m and rad."""
        found = [(0.0, 0.0)] * len(self.constraints)
        for kind, members, _ in self._kinds:
            for index, opening in zip(members, kind.openings(at), strict=True):
                found[index] = opening
        return found

    def _stacked(self, parts: Sequence[Vector]) -> Vector:
        if len(parts) == 1:
            return parts[0]
        stacked = np.empty(self.m)
        for part, (_, _, rows) in zip(parts, self._kinds, strict=True):
            stacked[rows] = part
        return stacked


def all_constraints(robot: Robot) -> ConstraintStack:
    """The stack of all constraints of a robot, by all velocities."""
    return derived(robot, _stack)


def _stack(robot: Robot) -> ConstraintStack:
    return ConstraintStack(robot.tree, robot.constraints)
