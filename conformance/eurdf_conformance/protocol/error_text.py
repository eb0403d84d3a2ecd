"""Error messages for data that do not fit the schema of a message."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from eurdf_conformance.json_pointer import step

#: Errors reported at once, and characters shown of a value.
_MOST, _WIDTH = 3, 60

# For these kinds of error, pydantic's value is the surrounding object, which is not worth showing.
_VALUE_APART = ("missing", "extra_forbidden", "union_tag_invalid", "union_tag_not_found", "json_invalid")


def error_text(error: ValidationError, within: str = "", skip: int = 0) -> str:
    """The first few errors, each with its JSON pointer.

    Args:
        error: The error of pydantic.
        within: Pointer to the data.
        skip: Number of leading parts of each location that name the kind of message, not a place.
    """
    found = error.errors(include_url=False)
    words = [
        f"{_pointer(each['loc'][skip:], within) or '(top level)'}: {_words(each['type'], each['msg'], each['input'])}"
        for each in found[:_MOST]
    ]
    more = f"; and {len(found) - _MOST} more" if len(found) > _MOST else ""
    return "; ".join(words) + more


def not_finite(value: Any, within: str = "") -> Iterator[str]:
    """Pointers to the numbers that JSON cannot represent: NaN and infinity."""
    match value:
        case float() if not math.isfinite(value):
            yield within
        case Mapping():
            for key, item in value.items():
                yield from not_finite(item, _pointer([key], within))
        case list() | tuple():
            for index, item in enumerate(value):
                yield from not_finite(item, _pointer([index], within))


def _words(kind: str, message: str, value: Any) -> str:
    if kind in _VALUE_APART:
        return message
    if kind == "finite_number":
        return f"{message}, not {value}: JSON has no NaN or infinity"
    words = f"{message}, not {_shown(value)}"
    if kind == "float_type" and value is None:
        return f"{words}, which some libraries write for NaN or infinity; JSON has neither"
    return words


def _shown(value: Any) -> str:
    try:
        text = json.dumps(value, ensure_ascii=False, default=repr)
    except (TypeError, ValueError, RecursionError):  # keys that are no texts, what contains itself
        text = repr(value)
    return text if len(text) <= _WIDTH else f"{text[:_WIDTH]}…"


def _pointer(parts: Sequence[Any], within: str) -> str:
    return within + "".join(map(step, parts))
