"""Compare texts with computed numbers in them, of which the last digits depend on the processor."""

from __future__ import annotations

import math
import re

_NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])")


def same_text(one: str, other: str, *, relative: float, absolute: float) -> bool:
    """Whether two texts are equal, but for white space and for numbers that are nearly equal.

    The last digits of a computed number depend on the processor and on the linear algebra library.

    Args:
        one: A text.
        other: Another one.
        relative: How far two numbers may be apart, in parts of the larger.
        absolute: How far two numbers may be apart, where both are small.
    """
    return _words(one) == _words(other) and all(
        math.isclose(a, b, rel_tol=relative, abs_tol=absolute)
        for a, b in zip(_numbers(one), _numbers(other), strict=True)
    )


def _words(text: str) -> list[str]:
    return _NUMBER.sub(" # ", text).split()


def _numbers(text: str) -> list[float]:
    return [float(number) for number in _NUMBER.findall(text)]
