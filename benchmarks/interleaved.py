"""Processor times of several functions, measured in turn, so that what else the machine does affects them alike."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable, Sequence
from typing import Any

# Turns after which the time that a measurement may take counts.
_FEWEST = 3


def least_times(functions: Sequence[Callable[[], Any]], repeats: int = 15, seconds: float = 0.3) -> list[float]:
    """Of each function its least processor time, s, after one call that is not measured.

    Args:
        functions: They run in turns.
        repeats: How many turns.
        seconds: Processor time after which there are no more turns.
    """
    for function in functions:
        function()
    least = [float("inf")] * len(functions)
    start = time.process_time()
    for turn in range(repeats):
        if turn >= _FEWEST and time.process_time() - start > seconds:
            break
        for index, function in enumerate(functions):
            begin = time.process_time()
            function()
            least[index] = min(least[index], time.process_time() - begin)
    return least


def timed(function: Callable[[], Any]) -> tuple[float, Any]:
    """Processor time of a call, s, and what it returned."""
    begin = time.process_time()
    result = function()
    return time.process_time() - begin, result


def peak_memory() -> float:
    """The largest memory of the process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
