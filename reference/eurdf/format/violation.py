"""The errors that a model finds in a file, as diagnostics with codes, places and messages.

The models, and the JSON Schemas generated from them, define what is valid (EU-SCH-001 to EU-SCH-006, EU-EXT-001); here
one error gives one diagnostic.
"""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ValidationError

from eurdf.diagnostics import Diagnostic, did_you_mean
from eurdf.format.described import described, quoted
from eurdf.format.misplaced import (
    Indentation,
    another_entry_hint,
    key_of_a_joint_hint,
    key_of_the_file_hint,
    key_outside_hint,
)
from eurdf.format.near import near
from eurdf.format.numbers import HINT, LARGEST, too_large
from eurdf.format.version import VERSION2_1, Version
from eurdf.format.version1 import Version1
from eurdf.format.version2 import FROM_VERSION1, JOINT_TYPES, Version2
from eurdf.format.version2_1 import ADDED_KEYS, CLOSURE_TYPES, EXCLUDED, KEYS, TAGS, Version2_1
from eurdf.reading.yaml_node import Pointer

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

    from eurdf.reading.yaml_reader import YamlDocument

_MODELS: Mapping[Version, type[BaseModel]] = {"1": Version1, "2.0": Version2, "2.1": Version2_1}

#: Maximum number of reported errors per file; a file with more is not a description.
MOST = 100

_EXPECTED = {
    "string_type": "text",
    "float_type": "a number",
    "list_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "bool_type": "false",
}

#: Lengths of pairs and vectors, which are exact; other lists can have from 1 to 6 or 7 items.
_EXACT_LENGTHS = (2, 3)

#: Only user-defined keys have a pattern; values with a pattern are distinguished by it beforehand.
_UNKNOWN_KEY = "string_pattern_mismatch"

#: What to write in place of a joint type that the file cannot state.
_JOINT_TYPE_HINTS = {
    "universal": "a universal joint needs its axes: {type: universal, axes: xy}",
    "helical": "a helical joint needs its pitch: {type: helical, pitch: 0.005}",
    **dict.fromkeys(
        ("revolute", "continuous", "prismatic", "planar", "floating"),
        "a joint without a type keeps its URDF type",
    ),
}


@dataclass(frozen=True, slots=True)
class _Violation:
    """One error of pydantic's.

    Attributes:
        type: Pydantic's name of the error, or the code of this project that a model raised.
        message: The message of pydantic or of a model.
        context: Numbers and names in the message.
        value: The value.
        pointer: Its place.
        mapping: Last field or tag on the path to the mapping or list that contains it: the key of `KEYS`.
    """

    type: str
    message: str
    context: Mapping[str, Any]
    value: Any
    pointer: Pointer
    mapping: str


def violations(version: Version, data: Mapping[str, Any], document: YamlDocument) -> list[Diagnostic]:
    """The errors that the model of a version finds in a file, in file order, each reported once.

    Args:
        version: The version.
        data: The content of the file, with this version.
        document: The file that was read.
    """
    try:
        _MODELS[version].model_validate(data)
    except ValidationError as error:
        details = error.errors(include_url=False)
    else:
        return []
    found = [_located(detail, document.data) for detail in details[:MOST]]
    mistyped = {
        each.pointer[:2] for each in found if each.pointer[:1] == ("closures",) and each.pointer[2:] == ("type",)
    }
    found = [
        each for each in found if not (each.pointer[:2] in mistyped and each.pointer[-1] in ADDED_KEYS["closures"])
    ]
    lacking: dict[Pointer, list[str]] = {}
    for violation in found:
        if violation.type == "missing":
            lacking.setdefault(violation.pointer[:-1], []).extend(_alternatives(violation.pointer[-1]))
    meant: dict[Pointer, str] = {}  # for an unknown key, the required key that it misspells
    for violation in found:
        if violation.type == _UNKNOWN_KEY:
            required = near(str(violation.pointer[-1]), lacking.get(violation.pointer[:-1], ()))
            if required is not None:
                meant[violation.pointer] = required
    misspelt = {(*pointer[:-1], key) for pointer, key in meant.items()}
    missing: dict[Pointer, list[str]] = {}
    for mapping, keys in _grouped(violation.pointer for violation in found if violation.type == "missing").items():
        lacked = [key for key in keys if misspelt.isdisjoint((*mapping, each) for each in _alternatives(key))]
        missing |= {mapping: lacked} if lacked else {}
    diagnostics = [_lacking(mapping, keys, document) for mapping, keys in missing.items()]
    indentation = Indentation(document, [violation.pointer for violation in found])
    diagnostics += [
        _diagnostic(violation, meant.get(violation.pointer), document, indentation)
        for violation in found
        if violation.type != "missing"
    ]
    diagnostics.sort(key=lambda diagnostic: (diagnostic.line or 0, diagnostic.column or 0))
    if len(details) > MOST:
        last = diagnostics.pop()
        more = f"{len(details) - MOST:,} more errors of the file are not listed"
        diagnostics.append(
            Diagnostic(last.code, last.message, last.place, f"{last.hint}; {more}" if last.hint else more)
        )
    return diagnostics


