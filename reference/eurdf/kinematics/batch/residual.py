"""The residual of the constraints and its derivative at many configurations."""

from __future__ import annotations

from concurrent.futures import Executor
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.batch.arguments import checked_rows
from eurdf.kinematics.batch.blocks import Progress, blocks
from eurdf.kinematics.derived import derived
from eurdf.kinematics.evaluate import Evaluator, evaluator
from eurdf.kinematics.exceptions import NumericalOverflow

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def residual(
    robot: Robot,
    q: Matrix,
    *,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Matrix:
    """Residual of all constraints at B configurations, as `eurdf.residual` has it.

    Args:
        robot: The robot.
        q: Configurations (B, nq).
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        r (B, nc), m and rad.

    Raises:
        ValueError: An argument has a wrong shape or is not finite.
        NotImplementedError: A joint or constraint has a type that is not supported.
        NumericalOverflow: A configuration is so large that its residual is not finite; the message names it.
    """
    rows = checked_rows("q", q, robot.tree.nq)
    constraints = derived(robot, _constraints)
    (r,) = blocks(constraints.numbers_of_residual, block, threads, executor, progress).map(
        _residual, constraints, (rows,)
    )
    _require_finite(r)
    return r


def residual_and_jacobian(
    robot: Robot,
    q: Matrix,
    *,
    block: int | None = None,
    threads: int = 1,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> tuple[Matrix, Matrix]:
    """Residual of all constraints and its derivative at B configurations, as `eurdf.residual_and_jacobian` has them.

    Args:
        robot: The robot.
        q: Configurations (B, nq).
        block: See `eurdf.batch.forward_kinematics`, also for the following ones.
        threads: Number of threads.
        executor: Who works on blocks instead.
        progress: Called after each block.

    Returns:
        r (B, nc), and K (B, nc, nv), in m and rad over the units of v.

    Raises:
        ValueError: As in `residual`.
        NotImplementedError: As in `residual`.
        NumericalOverflow: As in `residual`, also of the derivative.
    """
    rows = checked_rows("q", q, robot.tree.nq)
    constraints = derived(robot, _constraints)
    work = blocks(constraints.numbers, block, threads, executor, progress)
    r, K = work.map(_residual_and_jacobian, constraints, (rows,))
    _require_finite(r, K)
    return r, K


def _constraints(robot: Robot) -> Evaluator:
    return evaluator(robot, few=False)


def _residual(constraints: Evaluator, q: Matrix) -> tuple[Matrix]:
    return (constraints.residual(constraints.at(q)),)


def _residual_and_jacobian(constraints: Evaluator, q: Matrix) -> tuple[Matrix, Matrix]:
    at = constraints.at(q)
    return constraints.residual(at), constraints.jacobian(at)


def _require_finite(*results: Matrix) -> None:
    wrong = np.any([~np.isfinite(result).all(axis=tuple(range(1, result.ndim))) for result in results], axis=0)
    if wrong.any():
        raise NumericalOverflow(f"the residual at q[{int(wrong.argmax())}]")
