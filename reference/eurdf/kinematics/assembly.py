"""Assembly: a configuration in which every loop is closed.

The residual is brought to zero by damped Gauss-Newton steps on the configuration manifold, each group of loops that
share joints on its own. Where a descent ends open, as it may from a straight or symmetric configuration, the group
starts again from places drawn around the first.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Matrix, Vector
from eurdf.kinematics.descent import Descent
from eurdf.kinematics.loop import LoopGroup, independent_groups
from eurdf.kinematics.position_limit import position_limits
from eurdf.kinematics.residual import Opening, closure_openings, residual, residual_and_jacobian
from eurdf.kinematics.scale import characteristic_length, row_scale, velocity_scale

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: What each row of the residual may be, m or rad, where a description says that the loops are closed.
CLOSED = 1e-6

# Above this many velocities a pin.Data, some 8 nv³ numbers, takes longer to make than it saves.
_MOST_VELOCITIES_WITH_DATA = 60

_MOST_STEPS = 60

# Multiplications that one assembly may take in its steps, some ten seconds. Loops that share joints by the hundred are
# given up earlier than after all restarts.
_MOST_WORK = 2e10

# How far from the first place further descents start (rad, or characteristic lengths); the last one is repeated.
_SPREADS = (0.1, 0.3, 1.0, 2.0, 3.0)


@dataclass(frozen=True, slots=True, eq=False)
class Assembly:
    """What `assemble` found.

    Attributes:
        q: Configuration (nq,): closed, or the least open one found.
        residual: Euclidean norm of the residual at q, m and rad.
        converged: Whether every row of the residual is within the tolerance asked for.
        closes: Whether every row is within `CLOSED`, all that is asked of a configuration in a file. What closes but
            does not converge has redundant rows that contradict one another by the rounding of numbers in its files.
        iterations: Number of evaluations of the residual and its Jacobian.
        open: How far each closure is open at q, in their order.
    """

    q: Vector
    residual: float
    converged: bool
    closes: bool
    iterations: int
    open: tuple[Opening, ...]


def assemble(
    robot: Robot,
    q0: Vector | None = None,
    hold: Iterable[str] = (),
    *,
    tolerance: float = 1e-10,
    limits: bool = False,
    restarts: int = 20,
) -> Assembly:
    """Find a closed configuration near the one given.

    Only joints of the loops move. The same arguments give the same answer. The time is bounded also where the loops
    cannot be closed: by ``restarts`` + 1 descents of at most 60 steps, and fewer where hundreds of loops share joints.

    Args:
        robot: The robot.
        q0: Where to start (nq,). The `assembled` configuration by default, or else the neutral one.
        hold: Names of joints that stay where they are. A joint that mimics another is held with that one.
        tolerance: What each row of the residual may be, m or rad, where the loops are closed.
        limits: Whether to stay within the position limits of the joints whose coordinates are plain angles or lengths;
            where the start is outside of them it is brought to the nearest limit first.
        restarts: How often to start again, at most, where loops are still open by more than `CLOSED`.

    Returns:
        The closed configuration, or the least open one found.

    Raises:
        ValueError: ``q0`` is no configuration, or ``hold`` names no joint of the model.
    """
    return Assembler(robot, hold, tolerance=tolerance, limits=limits).assemble(start(robot, q0), restarts)


def start(robot: Robot, q0: Vector | None = None) -> Vector:
    """The configuration given, checked and normalised; else `assembled`, else the neutral one.

    Raises:
        ValueError: It is not (nq,), not finite, or cannot be normalised.
    """
    model = robot.model
    if q0 is None:
        q0 = robot.configurations.get("assembled")
    if q0 is None:
        return np.array(pin.neutral(model))
    q = np.asarray(q0, dtype=np.float64)
    if q.shape != (model.nq,):
        raise ValueError(f"a configuration of this robot has the shape ({model.nq},), not {q.shape}")
    if not np.isfinite(q).all():
        raise ValueError("a configuration has a number that is not finite")
    q = np.array(pin.normalize(model, q))
    if not np.isfinite(q).all() or not pin.isNormalized(model, q, 1e-9):
        raise ValueError("a configuration has a quaternion, or a cosine and sine, of length zero")
    return q


class Assembler:
    """Closes the loops of one robot, any number of times, having looked at its structure once.

    Groups of loops that share no joint descend each on its own, all in the same evaluations.

    Attributes:
        groups: The groups.
        iterations: Evaluations of the residual and its Jacobian so far.
    """

    def __init__(
        self, robot: Robot, hold: Iterable[str] = (), *, tolerance: float = 1e-10, limits: bool = False
    ) -> None:
        """For the arguments see `assemble`."""
        model, length = robot.model, characteristic_length(robot)
        self.groups = independent_groups(robot, _held_velocities(model, hold))
        self.iterations = 0
        self._robot = robot
        self._data = model.createData() if model.nv <= _MOST_VELOCITIES_WITH_DATA else None
        self._row_scale = row_scale(robot, length)
        self._velocity_scale = velocity_scale(robot, length)
        self._tolerance = tolerance
        self._work = 0.0
        self._limits = position_limits(model) if limits else None

    def assemble(self, q: Vector, restarts: int = 20) -> Assembly:
        """Close the loops, starting from q (nq,) and then, up to ``restarts`` times, from around it."""
        with np.errstate(over="ignore", invalid="ignore"):  # lengths such as 1e200 m overflow, and so never close
            return self._assemble(q, restarts)

    def _assemble(self, q: Vector, restarts: int) -> Assembly:
        before, random = self.iterations, np.random.default_rng(0)
        self._work = 0.0
        q = self._within_limits(q, self.groups)
        best, errors = np.array(q), np.full(len(self.groups), math.inf)
        for attempt in range(restarts + 1):
            still_open = [index for index, error in enumerate(errors) if not error <= CLOSED]
            if not still_open or (attempt > 0 and self._work > _MOST_WORK):
                break
            groups, place = [self.groups[index] for index in still_open], q
            if attempt > 0:
                spread = _SPREADS[min(attempt, len(_SPREADS)) - 1]
                away = [random.uniform(-spread, spread, len(group.velocities)) for group in groups]
                place = self._within_limits(self.moved(q, groups, away), groups)
            end, reached = self._descend(place, groups)
            for index, group, error in zip(still_open, groups, reached, strict=True):
                if error < errors[index]:
                    errors[index] = error
                    best[group.coordinates] = end[group.coordinates]
        r = residual(self._robot, best, self._data)
        largest = float(np.abs(r).max(initial=0.0))
        return Assembly(
            q=best,
            residual=math.hypot(*r),
            converged=largest <= self._tolerance,
            closes=largest <= max(CLOSED, self._tolerance),
            iterations=self.iterations - before,
            open=closure_openings(self._robot, best, self._data),
        )

    def evaluate(self, q: Vector) -> tuple[Vector, Matrix]:
        """Residual (nc,) and Jacobian (nc, nv) at q (nq,)."""
        self.iterations += 1
        return residual_and_jacobian(self._robot, q, self._data)

    def scaled(self, K: Matrix, group: LoopGroup) -> Matrix:
        """The block of K of a group of loops, lengths counted in characteristic lengths."""
        block = K[np.ix_(group.rows, group.velocities)]
        return self._row_scale[group.rows, None] * block * self._velocity_scale[group.velocities]

    def moved(self, q: Vector, groups: Sequence[LoopGroup], steps: Sequence[Vector]) -> Vector:
        """Configuration (nq,) after a step of each group, lengths counted in characteristic lengths."""
        v = np.zeros(self._robot.model.nv)
        for group, step in zip(groups, steps, strict=True):
            v[group.velocities] = self._velocity_scale[group.velocities] * step
        return np.asarray(pin.normalize(self._robot.model, pin.integrate(self._robot.model, q, v)))

    def _descend(self, q: Vector, groups: Sequence[LoopGroup]) -> tuple[Vector, list[float]]:
        """Where the descents of the groups lead to, and the norm of the residual of each there."""
        q = np.array(q)
        r, K = self.evaluate(q)
        descents = [Descent(group, *self._part(r, K, group)) for group in groups]
        for _ in range(_MOST_STEPS):
            going = [descent for descent in descents if descent.error > self._tolerance and not descent.stuck]
            self._work += sum(_work_of_step(descent.group) for descent in going)
            if not going or self._work > _MOST_WORK:
                break
            steps = [descent.step(*self._room(q, descent.group)) for descent in going]
            trial = self.moved(q, [descent.group for descent in going], steps)
            r, K = self.evaluate(trial)
            for descent in going:
                if descent.accept(*self._part(r, K, descent.group)):
                    q[descent.group.coordinates] = trial[descent.group.coordinates]
        return q, [descent.error for descent in descents]

    def _part(self, r: Vector, K: Matrix, group: LoopGroup) -> tuple[Vector, Matrix, Vector]:
        """Residual of a group in m and rad, its block of K, scaled, and its residual, scaled."""
        part = r[group.rows]
        return part, self.scaled(K, group), self._row_scale[group.rows] * part

    def _within_limits(self, q: Vector, groups: Sequence[LoopGroup]) -> Vector:
        if self._limits is not None:
            for group in groups:
                q = self._limits.clip(q, group.velocities)
        return q

    def _room(self, q: Vector, group: LoopGroup) -> tuple[Vector, Vector]:
        """How far the velocities of a group may go down and up, in rad and characteristic lengths."""
        if self._limits is None:
            return np.full(len(group.velocities), -np.inf), np.full(len(group.velocities), np.inf)
        down, up = self._limits.room(q, group.velocities)
        unit = self._velocity_scale[group.velocities]
        return down / unit, up / unit


def _work_of_step(group: LoopGroup) -> float:
    """Multiplications that the smaller one of A Aᵀ and Aᵀ A takes."""
    m, n = len(group.rows), len(group.velocities)
    return float(m) * n * min(m, n)


def _held_velocities(model: Any, names: Iterable[str]) -> list[int]:
    held: list[int] = []
    for name in names:
        if not model.existJointName(name):
            near = difflib.get_close_matches(name, list(model.names), n=1)
            raise ValueError(f"the model has no joint '{name}'" + (f"; did you mean '{near[0]}'?" if near else ""))
        joint = model.joints[model.getJointId(name)]
        held.extend(range(joint.idx_v, joint.idx_v + joint.nvExtended))
    return held
