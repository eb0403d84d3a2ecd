"""What is computed from a robot once and kept with it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_T = TypeVar("_T")


def derived(robot: Robot, compute: Callable[[Robot], _T]) -> _T:
    """What a function computes from a robot alone, computed when first asked for.

    Threads that ask at once all get the same.
    """
    if compute not in robot.derived:
        robot.derived.setdefault(compute, compute(robot))
    kept: _T = robot.derived[compute]
    return kept
