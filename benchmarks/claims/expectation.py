"""How a rerun of a claim says what was seen."""

from __future__ import annotations


class OtherwiseError(Exception):
    """The programs do something else than what is claimed."""


def expect(holds: bool, seen: str) -> str:
    """What was seen.

    Raises:
        OtherwiseError: It is not what is claimed.
    """
    if not holds:
        raise OtherwiseError(seen)
    return seen
