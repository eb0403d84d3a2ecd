"""The arguments of public functions, checked before they reach Pinocchio.

Pinocchio's Python interface does not check every size: a wrong one can read memory that is not its own.
"""

from __future__ import annotations

import math
import operator
import reprlib
from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from typing import Any, TypeGuard, TypeVar

import numpy as np

from eurdf.array import Matrix
from eurdf.blas import MANY_VELOCITIES, ONE_THREAD
from eurdf.pinocchio.memory import Cached

_FLOATS = np.dtype(np.float64)
_MANY = 1000  # values

_Result = TypeVar("_Result")


def checked_array(name: str, given: Any, *shapes: tuple[int, ...]) -> Matrix:
    """The given numbers as an array of one of the shapes.

    Args:
        name: Name of the argument.
        given: What was passed for it.
        shapes: The shapes that it can have.

    Raises:
        ValueError: It has another shape, or something in it is not a finite number.
    """
    if type(given) is np.ndarray and given.dtype is _FLOATS and given.shape in shapes and all_finite(given):
        return given  # sooner than by the steps below
    expected = " or ".join(map(str, shapes))
    try:
        as_given = np.asarray(given)
        if as_given.dtype.kind not in "biufO":  # no text, and no complex numbers
            raise TypeError
        values = as_given.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} is {reprlib.repr(given)}; expected finite numbers of shape {expected}") from None
    if values.shape not in shapes:
        raise ValueError(f"{name} has the shape {values.shape}; expected {expected}")
    if not all_finite(values):
        at = [int(index) for index in np.argwhere(~np.isfinite(values))[0]]
        place = f"{name}{at}" if at else name
        raise ValueError(f"{place} is {values[tuple(at)]}, not finite; expected finite numbers of shape {expected}")
    return values


def all_finite(values: Matrix) -> bool:
    """Whether all numbers are finite."""
    # The squares tell it sooner, unless they overflow; unlike dot, vdot does not warn. Many BLAS divides among threads.
    return (values.size < _MANY and math.isfinite(np.vdot(values, values))) or bool(np.isfinite(values).all())


def checked_count(name: str, given: Any, least: int) -> int:
    """The given integer.

    Raises:
        ValueError: It is no integer, or is less than ``least``.
    """
    try:
        count = operator.index(given)
    except TypeError:
        raise ValueError(f"{name} is {reprlib.repr(given)}; expected an integer of at least {least}") from None
    if count < least:
        raise ValueError(f"{name} is {count}; expected an integer of at least {least}")
    return count


def checked_tolerance(given: Any) -> float:
    """The given tolerance.

    Raises:
        ValueError: It is no finite number, or is negative.
    """
    if type(given) is float and 0.0 <= given < math.inf:
        return given  # sooner than by the steps below
    value = float(checked_array("tolerance", given, ()))
    if value < 0.0:
        raise ValueError(f"tolerance is {value}; expected a number of at least 0")
    return value


def checked_data(model: Any, data: Any) -> Any:
    """The given `pin.Data`, or a new one if it is None.

    Raises:
        ValueError: It is no `pin.Data`, or one of another model.
    """
    if data is None:
        return model.createData()
    import pinocchio as pin  # only now: functions accept what is not a robot yet without a simulator

    if not isinstance(data, pin.Data) or not model.check(data):
        raise ValueError("data is not a pin.Data of the robot's model; pass robot.data or robot.model.createData()")
    return data


def accepting(function: Callable[..., _Result], as_robot: Callable[[Any], Any]) -> Callable[..., _Result]:
    """A function whose first argument, the robot, may also be something of which a robot is made first.

    While it computes, BLAS has one thread, if the robot is large.
    """

    @wraps(function)
    def of_any(robot: Any, *args: Any, **options: Any) -> _Result:
        if not isinstance(robot, Cached):  # which is known sooner than that it is a path
            robot = as_robot(robot)
        if robot.tree.nv < MANY_VELOCITIES:
            return function(robot, *args, **options)
        with ONE_THREAD:
            return function(robot, *args, **options)

    return of_any


def are_by_name(given: Any) -> TypeGuard[Mapping[str, Any]]:
    """Whether values are given by name; that an array is not a mapping is known sooner by its own type."""
    return type(given) is not np.ndarray and isinstance(given, Mapping)


def as_names(given: str | Iterable[str]) -> tuple[str, ...]:
    """The names given: a text alone is one name, not the letters in it."""
    return (given,) if isinstance(given, str) else tuple(given)
