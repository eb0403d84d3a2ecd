"""Arguments of the batch functions, checked."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.kinematics.array import Matrix
from eurdf.kinematics.assembly import start
from eurdf.kinematics.batch.problem import problem
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def shape_of(given: Any) -> tuple[int, ...]:
    """The shape of the given numbers; () for lists of unequal length, which have none."""
    try:
        return np.shape(given)
    except ValueError:
        return ()


def checked_rows(name: str, given: Any, width: int) -> Matrix:
    """The given numbers as an array (B, width).

    Raises:
        ValueError: It has another shape, or something in it is not a finite number.
    """
    shape = shape_of(given)
    if len(shape) == 2 and shape[1] == width:
        return checked_array(name, given, shape)
    if shape == (0,):
        return np.empty((0, width))
    raise ValueError(f"{name} has the shape {shape}; expected (B, {width}): one row for each element")


def checked_configurations(robot: Robot, name: str, given: Any) -> Matrix:
    """The given configurations (B, nq), normalized.

    Raises:
        ValueError: They have another shape, are not finite, or one of them cannot be normalized.
    """
    q = checked_rows(name, given, robot.tree.nq)
    with np.errstate(all="ignore"):
        normal = problem(robot).tree.normalized(q.T).T
    wrong = np.flatnonzero(~np.isfinite(normal).all(axis=1))
    if len(wrong):
        start(robot, q[wrong[0]], f"{name}[{wrong[0]}]")
    return np.ascontiguousarray(normal)


def starts(robot: Robot, q0: Any, count: int) -> tuple[Matrix, bool]:
    """The configurations (B, nq) to start at, and whether they are all the same.

    Args:
        robot: The robot.
        q0: One configuration (nq,), one for each element (B, nq), or None for `assembled` or the neutral one.
        count: B.

    Raises:
        ValueError: As in `checked_configurations`, or their number is not B.
    """
    if q0 is None or len(shape_of(q0)) == 1:
        q = start(robot, q0)
        return np.broadcast_to(q, (count, len(q))), True
    q = checked_configurations(robot, "q0", q0)
    if len(q) != count:
        raise ValueError(f"q0 has {len(q)} rows; expected {count}, one for each element, or one configuration")
    return q, False
