"""What the functions of this package need of a robot: plain data, which can be sent to another process."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.batch.stack import BatchStack, State
from eurdf.kinematics.batch.tree import BatchTree
from eurdf.kinematics.derived import derived
from eurdf.kinematics.loop import independent_groups
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# In a robot with at most this many velocities, all loops are closed at once before each group by itself, as in
# `eurdf.kinematics.assembly`.
_MOST_VELOCITIES_AT_ONCE = 60


@dataclass(frozen=True, eq=False)
class Group:
    """Loops that share joints, and the velocities that close them.

    Attributes:
        constraints: Indices of their constraints.
        stack: Their constraints.
        rows: Their rows in the residual of the whole robot.
        row_scale: Factors (m,) that make their rows dimensionless.
        unit: Unit (n,) of each velocity.
        coordinates: Indices in q of the joints that move.
    """

    constraints: tuple[int, ...]
    stack: BatchStack
    rows: Indices
    row_scale: Vector
    unit: Vector
    coordinates: Indices

    @cached_property
    def factors(self) -> Matrix:
        """Factors (m, n, 1) that make K dimensionless."""
        return np.asarray(self.row_scale[:, None] * self.unit)[:, :, None]

    def jacobian(self, at: State) -> Matrix:
        """K (m, n, B), dimensionless."""
        return np.asarray(self.stack.jacobian(at) * self.factors)


@dataclass(frozen=True, eq=False)
class Problem:
    """A robot for arrays of configurations.

    Attributes:
        tree: Its spanning tree.
        whole: All constraints, by all velocities.
        groups: Groups of loops that share no joint with the others.
        length: Characteristic length, m.
        row_scale: Factors (nc,) that make the rows of the residual dimensionless.
        scale: Unit (nv,) of each velocity: the length for one of a loop that only translates, else 1.
    """

    tree: BatchTree
    whole: BatchStack
    groups: tuple[Group, ...]
    length: float
    row_scale: Vector
    scale: Vector

    @property
    def at_once(self) -> bool:
        """Whether all loops are closed at once before each group by itself."""
        return self.tree.nv <= _MOST_VELOCITIES_AT_ONCE

    def residual(self, q: Matrix) -> Matrix:
        """The residual (nc, B), m and rad."""
        return self.whole.residual(self.whole.at(q))


def problem(robot: Robot) -> Problem:
    """The problem of a robot, made once."""
    return derived(robot, _problem)


def _problem(robot: Robot) -> Problem:
    tree, length = BatchTree(robot), characteristic_length(robot)
    rows, scale = row_scale(robot, length), velocity_scale(robot, length)
    whole = _stack(robot, tree, range(len(robot.constraints)), np.arange(tree.nv))
    return Problem(tree, whole, _groups(robot, tree, (), rows, scale), length, rows, scale)


def held_groups(robot: Robot, held: Iterable[int]) -> tuple[Group, ...]:
    """The groups of a robot's loops while the velocities with these indices are zero."""
    found = problem(robot)
    return _groups(robot, found.tree, held, found.row_scale, found.scale)


def _groups(robot: Robot, tree: BatchTree, held: Iterable[int], rows: Vector, scale: Vector) -> tuple[Group, ...]:
    return tuple(
        Group(
            group.closures,
            _stack(robot, tree, group.closures, group.velocities),
            group.rows,
            rows[group.rows],
            scale[group.velocities],
            group.coordinates,
        )
        for group in independent_groups(robot, held)
    )


def driving_stack(robot: Robot, group: Group, given: Indices) -> BatchStack:
    """The constraints of a group, with columns for those of the given velocities that move its joints."""
    moving = np.intersect1d(given, group.stack.moving)
    return _stack(robot, problem(robot).tree, group.constraints, moving)


def _stack(robot: Robot, tree: BatchTree, constraints: Sequence[int], velocities: Indices) -> BatchStack:
    chosen = [robot.constraints[index] for index in constraints]
    coordinates = {name: robot.tree.coordinate(name) for each in chosen for name in each.joints}
    return BatchStack(tree, chosen, velocities, coordinates)
