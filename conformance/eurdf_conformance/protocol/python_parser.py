"""Checks whether a Python object is a parser, before the first request."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence, Set
from typing import Any

from eurdf_conformance.feature import Feature
from eurdf_conformance.level import VERSIONS, Level

_LEVELS = ", ".join(Level)


def parser_error(parser: Any) -> str:
    """Why an object is not a `PythonParser`, in one sentence; empty if it is one."""
    missing = [name for name in ("name", "version", "language", "claims", "load") if not hasattr(parser, name)]
    if missing:
        return f"{described(parser)} has no {' and no '.join(missing)}"
    for name in ("name", "version", "language"):
        if not isinstance(said := getattr(parser, name), str):
            return f"its {name} is {described(said)}, expected a string"
    if not parser.name:
        return "its name is empty"
    error = _claims_error(parser.claims) or _lacks_error(getattr(parser, "lacks", ()))
    error = error or _method_error(parser, "load", ("description", "urdf"))
    if not error and hasattr(parser, "evaluate"):
        error = _method_error(parser, "evaluate", ("configurations", "frames", "quantities"))
    return error


def described(value: Any) -> str:
    """A short description of a value, for an error message."""
    if value is None or isinstance(value, bool | int | float):
        return repr(value)
    if isinstance(value, type):
        return f"the class {value.__name__}"
    if inspect.isroutine(value):
        return f"the function {value.__name__}"
    return f"an object of the class {type(value).__name__}"


def _claims_error(claims: Any) -> str:
    """What is wrong with the claims."""
    as_in = "as in {'2': ['accept']}"
    if not isinstance(claims, Mapping):
        return f"its claims are {described(claims)}, expected a mapping from version to levels, {as_in}"
    for version, levels in claims.items():
        if version not in VERSIONS:
            return f"it claims version {version!r}; versions are strings, {as_in}"
        if isinstance(levels, str) or not isinstance(levels, Sequence):
            return f"its claims for version {version} must be a list of levels, {as_in}"
        for level in levels:
            if level not in list(Level):
                return f"it claims level {level!r}; levels are {_LEVELS}"
    return ""


def _lacks_error(lacks: Any) -> str:
    """What is wrong with the missing features."""
    if isinstance(lacks, str) or not isinstance(lacks, Sequence | Set):
        return f"what it lacks is {described(lacks)}, expected a list of features, as in ['planar']"
    for feature in lacks:
        if feature not in list(Feature):
            return f"it lacks {feature!r}; features are {', '.join(Feature)}"
    return ""


def _method_error(parser: Any, name: str, parameters: Sequence[str]) -> str:
    """What is wrong with a method."""
    method, asked = getattr(parser, name), f"{name}({', '.join(parameters)})"
    if not callable(method):
        return f"its {name} is {described(method)}, expected a method {asked}"
    try:
        signature = inspect.signature(method)
    except (TypeError, ValueError):  # of another language, perhaps
        return ""
    try:
        signature.bind(*parameters)
    except TypeError:
        return f"its method {name}{signature} cannot be called as {asked}"
    return ""
