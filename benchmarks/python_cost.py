"""What it costs that `eurdf` is written in Python: calls, and the times of the smallest robots, which are the floor.

The functions of `eurdf` call Pinocchio and NumPy, which are compiled, many times. On `four_bar`, of 3 velocities, the
mathematics takes a few microseconds, and nearly all of the time are these calls and the checks of arguments and
results; on `kangaroo_leg`, of 63, it is the mathematics. The calls are those of one call of the function.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable, Iterator
from functools import partial
from types import FrameType
from typing import Any

import numpy as np

import eurdf
from benchmarks.interleaved import least_times
from benchmarks.robots import robot_called
from benchmarks.table import Table, duration


def tables() -> Iterator[Table]:
    """One of a small and a large robot."""
    columns = ("function", "robot", "time", "calls of Python", "calls of compiled functions")
    yield Table(columns, [row for name in ("four_bar", "kangaroo_leg") for row in _rows(name)])


def _rows(name: str) -> Iterator[tuple[str, ...]]:
    robot = robot_called(name)
    q, u = eurdf.assemble(robot).q, np.ones(len(robot.actuation.idx_v))
    v = np.zeros(robot.model.nv)
    functions: dict[str, Callable[[], object]] = {
        "residual_and_jacobian": partial(eurdf.residual_and_jacobian, robot, q),
        "forward_dynamics": partial(eurdf.forward_dynamics, robot, q, v, u),
        "inverse_dynamics": partial(eurdf.inverse_dynamics, robot, q, v, v),
        "forward_kinematics": partial(eurdf.forward_kinematics, robot, q[robot.actuation.idx_q] + 1e-3, q),
        "simulate, one step": partial(eurdf.simulate, robot, q, duration=1e-3),
    }
    for function, call in functions.items():
        (seconds,) = least_times([call], 200)
        called = _calls(call)
        yield f"`{function}`", name, duration(seconds), str(called["call"]), str(called["c_call"])


def _calls(function: Callable[[], object]) -> Counter[str]:
    """How many functions of Python and compiled ones it calls."""
    found: Counter[str] = Counter()

    def count(frame: FrameType, event: str, argument: Any) -> None:
        found[event] += 1

    sys.setprofile(count)
    try:
        function()
    finally:
        sys.setprofile(None)
    return found
