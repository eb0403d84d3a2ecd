"""Slips of who writes names and numbers: a sign, a unit, a digit, the other side of the robot."""

from __future__ import annotations

import math
import re
from decimal import Decimal

from eurdf.linking.counterparts import OTHER_SIDE, cased_as

#: What a number is multiplied by whose unit was taken for m, or for rad.
OF_LENGTH = {"mm": Decimal("0.001"), "cm": Decimal("0.01"), "inches": Decimal("0.0254")}
OF_ANGLE = {"degrees": Decimal(repr(math.pi / 180.0))}

# By how many digits a decimal point moves.
_MOVES = (1, -1, 2, -2)

# Decimals beyond which nobody writes a number.
_DECIMALS = 12

_DIGITS = ("", ".", *"0123456789")
_NUMBER = re.compile(r"-?(0|[1-9]\d*)(\.\d+)?")

_SIDE = re.compile(r"(?<![a-z])(left|right|l|r)(?![a-z])", re.IGNORECASE)


def side(name: str) -> str | None:
    """The first word of a name that says left or right, by its first letter: l or r."""
    found = _SIDE.search(name)
    return found[1][0].lower() if found else None


def other_side(name: str) -> str | None:
    """The name with left and right exchanged; None if it has neither."""
    changed = _SIDE.sub(lambda found: cased_as(found[1], OTHER_SIDE[found[1].lower()]), name)
    return None if changed == name else changed


def common_start(one: str, other: str) -> int:
    """The number of characters with which both texts begin."""
    pairs = enumerate(zip(one, other, strict=False))
    return next((index for index, (a, b) in pairs if a != b), min(len(one), len(other)))


def shortest(value: float, tolerance: float) -> str:
    """The number with as few decimals as the tolerance allows."""
    digits = next((n for n in range(_DECIMALS) if abs(round(value, n) - value) <= tolerance), _DECIMALS)
    return f"{round(value, digits) + 0.0:.{digits}f}"


def in_unit(token: str, factor: Decimal) -> str:
    """A number as it is written, in another unit."""
    text = f"{Decimal(token) * factor:.12f}".rstrip("0")
    return text.rstrip(".") if float(text) else "0"


def negated(token: str) -> str:
    """A number as it is written, with the other sign."""
    return token[1:] if token.startswith("-") else f"-{token.removeprefix('+')}"


def with_one_slip(token: str, value: float, tolerance: float) -> str | None:
    """The number as it is written, but for one slip, so that it has a value; else None.

    That is the place of the decimal point, a digit, or two that are exchanged. Two numbers with a single digit each say
    nothing of slips of digits.
    """
    moved = (format(Decimal(token).scaleb(places), "f") for places in _MOVES)
    if (found := next((text for text in moved if abs(float(text) - value) <= tolerance), None)) is not None:
        return found
    texts = [
        token[:i] + digit + token[i + more :] for i in range(len(token) + 1) for digit in _DIGITS for more in (0, 1)
    ]
    texts += [token[:i] + token[i + 1] + token[i] + token[i + 2 :] for i in range(len(token) - 1)]
    near = [(abs(float(text) - value), text) for text in texts if _NUMBER.fullmatch(text) and text != token]
    off, best = min(near, default=(math.inf, ""))
    return best if off <= tolerance and max(map(_significant, (token, best))) > 1 else None


def _significant(token: str) -> int:
    """The number of digits that a number has."""
    return len(re.sub(r"\D", "", token).lstrip("0"))
