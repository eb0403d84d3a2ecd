"""Ways in which one function is, for a while, another."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from functools import wraps
from typing import Any
from unittest.mock import patch

Deviation = AbstractContextManager[Any]


def instead(owner: Any, name: str, other: Any) -> Deviation:
    """Another function, or constant, in place of one.

    Args:
        owner: The module or class that has it; where it is called from, if it was imported by name.
        name: Its name there.
        other: The other one.
    """
    return patch.object(owner, name, other)


def around(owner: Any, name: str, other: Callable[..., Any]) -> Deviation:
    """Another function, which is given the original one before the arguments."""
    original = getattr(owner, name)

    @wraps(original)
    def called(*arguments: Any, **named: Any) -> Any:
        return other(original, *arguments, **named)

    return patch.object(owner, name, called)


def result(owner: Any, name: str, change: Callable[[Any], Any]) -> Deviation:
    """The same function, whose result is changed."""
    return around(owner, name, lambda original, *arguments, **named: change(original(*arguments, **named)))


@contextmanager
def together(*deviations: Deviation) -> Iterator[None]:
    """Several deviations that make one."""
    with ExitStack() as stack:
        for deviation in deviations:
            stack.enter_context(deviation)
        yield
