"""Reads JSON and reports errors that many JSON libraries accept silently."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from pydantic import BaseModel

from eurdf_conformance.json_pointer import step
from eurdf_conformance.protocol.error_text import not_finite

#: What a number beyond the range of a double has: an exponent of three digits, or hundreds of digits before it.
_MAY_BE_HUGE = re.compile(rb"[eE][+]?[0-9]{3}|[0-9]{200}")


class Doubled(dict[str, Any]):
    """An object with a key that occurs in it more than once, of which it has the last value.

    Attributes:
        keys_twice: These keys.
    """

    def __init__(self, members: Sequence[tuple[str, Any]]) -> None:
        super().__init__(members)
        counts = Counter(key for key, _ in members)
        self.keys_twice = tuple(key for key in self if counts[key] > 1)


def read_json(text: bytes) -> tuple[Any, list[str]]:
    """The value of a JSON text in UTF-8, and its errors, each with its JSON pointer.

    Errors are a key that occurs twice in an object, since libraries differ in the value they keep; NaN and Infinity,
    which JSON does not allow; and a number beyond the range of a double, which is read as infinity.

    Raises:
        ValueError: It is not JSON, or not in UTF-8.
        RecursionError: It is nested too deep.
    """
    words: list[str] = []
    doubled: list[Doubled] = []

    def constant(word: str) -> float:
        words.append(f"{word} is not JSON")
        return float(word)

    def real(text: str) -> float:
        number = float(text)
        if math.isinf(number):
            words.append("a number is beyond the range of a double")
        return number

    def whole(digits: str) -> float:
        number = 0.0 if len(digits) < 300 else real(digits)
        return int(digits) if math.isfinite(number) else number

    def made(members: list[tuple[str, Any]]) -> dict[str, Any]:
        plain = dict(members)
        if len(plain) == len(members):
            return plain
        doubled.append(Doubled(members))
        return doubled[-1]

    value = json.loads(
        text.decode("utf-8"), parse_constant=constant, parse_float=real, parse_int=whole, object_pairs_hook=made
    )
    found = [f"{pointer}: duplicate key '{key}'" for pointer, key in _twice(value)] if doubled else []
    if words:
        found.append(f"{next(not_finite(value), '') or '(top level)'}: {words[0]}")
    return value, found


def may_have_errors(text: bytes, read: BaseModel) -> bool:
    """Whether `read_json` may find anything wrong with a text that was read as a message: a quick test.

    A colon follows each key, and of a key that occurs twice the message has one: it is written with fewer colons
    than the text holds. No escape but one means a colon.

    Args:
        text: The text.
        read: The message, as pydantic reads it, which takes the last value of a key.
    """
    if b"NaN" in text or b"Infinity" in text or b"\\u003" in text or _MAY_BE_HUGE.search(text):
        return True
    return text.count(b":") != read.model_dump_json(exclude_unset=True).count(":")


def _twice(value: Any, within: str = "") -> Iterator[tuple[str, str]]:
    """The keys that occur twice, each with the pointer to its object."""
    if isinstance(value, Doubled):
        for key in value.keys_twice:
            yield within or "(top level)", key
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _twice(item, within + step(key))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            yield from _twice(item, within + step(index))
