"""Results that are finite, or an error."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from types import TracebackType
from typing import Any, ParamSpec, TypeVar

import numpy as np

from eurdf.errors import NumericalOverflow
from eurdf.kinematics.array import Matrix

_P = ParamSpec("_P")
_R = TypeVar("_R")


def finite(result: str, *arrays: Matrix) -> None:
    """Refuse arrays that are not finite.

    Raises:
        NumericalOverflow: A number is not finite.
    """
    if not all(np.isfinite(array).all() for array in arrays):
        raise NumericalOverflow(result)


class overflow_refused:  # noqa: N801 - used like a function
    """Raise `NumericalOverflow` where a decomposition fails, and silence NumPy's warnings of overflow.

    A decomposition of finite numbers fails only if an intermediate result overflows. It is a context manager and a
    decorator.
    """

    __slots__ = ("_result", "_silent")

    def __init__(self, result: str) -> None:
        self._result = result
        self._silent = np.errstate(over="ignore", invalid="ignore", divide="ignore")

    def __enter__(self) -> None:
        self._silent.__enter__()

    def __exit__(self, kind: Any, error: BaseException | None, trace: TracebackType | None) -> None:
        self._silent.__exit__(kind, error, trace)
        if isinstance(error, np.linalg.LinAlgError):
            raise NumericalOverflow(self._result) from None

    def __call__(self, function: Callable[_P, _R]) -> Callable[_P, _R]:
        """The function, within such a context of its own at each call."""

        @wraps(function)
        def refusing(*args: _P.args, **kwargs: _P.kwargs) -> _R:
            with overflow_refused(self._result):
                return function(*args, **kwargs)

        return refusing
