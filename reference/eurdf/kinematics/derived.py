"""What is computed from a robot once and kept with it."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
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


# Of working memory of one kind, kept for so many keys at most, and for each key so much for as many threads.
_MOST_KEYS = 8
_MOST_IDLE = 4


@contextmanager
def borrowed(robot: Robot, make: Callable[..., _T], *key: Hashable) -> Iterator[_T]:
    """Working memory ``make(robot, *key)``, which no other thread uses meanwhile; it is kept for the next caller.

    Results must not depend on what it was used for before.
    """
    kept: dict[tuple[Hashable, ...], list[_T]] = robot.derived.setdefault((borrowed, make), {})
    try:
        memory = kept[key].pop()
    except (KeyError, IndexError):
        memory = make(robot, *key)
    yield memory  # not kept after an error
    if key not in kept and len(kept) >= _MOST_KEYS:
        kept.clear()
    idle = kept.setdefault(key, [])
    if len(idle) < _MOST_IDLE:
        idle.append(memory)
