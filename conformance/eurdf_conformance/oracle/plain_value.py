"""Values of a YAML document, read as a given type or refused."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from eurdf_conformance.oracle.not_read import NotRead
from eurdf_conformance.oracle.spatial import Array


def mapping(value: Any, allowed: Collection[str] | None = None) -> dict[str, Any]:
    """The members of a mapping without user data, EU-EXT-002; only `allowed` keys, if given."""
    if not isinstance(value, dict):
        raise NotRead(f"{value!r} is no mapping")
    members = {key: member for key, member in value.items() if not key.startswith("x-")}
    if allowed is not None and (unknown := members.keys() - set(allowed)):
        raise NotRead(f"unknown keys {sorted(unknown)}")
    return members


def sequence(value: Any) -> list[Any]:
    """A list."""
    if not isinstance(value, list):
        raise NotRead(f"{value!r} is no list")
    return value


def text(value: Any) -> str:
    """A string."""
    if not isinstance(value, str):
        raise NotRead(f"{value!r} is no string")
    return value


#: Largest size of a number, EU-FIL-005.
LARGEST = 1e15

#: For each limit the sign of the numbers that are none if they are beyond `LARGEST`, EU-FIL-006.
NO_LIMIT = {
    "lower": -1.0,
    **dict.fromkeys(("upper", "velocity", "effort", "acceleration", "deceleration", "jerk"), 1.0),
}


def number(value: Any) -> float:
    """A number; a boolean is not one, EU-SCH-002."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise NotRead(f"{value!r} is no number")
    return bounded(float(value))


def bounded(value: float) -> float:
    """A number that is not too large."""
    if abs(value) > LARGEST:
        raise NotRead(f"{value!r} is too large")
    return value


def limit(name: str, value: float) -> float | None:
    """The number of a limit; None if it is so large that it is none."""
    return None if value * NO_LIMIT[name] > LARGEST else bounded(value)


def numbers(value: Any) -> list[float]:
    """A list of numbers, or a single number."""
    return [number(item) for item in value] if isinstance(value, list) else [number(value)]


def limits(name: str, value: Any) -> list[float | None]:
    """The numbers of a limit, a list or a single one."""
    stated = value if isinstance(value, list) else [value]
    if not all(type(item) in (int, float) for item in stated):
        raise NotRead(f"{value!r} is no number")
    return [limit(name, float(item)) for item in stated]


def vector(value: Any) -> Array:
    """Three numbers."""
    if len(sequence(value)) != 3:
        raise NotRead(f"{value!r} has not three numbers")
    return np.array([number(item) for item in value])
