"""What holds in every file: the names of the versions, user-defined keys, and the bounds of numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Literal

from eurdf.reading.yaml_node import Pointer

Version = Literal["1", "2.0", "2.1"]
VERSION2_0: Literal["2.0"] = "2.0"
VERSION2_1: Literal["2.1"] = "2.1"

#: The key that states the version; files of version 1 lack it.
VERSION_KEY = "extended_urdf"

# -- numbers ----------------------------------------------------------------------------------------------------------

#: Largest size of a number in both files (EU-FIL-005).
LARGEST = 1e15

#: Smallest size, except 0, of a gear ratio, a pitch, a coefficient and a multiplier: others are divided by them.
SMALLEST = 1e-15

#: What to do about a number beyond these bounds.
HINT = "check its exponent and its unit"


def too_large(number: float) -> str:
    """The end of a message about a number beyond `LARGEST`."""
    return f"{number!r}; the size of a number must be at most {LARGEST:g}"


def too_small(number: float) -> str:
    """The end of a message about a number that is not 0, below `SMALLEST`."""
    return f"{number!r}; its size must be at least {SMALLEST:g}"


def is_too_small(number: float) -> bool:
    """Whether a number is nearer to 0 than `SMALLEST`, and not 0."""
    return -SMALLEST < number < SMALLEST and number != 0.0


def lower_limit(number: float) -> float:
    """EU-FIL-006: a lower limit; -inf if the number is so small that it is none."""
    return -math.inf if number < -LARGEST else number


def upper_limit(number: float) -> float:
    """EU-FIL-006: an upper limit, or one of a rate or an effort; inf if the number is so large that it is none."""
    return math.inf if number > LARGEST else number


# -- user-defined keys ------------------------------------------------------------------------------------------------

#: What user-defined keys begin with, at any level of a version 2 file (EU-EXT-002).
_OWN = "x-"

#: The same, as a pattern of JSON Schema.
OWN_KEY = f"^{_OWN}"


def is_own_key(key: str) -> bool:
    """Whether a key of a version 2 file is user-defined."""
    return key.startswith(_OWN)


def own_data(value: Any, pointer: Pointer = ()) -> Iterator[tuple[Pointer, object]]:
    """EU-EXT-002: the value of a key ``x-…``, at any level; its content is ignored."""
    for key, inner in value.items() if type(value) is dict else enumerate(value):
        if type(key) is str and is_own_key(key):
            yield (*pointer, key), inner
        elif type(inner) is dict or type(inner) is list:
            yield from own_data(inner, (*pointer, key))


def may_have_own_keys(text: str) -> bool:
    """Whether a file can have a user-defined key: it contains what these begin with, or an escape."""
    return _OWN in text or "\\" in text
