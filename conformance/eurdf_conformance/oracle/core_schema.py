"""The meaning of a YAML scalar under the core schema of YAML 1.2, EU-YML-011."""

from __future__ import annotations

import math
import re

from eurdf_conformance.oracle.not_read import NotRead

Scalar = str | int | float | bool | None

CORE = "tag:yaml.org,2002:"
_TYPES = {"null": type(None), "bool": bool, "int": int, "float": float}

_NULL = re.compile(r"null|Null|NULL|~|")
_BOOL = re.compile(r"true|True|TRUE|false|False|FALSE")
_DECIMAL = re.compile(r"[-+]?[0-9]+")
_OCTAL = re.compile(r"0o[0-7]+")
_HEXADECIMAL = re.compile(r"0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)")


def plain(source: str) -> Scalar:
    """The value of a plain scalar without a tag."""
    if _NULL.fullmatch(source):
        return None
    if _BOOL.fullmatch(source):
        return source.lower() == "true"
    try:
        found = _number(source)
        if found is None:
            return source
        if math.isfinite(float(found)):
            return found
    except (OverflowError, ValueError):  # too large for a double, or of more digits than Python reads
        pass
    raise NotRead(f"{source} is not finite, or out of the range of a double, EU-YML-009")


def _number(source: str) -> float | None:
    if _DECIMAL.fullmatch(source):
        return int(source)
    if _OCTAL.fullmatch(source):
        return int(source[2:], 8)
    if _HEXADECIMAL.fullmatch(source):
        return int(source[2:], 16)
    if _FLOAT.fullmatch(source):
        return float(source)
    return math.inf if _NOT_FINITE.fullmatch(source) else None


def tagged(tag: str, source: str) -> Scalar:
    """The value of a scalar with a tag, which must match the tag, EU-YML-005."""
    if tag in ("!", CORE + "str"):
        return source
    found = plain(source)
    if tag == CORE + "float" and _FLOAT.fullmatch(source):
        found = float(source)
    if not tag.startswith(CORE) or type(found) is not _TYPES.get(tag.removeprefix(CORE)):
        raise NotRead(f"tag {tag} on {source!r}")
    return found
