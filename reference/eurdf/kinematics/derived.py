"""What is computed from a robot, or from its tree, once and kept with it."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from types import TracebackType
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_T = TypeVar("_T")


class _Keeper(Protocol):
    @property
    def derived(self) -> dict[Any, Any]: ...


_Kept = TypeVar("_Kept", bound=_Keeper)


def derived(robot: _Kept, compute: Callable[..., _T], *key: Hashable) -> _T:
    """What a function computes from a robot or a tree, and a key, computed when first asked for.

    Threads that ask at once all get the same.
    """
    name = (compute, *key) if key else compute
    if name not in robot.derived:
        robot.derived.setdefault(name, compute(robot, *key))
    kept: _T = robot.derived[name]
    return kept


# Of working memory of one kind, kept for so many keys at most, and for each key so much for as many threads.
_MOST_KEYS = 8
_MOST_IDLE = 4


class borrowed(Generic[_T]):  # noqa: N801 - used like a function
    """Working memory ``make(robot, *key)``, which no other thread uses meanwhile; it is kept for the next caller.

    Results must not depend on what it was used for before. After an error it is not kept.
    """

    __slots__ = ("_idle", "_memory")

    def __init__(self, robot: Robot, make: Callable[..., _T], *key: Hashable) -> None:
        try:
            idle: list[_T] = robot.derived[borrowed, make][key]
        except KeyError:
            kept = robot.derived.setdefault((borrowed, make), {})
            if len(kept) >= _MOST_KEYS:
                kept.clear()
            idle = kept.setdefault(key, [])
        self._idle = idle
        try:
            memory = idle.pop()
        except IndexError:
            memory = make(robot, *key)
        self._memory = memory

    def __enter__(self) -> _T:
        return self._memory

    def __exit__(self, kind: Any, error: BaseException | None, trace: TracebackType | None) -> None:
        if error is None and len(self._idle) < _MOST_IDLE:
            self._idle.append(self._memory)
