"""Results that are finite, or an error."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

import numpy as np

from eurdf.array import Matrix
from eurdf.errors import NumericalOverflow
from eurdf.pinocchio.arguments import all_finite

_P = ParamSpec("_P")
_R = TypeVar("_R")


def finite(result: str, *arrays: Matrix) -> None:
    """Refuse arrays that are not finite.

    Raises:
        NumericalOverflow: A number is not finite.
    """
    for array in arrays:
        if not all_finite(array):
            raise NumericalOverflow(result)


def overflow_refused(result: str) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """Decorate a function to raise `NumericalOverflow` where a decomposition fails, without NumPy's warnings.

    A decomposition of finite numbers fails only if an intermediate result overflows.
    """

    def decorated(function: Callable[_P, _R]) -> Callable[_P, _R]:
        silent = np.errstate(over="ignore", invalid="ignore", divide="ignore")(function)

        @wraps(function)
        def refusing(*args: _P.args, **options: _P.kwargs) -> _R:
            try:
                return silent(*args, **options)
            except np.linalg.LinAlgError:
                raise NumericalOverflow(result) from None

        return refusing

    return decorated
