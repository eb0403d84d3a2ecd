"""Enumerations of texts; the oracle uses them, so they are not those of the reference."""

from __future__ import annotations

from enum import Enum


class TextEnum(str, Enum):
    """An enumeration whose members are their texts, as those of `enum.StrEnum`, which Python 3.10 lacks."""

    __str__ = str.__str__

    def __format__(self, format_spec: str) -> str:
        return str.__format__(self, format_spec)
