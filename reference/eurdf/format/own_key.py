"""User-defined keys (EU-EXT-002)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

#: What user-defined keys begin with, at any level of a version 2 file, as a pattern of JSON Schema.
OWN_KEY = "^x-"

#: In a schema: where a mapping has user-defined keys, two names make three keys at least. JSON Schema counts all keys
#: of a mapping alike, so it takes two user-defined keys or more for names; the models count names alone.
TWO_NAMES: Mapping[str, Any] = {
    "minProperties": 2,
    "if": {"propertyNames": {"not": {"pattern": OWN_KEY}}},
    "else": {"minProperties": 3},
}

_PREFIX = OWN_KEY.removeprefix("^")


def is_own_key(key: str) -> bool:
    """Whether a key of a version 2 file is user-defined."""
    return key.startswith(_PREFIX)


def may_have_own_keys(text: str) -> bool:
    """Whether a file can have a user-defined key: it contains what these begin with, or an escape."""
    return _PREFIX in text or "\\" in text
