"""What is computed from a robot, or from its tree, once and kept with it, and memory that is lent to one thread."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from types import TracebackType
from typing import Any, Generic, TypeVar

_T = TypeVar("_T")


class Cached:
    """What keeps what functions compute from it.

    Attributes:
        derived: What was computed, by function and key.
    """

    derived: dict[Any, Any]

    def cached(self, compute: Callable[..., _T], *key: Hashable) -> _T:
        """What a function computes from this and a key, computed when first asked for.

        Threads that ask at once all get the same.
        """
        name = (compute, *key) if key else compute
        if name not in self.derived:
            self.derived.setdefault(name, compute(self, *key))
        kept: _T = self.derived[name]
        return kept


# Of working memory of one kind, kept for so many keys at most, and for each key so much for as many threads.
_MOST_KEYS = 8
_MOST_IDLE = 4


class working_memory(Generic[_T]):  # noqa: N801 - used like a function
    """Working memory ``make(robot, *key)``, which no other thread uses meanwhile; it is kept for the next caller.

    Results must not depend on what it was used for before. After an error it is not kept.
    """

    __slots__ = ("_idle", "_memory")

    def __init__(self, robot: Cached, make: Callable[..., _T], *key: Hashable) -> None:
        try:
            idle: list[_T] = robot.derived[working_memory, make][key]
        except KeyError:
            kept = robot.derived.setdefault((working_memory, make), {})
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
