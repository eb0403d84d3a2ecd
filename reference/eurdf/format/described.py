"""How messages show values of a file."""

from __future__ import annotations

from typing import Any


def quoted(text: str) -> str:
    """A text as a message quotes it: shortened if it is long, with control characters escaped."""
    shown = text if text.isprintable() else repr(text)[1:-1]
    return f"'{shown}'" if len(shown) <= 60 else f"'{shown[:57]}…'"


def described(value: Any) -> str:
    """What a value is, as a message describes it."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return quoted(value)
    if isinstance(value, int | float):
        return repr(value) if abs(value) < 1e15 else f"{value:g}"
    if isinstance(value, list):
        return "a list of names" if value and all(isinstance(item, str) for item in value) else "a list"
    return "a mapping"
