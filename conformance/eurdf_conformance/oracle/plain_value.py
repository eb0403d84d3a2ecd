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


def number(value: Any) -> float:
    """A number; a boolean is not one, EU-SCH-002."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise NotRead(f"{value!r} is no number")
    return float(value)


def numbers(value: Any) -> list[float]:
    """A list of numbers, or a single number."""
    return [number(item) for item in value] if isinstance(value, list) else [number(value)]


def vector(value: Any) -> Array:
    """Three numbers."""
    if len(sequence(value)) != 3:
        raise NotRead(f"{value!r} has not three numbers")
    return np.array([number(item) for item in value])
