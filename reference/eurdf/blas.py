"""One thread for BLAS while the library computes.

OpenBLAS divides products of some 64 × 64 numbers among threads, which wait for each other in loops. The matrices of a
robot gain nothing from it, and on a busy machine a product of microseconds takes milliseconds. The number of threads is
one for the whole process, so that it is changed only while a function of the library computes, and restored afterwards;
meanwhile products of the caller's other threads have one thread, too.

Only OpenBLAS is known, which the wheels of NumPy contain. Other libraries keep their threads.
"""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable
from functools import cached_property
from types import TracebackType
from typing import Any

from numpy.linalg import _umath_linalg

_NAMES = tuple(f"{prefix}openblas_{{}}_num_threads{suffix}" for prefix in ("scipy_", "") for suffix in ("64_", ""))

#: A robot of fewer velocities has no matrix that OpenBLAS divides.
MANY_VELOCITIES = 64


class _OneThread:
    """A context in which BLAS has one thread; any number of threads can be in it."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._inside = 0  # how many
        self._before = 1  # threads of BLAS, before the first of them

    @cached_property
    def _functions(self) -> tuple[Callable[[], int], Callable[[int], Any]] | None:
        """Those that tell and set the number of threads; None if BLAS has none of a known name."""
        try:
            library = ctypes.CDLL(_umath_linalg.__file__)  # a name is looked up in what it is linked with, too
        except OSError:
            return None
        for name in _NAMES:
            if hasattr(library, name.format("set")):
                return getattr(library, name.format("get")), getattr(library, name.format("set"))
        return None

    def __enter__(self) -> None:
        with self._lock:
            self._inside += 1
            if self._inside == 1 and self._functions is not None:
                count, set_count = self._functions
                self._before = count()
                if self._before > 1:
                    set_count(1)

    def __exit__(self, kind: Any, error: BaseException | None, trace: TracebackType | None) -> None:
        with self._lock:
            self._inside -= 1
            if not self._inside and self._functions is not None and self._before > 1:
                self._functions[1](self._before)


ONE_THREAD = _OneThread()
