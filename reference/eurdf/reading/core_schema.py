"""The YAML 1.2 core schema: the value of a scalar (YAML 1.2.2, section 10.3.2)."""

from __future__ import annotations

import re
from math import inf, nan
from sys import float_info

Scalar = str | int | float | bool | None

#: The meaning of the shorthand ``!!``.
TAG_PREFIX = "tag:yaml.org,2002:"

_NULL: dict[str, None] = dict.fromkeys(("", "~", "null", "Null", "NULL"))
_BOOL = {"true": True, "True": True, "TRUE": True, "false": False, "False": False, "FALSE": False}
_NOT_FINITE = {
    **dict.fromkeys((sign + word for sign in ("", "+") for word in (".inf", ".Inf", ".INF")), inf),
    **dict.fromkeys(("-.inf", "-.Inf", "-.INF"), -inf),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), nan),
}
_WORDS: dict[str, Scalar] = {**_NULL, **_BOOL, **_NOT_FINITE}
_INT = re.compile(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NUMBER = re.compile(f"({_INT.pattern})|{_FLOAT.pattern}")
_NUMBER_BEGINS = frozenset("+-.0123456789")


def resolve(text: str) -> Scalar:
    """EU-YML-011: value of a plain scalar without a tag; a number beyond the range of a double is an infinity."""
    if text[:1] in _NUMBER_BEGINS and (number := _NUMBER.fullmatch(text)) is not None:
        return _integer(text) if number.lastindex else float(text)
    return _WORDS.get(text, text)


def resolve_tagged(tag: str, text: str) -> Scalar:
    """EU-SEC-001: value of a scalar, plain or quoted, with a tag of the core schema, which are all that have a meaning.

    `ValueError` if the core schema has no such tag for scalars, or the text does not fit it.
    """
    name = tag.removeprefix(TAG_PREFIX)
    if name == "str":
        return text
    if name == "null" and text in _NULL:
        return None
    if name == "bool" and text in _BOOL:
        return _BOOL[text]
    if name == "int" and _INT.fullmatch(text):
        return _integer(text)
    if name == "float" and text in _NOT_FINITE:
        return _NOT_FINITE[text]
    if name == "float" and _FLOAT.fullmatch(text):
        return float(text)
    raise ValueError(text)


def _integer(text: str) -> int | float:
    base = 0 if text[1:2] in ("o", "x") else 10
    if len(text) < 256:  # whatever the base, a double holds it
        return int(text, base)
    if base == 0:
        value = int(text, base)
    else:
        # Python refuses to convert thousands of digits, zeros in front included.
        digits = text.lstrip("+-").lstrip("0") or "0"
        if len(digits) > float_info.max_10_exp + 1:
            return -inf if text[0] == "-" else inf
        value = -int(digits) if text[0] == "-" else int(digits)
    try:
        float(value)
    except OverflowError:
        return inf if value > 0 else -inf
    return value