def _is_later_type(violation: _Violation, document: YamlDocument) -> bool:
    """Whether a closure has a type that a later version than that of the file adds."""
    return (
        violation.pointer[:1] == ("closures",)
        and violation.pointer[2:] == ("type",)
        and violation.value in CLOSURE_TYPES[VERSION2_1]
        and violation.value not in _closure_types(document)
    )


def _closure_types(document: YamlDocument) -> Sequence[str]:
    """The types of closure of the version of a file."""
    version = document.data.get("extended_urdf")
    return CLOSURE_TYPES.get(str(version), CLOSURE_TYPES["2.0"])


def _version_hint(what: str, document: YamlDocument) -> str:
    """Which line to change so that a file may have what version 2.1 adds."""
    line = document.place(("extended_urdf",)).line
    return f'{what} is of version {VERSION2_1}: write extended_urdf: "{VERSION2_1}" on line {line}'


def subject(pointer: Pointer) -> str:
    """How a message names the value at a pointer."""
    if not pointer:
        return "the file"
    if isinstance(pointer[-1], int):
        return f"item {pointer[-1] + 1} of {subject(pointer[:-1])}"
    noun = {("joints",): "joint ", ("configurations",): "configuration "}.get(pointer[:-1], "")  # type: ignore[arg-type]
    return f"{noun}{quoted(pointer[-1])}"


def _located(detail: ErrorDetails, data: Any) -> _Violation:
    """The error with its place: pydantic's location without the tags."""
    pointer: list[str | int] = []
    mapping = last = ""
    for step in detail["loc"]:
        reachable = isinstance(step, int) if isinstance(data, list) else isinstance(data, dict) and step in data
        if reachable:
            data = data[step]
        elif step in TAGS:
            last = str(step)
            continue
        elif step == "[key]":
            continue
        else:
            data = None
        pointer.append(step)
        mapping = last
        if isinstance(step, str):
            last = step
    return _Violation(detail["type"], detail["msg"], detail.get("ctx", {}), detail["input"], tuple(pointer), mapping)


def _likeliest_key(key: str, keys: Iterable[str]) -> str | None:
    """The most similar known key, for a hint: looser than `near`, and dashes and blanks are ignored.

    Args:
        key: An unknown key.
        keys: The known ones, in lower case and with underscores.
    """
    folded = key.casefold().replace("-", "_").replace(" ", "_")
    return next(iter(difflib.get_close_matches(folded, list(keys), n=1)), None)


def _alternatives(key: str | int) -> tuple[str, ...]:
    """The keys of which one is required, where a required key is missing."""
    return ("link", "joint") if key == "link" else (str(key),)


def _grouped(pointers: Iterable[Pointer]) -> dict[Pointer, list[str]]:
    """The last keys of the pointers, by the mappings that contain them."""
    found: dict[Pointer, list[str]] = {}
    for pointer in pointers:
        found.setdefault(pointer[:-1], []).append(str(pointer[-1]))
    return found


def _lacking(mapping: Pointer, keys: Sequence[str], document: YamlDocument) -> Diagnostic:
    """The diagnostic of a mapping that lacks keys, of which one or all are one error (EU-DIA-001)."""
    said = sorted((" or ".join(f"'{other}'" for other in _alternatives(key)) for key in keys), key=len)
    listed = f"{', '.join(said[:-1])} and {said[-1]}" if len(said) > 1 else said[0]
    hint = next(filter(None, (key_outside_hint(mapping, key, document) for key in keys)), None)
    return Diagnostic("missing-key", f"{subject(mapping)} lacks {listed}", document.place(mapping), hint)


