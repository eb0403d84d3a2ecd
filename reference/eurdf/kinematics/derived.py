"""What is computed from a robot once and kept with it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
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


# Number of idle workspaces kept of each kind, each with its pin.Data.
_MOST_IDLE = 4


@contextmanager
def borrowed(robot: Robot, make: Callable[[Robot], _T]) -> Iterator[_T]:
    """A workspace made of a robot alone, which no other thread uses meanwhile; it is kept for the next caller.

    Results must not depend on what it was used for before.
    """
    idle: list[_T] = robot.derived.setdefault((borrowed, make), [])
    try:
        workspace = idle.pop()
    except IndexError:
        workspace = make(robot)
    yield workspace  # not kept after an error
    if len(idle) < _MOST_IDLE:
        idle.append(workspace)
