"""The bounds of the numbers in both files, EU-FIL-005 and EU-FIL-006."""

from __future__ import annotations

import math

#: Largest size of a number.
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
