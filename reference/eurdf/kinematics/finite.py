"""Results that are finite, or an error."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from eurdf.array import Matrix
from eurdf.errors import NumericalOverflow


def finite(result: str, *arrays: Matrix) -> None:
    """Refuse arrays that are not finite.

    Raises:
        NumericalOverflow: A number is not finite.
    """
    if not all(np.isfinite(array).all() for array in arrays):
        raise NumericalOverflow(result)


@contextmanager
def overflow_refused(result: str) -> Iterator[None]:
    """Raise `NumericalOverflow` where a decomposition fails, and silence NumPy's warnings of overflow.

    A decomposition of finite numbers fails only if an intermediate result overflows. It is a context manager and a
    decorator.
    """
    try:
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            yield
    except np.linalg.LinAlgError:
        raise NumericalOverflow(result) from None
