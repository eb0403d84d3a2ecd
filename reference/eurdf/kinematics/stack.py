"""Groups of loops that are alike, as solvers see them all at once.

A large robot can have hundreds of equal groups. One after the other, most of their time would be that of calls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.rank import least_solution

if TYPE_CHECKING:
    from eurdf.kinematics.position_limit import PositionLimits


@dataclass(frozen=True, eq=False)
class Stack:
    """Groups of loops with the same numbers m of rows, n of velocities and k of given velocities.

    Attributes:
        tree: The spanning tree.
        members: Their indices (g,) among the groups of the robot.
        part: All of their loops as one group.
        rows: Where their rows (g, m) are among those of the part.
        columns: Where their velocities and the given ones (g, n + k) are among those of the part.
        velocities: Indices (g, n) in v of the velocities that close them.
        by: Indices (g, k) in v of the given velocities that move them.
        coordinates: Indices (g, c) in q of their coordinates.
        row_scale: Factors (g, m) that make their rows dimensionless.
        unit: Units (g, n) of their velocities.
        spread: Ratios (g,) of the largest unit of all these velocities to the smallest.
        work: Multiplications in a step of one group.
    """

    tree: Any
    members: Indices
    part: Any
    rows: Indices
    columns: Indices
    velocities: Indices
    by: Indices
    coordinates: Indices
    row_scale: Matrix
    unit: Matrix
    spread: Vector
    work: float

    @classmethod
    def of_groups(cls, tree: Any, members: list[int], groups: Sequence[Any], part: Any) -> Stack:
        """Take groups that are alike, and all of their loops as one."""
        velocities, by = (
            np.array([group.loops.velocities for group in groups]),
            np.array([group.by for group in groups], dtype=np.intp),
        )
        place = np.empty(tree.nv, dtype=np.intp)
        of_part = np.concatenate((part.loops.velocities, part.by))
        place[of_part] = np.arange(len(of_part))
        return cls(
            tree,
            np.array(members),
            part,
            np.array([np.searchsorted(part.loops.rows, group.loops.rows) for group in groups]),
            place[np.concatenate((velocities, by), axis=1)],
            velocities,
            by,
            np.array([group.loops.coordinates for group in groups]),
            np.array([group.row_scale for group in groups]),
            np.array([group.unit for group in groups]),
            np.array([group.spread for group in groups]),
            groups[0].work,
        )

    def following(self, q: Matrix, driven: Matrix | None) -> tuple[Matrix, Mask]:
        """As `Group.following` of each group: velocities (B, g, n, c) for given ones (B, g, k, c), and where (B, g)."""
        evaluator = self.part.evaluator
        K = evaluator.jacobian(evaluator.at(q))[:, self.rows[:, :, None], self.columns[:, None]]
        K *= self.row_scale[:, :, None]
        n = self.unit.shape[1]
        A, b = K[..., :n], -K[..., n:] if driven is None else -(K[..., n:] @ driven)
        norm = self.spread * np.sqrt(np.einsum("bgij,bgij->bg", K, K))
        x, sure = least_solution(A.reshape(-1, *A.shape[2:]), b.reshape(-1, *b.shape[2:]), norm.ravel())
        return x.reshape(*A.shape[:2], *x.shape[1:]), sure.reshape(A.shape[:2])

    def exceeds(self, own: Matrix, groups: Sequence[StackElements], limits: PositionLimits) -> bool:
        """As `Problem.exceeds`, at own coordinates (E, c) of pairs."""
        (pairs,) = groups
        return pairs.exceeds(own, limits)

    def moved(self, own: Matrix, groups: Sequence[StackElements], steps: Sequence[Matrix]) -> Matrix:
        """As `Problem.moved`: own coordinates (E, c) of pairs after their steps (E, n)."""
        (pairs,), (step,) = groups, steps
        return pairs.moved(own, step)


class StackElements:
    """Pairs of a configuration and a group of a stack. They descend as a `Group` whose elements they are.

    Attributes:
        element: Which of the configurations (E,).
        index: Which of the groups (E,).
        row_scale: Factors (E, m) that make their rows dimensionless.
        unit: Units (E, n) of their velocities.
    """

    def __init__(self, stack: Stack, q: Matrix, element: Indices, index: Indices) -> None:
        """Take configurations (B, nq), and which of them and of the groups are pairs."""
        self._stack, self._q, self.element, self.index = stack, q, element, index
        self._row = element[:, None]
        self._rows, self._columns = stack.rows[index], stack.columns[index, : stack.unit.shape[1]]
        self._velocities, self._coordinates = stack.velocities[index], stack.coordinates[index]
        self.row_scale, self.unit = stack.row_scale[index], stack.unit[index]

    def among(self, which: Mask) -> StackElements:
        """Some of them."""
        return StackElements(self._stack, self._q, self.element[which], self.index[which])

    def start(self) -> Matrix:
        """Their own coordinates (E, c)."""
        return np.asarray(self._q[self._row, self._coordinates])

    def at(self, own: Matrix) -> Any:
        """Their constraints at own coordinates (E, c)."""
        return self._stack.part.evaluator.at(self._whole(own))

    def residual_of(self, at: Any) -> Matrix:
        """The rows (E, m) of each."""
        return np.asarray(self._stack.part.evaluator.residual(at)[self._row, self._rows])

    def jacobian(self, at: Any) -> Matrix:
        """Their derivatives (E, m, n), dimensionless."""
        K = self._stack.part.evaluator.jacobian(at)
        blocks = K[self._row[:, :, None], self._rows[:, :, None], self._columns[:, None]]
        return np.asarray(self.row_scale[:, :, None] * blocks * self.unit[:, None])

    def jacobian_at(self, own: Matrix) -> Matrix:
        """The same at own coordinates (E, c)."""
        return self.jacobian(self.at(own))

    def room(self, own: Matrix, limits: PositionLimits) -> tuple[Matrix, Matrix]:
        """As `PositionLimits.room` of their velocities (E, n)."""
        down, up = limits.room(self._whole(own))
        return down[self._row, self._velocities], up[self._row, self._velocities]

    def exceeds(self, own: Matrix, limits: PositionLimits) -> bool:
        """Whether a configuration with these coordinates is beyond a limit."""
        return limits.are_exceeded(self._whole(own))

    def clipped(self, own: Matrix, limits: PositionLimits) -> Matrix:
        """Their coordinates within the limits."""
        return np.asarray(limits.clip(self._whole(own))[self._row, self._coordinates])

    def moved(self, own: Matrix, steps: Matrix) -> Matrix:
        """Their coordinates after dimensionless steps (E, n)."""
        v = np.zeros((len(self._q), self._stack.tree.nv))
        v[self._row, self._velocities] = self.unit * steps
        return np.asarray(self._stack.tree.integrate(self._whole(own), v)[self._row, self._coordinates])

    def _whole(self, own: Matrix) -> Matrix:
        q = np.array(self._q)
        q[self._row, self._coordinates] = own
        return q