def _diagnostic(
    violation: _Violation, meant: str | None, document: YamlDocument, indentation: Indentation
) -> Diagnostic:
    """The diagnostic of one violation.

    Args:
        violation: What is wrong.
        meant: The required key that an unknown one misspells, or None.
        document: The file that was read.
        indentation: Finds what is probably indented wrongly.
    """
    pointer, value, context = violation.pointer, violation.value, violation.context
    name, place = subject(pointer), document.place(pointer)
    match violation.type:
        case violation_type if violation_type == _UNKNOWN_KEY:
            return _unknown_key(violation, meant, document)
        case "string_too_short" if pointer[-1] == "":
            message = f"a name in {subject(pointer[:-1])} is empty"
            return Diagnostic("wrong-value", message, document.place(pointer, key=True))
        case "string_too_short":
            return Diagnostic("wrong-value", f"{name} is empty", place)
        case "too_short" | "too_long":
            least, most = context.get("min_length"), context.get("max_length")
            bound = f"at least {least}" if most is None else f"at most {most}"
            if (least or most) in _EXACT_LENGTHS and not isinstance(value, dict):
                bound = str(least or most)
            items = "item" if bound.endswith(" 1") else "items"
            message = f"{name} must have {bound} {items}, not {context['actual_length']}"
            return Diagnostic("wrong-length", message, place)
        case "less_than_equal" | "greater_than_equal" if abs(context.get("le", context.get("ge"))) == LARGEST:
            return Diagnostic("number-out-of-bounds", f"{name} is {too_large(value)}", place, HINT)
        case "greater_than_equal":
            message = f"{name} must be at least {context['ge']:g}, not {described(value)}"
            return Diagnostic("out-of-range", message, place)
        case "finite_number":
            return Diagnostic("out-of-range", f"{name} must be a finite number", place)
        case "literal_error" if pointer[:1] == ("closures",):
            if _is_later_type(violation, document):
                message = f"{name} cannot be {described(value)} in a file of version 2.0"
                return Diagnostic("wrong-value", message, place, _version_hint(f"type '{value}'", document))
            return _wrong_choice(pointer, value, _closure_types(document), document)
        case "literal_error":
            return _wrong_choice(pointer, value, re.findall(r"'([^']*)'", context["expected"]), document)
        case "wrong-type" if isinstance(value, dict) and pointer[:-1] == ("joints",):
            return _wrong_choice((*pointer, "type"), value["type"], JOINT_TYPES, document)
        case "missing-key" if "present" in context:
            present = document.place((*pointer, context["present"]), key=True)
            return Diagnostic("missing-key", f"{name} {violation.message}", present)
        case "missing-key" | "wrong-value" | "out-of-range" as code:
            return Diagnostic(code, f"{name} {violation.message}", place)
        case "number-out-of-bounds" as code:
            return Diagnostic(code, f"{name} {violation.message}", place, HINT)
        case "wrong-type":
            must = violation.message
        case _:
            must = f"must be {_EXPECTED[violation.type]}"
    hint = indentation.hint(pointer, value) or _type_hint(must, pointer, value)
    return Diagnostic("wrong-type", f"{name} {must}, not {described(value)}", place, hint)


def _wrong_choice(pointer: Pointer, value: Any, allowed: Sequence[str], document: YamlDocument) -> Diagnostic:
    """The diagnostic of a value that is not one of those allowed."""
    *others, last = (f"'{choice}'" for choice in allowed)
    choices = f"{', '.join(others)} or {last}" if others else last
    message = f"{subject(pointer)} must be {choices}, not {described(value)}"
    if not isinstance(value, str):
        return Diagnostic("wrong-type", message, document.place(pointer))
    hint = _JOINT_TYPE_HINTS.get(value) if pointer[0] == "joints" else None
    return Diagnostic("wrong-value", message, document.place(pointer), hint or did_you_mean(value, allowed))


def _unknown_key(violation: _Violation, meant: str | None, document: YamlDocument) -> Diagnostic:
    """The diagnostic of a key that the mapping does not have, or that does not go with its others."""
    mapping, key = violation.pointer[:-1], str(violation.pointer[-1])
    place = document.place(violation.pointer, key=True)
    excluded = EXCLUDED.get(violation.mapping, {})
    if key in excluded:
        return Diagnostic("conflicting-keys", f"{subject(mapping)}: {excluded[key]}", place)
    keys = KEYS[violation.mapping]
    likely = meant or _likeliest_key(key, (*keys, *excluded))
    later = () if document.data.get("extended_urdf") == VERSION2_1 else ADDED_KEYS.get(violation.mapping, ())
    if meant is None and (outside := key_of_the_file_hint(violation.pointer)):
        hint = outside
    elif not mapping and key in FROM_VERSION1:
        hint = f"it is a key of version 1; in version 2.0, use '{FROM_VERSION1[key]}'"
    elif key in later:
        hint = _version_hint(f"'{key}'", document)
    elif meant is None and (of_joint := key_of_a_joint_hint(violation.pointer)):
        hint = of_joint
    elif likely is not None:
        hint = f"did you mean '{likely}'?"
        if meant is None and (beside := another_entry_hint(violation.pointer, document)):
            hint = f"did you mean '{likely}'? {beside}"
    elif beside := another_entry_hint(violation.pointer, document):
        hint = beside
    else:
        known = ", ".join(f"'{known}'" for known in keys if known not in later)
        hint = f"the keys here are {known}; your own keys begin with 'x-'"
    return Diagnostic("unknown-key", f"{subject(mapping)} has an unknown key {quoted(key)}", place, hint)


def _type_hint(must: str, pointer: Pointer, value: Any) -> str | None:
    """How to write what is probably meant, if it can be guessed."""
    if value is None:
        return None if isinstance(pointer[-1], int) else "remove the key if it has no value"
    if ("text" in must or "name" in must) and isinstance(value, bool | int | float):
        return "quote a name that looks like a number, true or false"
    if must == "must be a list" and isinstance(value, dict):
        return "begin each item with '- '"
    if must == "must be a list" and isinstance(value, str | int | float) and len(str(value)) <= 60:
        if pointer[-1] in ("xyz", "rpy", "axis"):
            return "write three numbers in brackets, like [0, 0, 1]"
        return f"write it as a list: [{value}]"
    if "number" in must and isinstance(value, str):
        try:
            number = float(value.replace("_", "").replace(",", "."))
        except ValueError:
            return None
        if math.isfinite(number):
            return f"write the number as {repr(number).removesuffix('.0')}, without quotes"
    return None
