"""Where springs bring a robot while its actuators are held, within the position limits of its passive joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Indices, Vector
from eurdf.kinematics.position_limit import driven_coordinates, position_limits
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.residual import residual, residual_and_jacobian
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale
from eurdf.kinematics.tolerances import MOST_STEPS, START
from eurdf.mechanism.joint import LIMIT_TOLERANCE

if TYPE_CHECKING:
    from eurdf.array import Matrix
    from eurdf.pinocchio.robot import Robot

_LONGEST = 0.3  # bound of the motion of a joint in one step (rad, or characteristic lengths)
_LAST = 1e-10  # a step below this (rad, or characteristic lengths) is the last one


@dataclass(frozen=True, slots=True)
class Rest:
    """Where the springs are at rest, or in equilibrium.

    Attributes:
        q: The closed configuration (nq,); None if none was found.
        pressed: Velocities whose coordinates the springs, or the loops, press against their limits.
    """

    q: Vector | None
    pressed: tuple[int, ...]


class SpringRest:
    """Finds the closed configuration at which the springs of a robot store the least energy.

    It is the minimum of ½ Σ k c² on the closed configurations with the other velocities still and the coordinates
    within their limits. Each step minimizes ½ Σ k (c + ċ)² under K v = -r, with the coordinates that it would take
    beyond their limits at them.
    """

    def __init__(self, robot: Robot, passive: Indices) -> None:
        """Prepare a robot of which only the velocities with the indices ``passive``, ascending, move."""
        length = characteristic_length(robot)
        self._robot = robot
        self._rows = row_scale(robot, length)
        self._free = passive
        self._unit = velocity_scale(robot, length)[self._free]
        driven, coordinates = robot.cached(driven_coordinates)
        self._bounded = np.flatnonzero(np.isin(self._free, driven))  # columns that drive one coordinate each
        self._coordinates = coordinates[self._free]
        limits, springs = position_limits(robot), robot.tree.springs
        self._lower, self._upper = limits.lower[self._free], limits.upper[self._free]
        acting = np.isin(springs.idx_v, self._free)
        root = np.sqrt(springs.stiffness[acting])
        self._pull = np.zeros((len(root), len(self._free)))
        columns = np.searchsorted(self._free, springs.idx_v[acting])
        self._pull[np.arange(len(root)), columns] = root * springs.ratio[acting] * self._unit[columns]
        self._root, self._acting = root, acting

    def near(self, q: Vector) -> Rest:
        """The rest near a configuration (nq,), which may be open by a small step of the held joints."""
        start = q[self._coordinates]
        lower, upper = np.minimum(self._lower, start), np.maximum(self._upper, start)
        pressed: dict[int, float] = {}
        for _ in range(MOST_STEPS):
            step, pressed = self._step(q, lower, upper)
            size = float(np.abs(step).max(initial=0.0))
            v = np.zeros(self._robot.tree.nv)
            v[self._free] = self._unit * step * min(1.0, _LONGEST / size if size else 1.0)
            q = self._robot.tree.normalized(self._robot.tree.integrate(q, v))
            if size <= _LAST:
                break
        at_limits = all(
            abs(q[self._coordinates[column]] - limit) <= LIMIT_TOLERANCE for column, limit in pressed.items()
        )
        closed = np.abs(residual(self._robot, q)).max(initial=0.0) <= START
        return Rest(q if closed and at_limits else None, tuple(int(self._free[column]) for column in pressed))

    def _step(self, q: Vector, lower: Vector, upper: Vector) -> tuple[Vector, dict[int, float]]:
        """A step (n,), dimensionless, and the columns whose coordinates it brings to limits, with these."""
        r, K = residual_and_jacobian(self._robot, q)
        K = self._rows[:, None] * K[:, self._free] * self._unit
        at = q[self._coordinates]
        bend = self._root * self._robot.tree.springs.deflection(q)[self._acting]
        pressed: dict[int, float] = {}
        released: set[int] = set()
        while True:
            columns, limits = list(pressed), np.array(list(pressed.values()))
            rows = np.vstack([K, np.eye(len(self._free))[columns]])
            wanted = np.concatenate([-self._rows * r, (limits - at[columns]) / self._unit[columns]])
            step, free = _solutions(rows, wanted)
            if len(pressed) > 1 and np.abs(rows @ step - wanted).max() > LIMIT_TOLERANCE:
                first = columns[0]  # they cannot all be at their limits: the first one has left its limit
                del pressed[first]
                released.add(first)
                continue
            z, _ = _solutions(self._pull @ free, -bend - self._pull @ step)
            step = step + free @ z
            after = at + self._unit * step
            over = np.maximum(after - upper, lower - after)
            over[[column for column in range(len(over)) if column in pressed or column in released]] = 0.0
            met = self._bounded[over[self._bounded] > LIMIT_TOLERANCE]
            if not len(met):
                return step, pressed
            column = int(met[np.argmax(over[met] / np.abs(after - at)[met])])
            pressed[column] = float(upper[column] if after[column] > upper[column] else lower[column])


def _solutions(A: Matrix, b: Vector) -> tuple[Vector, Matrix]:
    """The least solution of A x = b in the least squares sense, and the x of A x = 0 as columns."""
    left, values, right = np.linalg.svd(A)
    rank = numerical_rank(values)
    return right[:rank].T @ ((left[:, :rank].T @ b) / values[:rank]), right[rank:].T
