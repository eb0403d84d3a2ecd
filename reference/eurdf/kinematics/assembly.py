"""Assembly: a configuration in which every loop is closed.

Damped Gauss-Newton steps on the configuration manifold bring the residual to zero; `eurdf.kinematics.closing` takes
them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.errors import NotClosable
from eurdf.kinematics.closing import close, start
from eurdf.kinematics.named import Named
from eurdf.kinematics.opening import Opening
from eurdf.kinematics.position_limit import JointAtLimit, PositionLimits, chosen_limits
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.tolerances import MOST_WORK, RESTARTS, SOLVED
from eurdf.pinocchio.arguments import as_names, checked_count, checked_tolerance
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Why an assembly did not converge: joints at their limits keep the loops open; the loops stay open though no limit
#: prevents closing; the search reached its limit of work, so that it is unknown whether the loops can close;
#: or the loops close, but rounded numbers in the files make redundant rows contradict each other.
AssemblyReason = Literal["joint limits", "not closed", "not decided", "rounding"]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Assembly:
    """The result of `assemble`.

    Attributes:
        q: Configuration (nq,): closed, or the least open one found.
        residual: Euclidean norm of the residual at q, m and rad.
        converged: Whether every row of the residual is within ``tolerance``.
        closes: Whether each closure is open by at most `CLOSED`, m and rad, as required of a configuration in a file;
            in robots with a characteristic length L below 1 cm, by at most 1e-4 L. If a robot closes but does not
            converge, rounded numbers in its files make redundant rows contradict each other.
        iterations: Number of evaluations of the residual and its Jacobian.
        open: How far each closure is open at q, in file order.
        reason: Why it did not converge; None if it did.
        at_limits: The joints that are at their limits at q and would have to exceed them to close the loops further;
            empty if the loops close.
    """

    q: Vector
    residual: float
    converged: bool
    closes: bool
    iterations: int
    open: tuple[Opening, ...]
    reason: AssemblyReason | None = None
    at_limits: tuple[JointAtLimit, ...] = ()

    def __repr__(self) -> str:
        is_open = ", ".join(str(found) for found in self.open if found.is_open)
        parts = [f"open: {is_open}" if is_open else "closed", f"residual {self.residual:.3g} m, rad"]
        if self.reason == "rounding":
            parts.append("not converged: rounding makes redundant rows contradict each other")
        if self.reason == "not decided":
            parts.append("not decided: the search reached its limit of work")
        if self.at_limits:
            parts.append(f"at their limits: {', '.join(map(str, self.at_limits))}")
        return f"<Assembly: {'; '.join(parts)}; {self.iterations} iterations>"


def assemble(
    robot: Robot,
    q0: Named | None = None,
    *,
    hold: str | Iterable[str] = (),
    tolerance: float = SOLVED,
    limits: bool = False,
    restarts: int = RESTARTS,
) -> Assembly:
    """Find a closed configuration, r(q) = 0, near the given one.

    Each step x solves (KᵀK + μ 1) x = -Kᵀ r, and q becomes q ⊕ x (Levenberg, *A method for the solution of certain
    non-linear problems in least squares*, 1944; Marquardt, 1963), with the residual r and the K of EU-CLO-008 to -010.

    Only joints of the loops move. The result is deterministic. The work is bounded even if the loops cannot be closed:
    at most ``restarts`` + 2 descents of at most 60 steps, and 1e10 multiplications, about five seconds. If loops are
    still open at this limit, `Assembly.reason` is ``"not decided"``.

    The structure of the robot is analysed once and kept with it.

    Args:
        robot: The robot.
        q0: Where to start (nq,). The default is the `assembled` configuration, or the neutral one if there is none.
        hold: Names of joints that do not move, or one name. A mimic joint is held with its leader.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
        limits: Whether to respect the position limits of joints whose coordinates are angles or lengths. A start
            outside the limits is clipped first. Limits that are both 0 are no range (`urdf-no-range`).
        restarts: Maximum number of restarts while loops are open by more than `CLOSED`.

    Returns:
        The closed configuration, or the least open one found.

    Raises:
        ValueError: ``q0`` is not a configuration, ``hold`` has a name that is not a joint of the model, or
            ``tolerance`` or ``restarts`` is negative.
    """
    q = start(robot, q0)
    held = tuple(velocity for name in as_names(hold) for velocity in robot.tree.velocities_of(name))
    tolerance, chosen = checked_tolerance(tolerance), chosen_limits(robot, limits)
    restarts = checked_count("restarts", restarts, 0)
    with working_memory(robot, Problem, *([held] if held else [])) as problem:  # others use one that holds none, too
        return assembled(problem, q, tolerance, restarts, chosen)


def assembled(
    problem: Problem, q: Vector, tolerance: float, restarts: int = RESTARTS, limits: PositionLimits | None = None
) -> Assembly:
    """As `assemble`, from a configuration (nq,)."""
    if limits is not None and problem.groups:
        q = limits.clip(q, np.concatenate([group.loops.velocities for group in problem.groups]))
    closed = close(problem, q[None], tolerance, restarts, limits)
    with np.errstate(over="ignore", invalid="ignore"):
        (r,), found = problem.residual(closed.q), openings(problem, closed.q)
    closes = bool(closed.closes[0])
    converged = float(np.abs(r).max(initial=0.0)) <= tolerance
    at_limits = () if closes or limits is None else _pressed(problem, closed.q, limits)
    reason: AssemblyReason | None = None
    if not converged:
        why_open: AssemblyReason = "joint limits" if at_limits else "not closed"
        reason = "rounding" if closes else why_open if closed.decided[0] else "not decided"
    return Assembly(
        q=closed.q[0],
        residual=math.hypot(*r.tolist()),
        converged=converged,
        closes=closes,
        iterations=int(closed.iterations[0]),
        open=found,
        reason=reason,
        at_limits=at_limits,
    )


def closed_start(problem: Problem, q: Vector, tolerance: float, where: str = "the start") -> Vector:
    """A configuration (nq,), with its loops closed.

    Raises:
        NotClosable: They cannot be closed there.
    """
    closed = close(problem, q[None], tolerance)
    if closed.closes[0]:
        return np.array(closed.q[0])
    first = assembled(problem, q, tolerance)
    if not first.closes:
        raise NotClosable(f"no closed configuration was found near {where}", first.open, first.q)
    return first.q


def openings(problem: Problem, q: Matrix) -> tuple[Opening, ...]:
    """How far each constraint is open at a configuration (1, nq)."""
    return opened(problem, *problem.openings(q))


def opened(problem: Problem, lengths: Matrix, angles: Matrix) -> tuple[Opening, ...]:
    """How far each constraint is open, by the lengths (1, c), m, and the angles (1, c), rad."""
    return tuple(map(Opening, problem.names, lengths[0].tolist(), angles[0].tolist()))


@np.errstate(over="ignore", invalid="ignore")
def _pressed(problem: Problem, q: Matrix, limits: PositionLimits) -> tuple[JointAtLimit, ...]:
    """The joints at their limits that the descent direction -Kᵀ r would move beyond them at q (1, nq)."""
    down = np.zeros(problem.tree.nv)
    for group in problem.together:
        if group.work <= MOST_WORK:
            at = group.evaluator.at(q)
            b = group.row_scale * group.evaluator.residual(at)[0]
            down[group.loops.velocities] = -group.jacobian(at)[0].T @ b
    return limits.pressed(q[0], down)
