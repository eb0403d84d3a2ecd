"""Whether a file conforms to the schema of its version.

The schemas are generated from the models (`eurdf.format.schema`). To import and build the models takes longer than all
else of reading a description, and only the errors of a file need them.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import cache
from math import inf
from typing import Any

from eurdf.collection import schema_folder
from eurdf.format.own_key import OWN_KEY, TWO_NAMES, is_own_key
from eurdf.format.version import Version

#: Whether a value conforms to a part of a schema.
Check = Callable[[Any], bool]

_TYPES: Mapping[str, tuple[type, ...]] = {
    "string": (str,),
    "number": (float, int),  # a bool is neither: the type of a value is compared
    "boolean": (bool,),
    "array": (list,),
    "object": (dict,),
}
_COMBINED = frozenset({"$ref", "const", "enum", "oneOf"})
_CONSTRAINTS = {
    "string": frozenset({"minLength", "pattern"}),
    "number": frozenset({"maximum", "minimum", "not"}),
    "boolean": frozenset[str](),
    "array": frozenset({"items", "minItems", "maxItems"}),
    "object": frozenset(
        {
            "additionalProperties",
            "anyOf",
            "dependentRequired",
            "else",
            "if",
            "minProperties",
            "patternProperties",
            "properties",
            "propertyNames",
            "required",
        }
    ),
}
_ANNOTATIONS = frozenset({"$defs", "$id", "$schema", "default", "description", "examples", "title", "type"})


@cache
def conforms(version: Version) -> Check:
    """A function that tells whether the data of a file conform to the schema of a version.

    The models accept what conforms. Numbers must be finite.
    """
    return compiled(schema_of(version))


@cache
def schema_of(version: Version) -> dict[str, Any]:
    """The schema of a version: from its file, or generated where the package was installed without these files."""
    folder = schema_folder()
    path = None if folder is None else folder / f"extended-urdf-{version}.schema.json"
    if path is None or not path.is_file():
        from eurdf.format.schema import json_schema

        return json_schema("2" if version == "2.0" else version)
    schema: dict[str, Any] = json.loads(path.read_bytes())
    return schema


def keys_of(version: Version) -> tuple[str, ...]:
    """The keys that a file of a version can have at its top level, except user-defined ones."""
    return tuple(schema_of(version)["properties"])


def compiled(schema: Mapping[str, Any]) -> Check:
    """The check of a schema that uses no more of JSON Schema than those of this package.

    Raises:
        ValueError: The schema uses more.
    """
    return _Compiler(schema.get("$defs", {})).check(schema)


class _Compiler:
    """Makes checks of the parts of one schema."""

    def __init__(self, definitions: Mapping[str, Any]) -> None:
        self._definitions = definitions
        self._made: dict[str, Check] = {}

    def check(self, schema: Mapping[str, Any]) -> Check:
        kind = schema.get("type")
        constraints = schema.keys() - _ANNOTATIONS
        if "$ref" in constraints:
            _refuse(constraints - {"$ref"})
            return self._referenced(schema["$ref"])
        if "oneOf" in constraints:
            _refuse(constraints - {"oneOf"})
            return self._one_of(schema["oneOf"])
        if "const" in constraints or "enum" in constraints:
            _refuse(constraints - {"const", "enum"})
            return _among([schema["const"]] if "const" in constraints else schema["enum"])
        if kind is None:
            _refuse(constraints)
            return _anything
        _refuse(constraints - _CONSTRAINTS[kind])
        return {
            "string": self._string,
            "number": self._number,
            "boolean": self._boolean,
            "array": self._array,
            "object": self._object,
        }[kind](schema)

    def _referenced(self, reference: str) -> Check:
        name = reference.removeprefix("#/$defs/")
        if name not in self._made:
            self._made[name] = self.check(self._definitions[name])
        return self._made[name]

    def _one_of(self, schemas: list[Mapping[str, Any]]) -> Check:
        # The forms exclude one another.
        by_type: dict[type, list[Check]] = {}
        for schema in schemas:
            resolved = schema
            while "$ref" in resolved:
                resolved = self._definitions[resolved["$ref"].removeprefix("#/$defs/")]
            check = self.check(schema)
            for kind in _TYPES[resolved["type"]]:
                by_type.setdefault(kind, []).append(check)

        of_type = {kind: _any_of(checks) for kind, checks in by_type.items()}.get
        return lambda value: of_type(type(value), _nothing)(value)

    def _string(self, schema: Mapping[str, Any]) -> Check:
        least = schema.get("minLength", 0)
        if "pattern" not in schema:
            return lambda value: type(value) is str and len(value) >= least
        _refuse({schema["pattern"]} - {OWN_KEY})
        return lambda value: type(value) is str and is_own_key(value)

    def _number(self, schema: Mapping[str, Any]) -> Check:
        if schema.keys().isdisjoint(_CONSTRAINTS["number"]):
            return _is_number
        least, most = schema.get("minimum", -inf), schema.get("maximum", inf)
        if "not" not in schema:
            return lambda value: type(value) in (float, int) and least <= value <= most
        below, above = schema["not"]["exclusiveMinimum"], schema["not"]["exclusiveMaximum"]
        return lambda value: type(value) in (float, int) and (least <= value <= below or above <= value <= most)

    def _boolean(self, schema: Mapping[str, Any]) -> Check:
        return lambda value: type(value) is bool

    def _array(self, schema: Mapping[str, Any]) -> Check:
        item = self.check(schema["items"])
        least, most = schema.get("minItems", 0), schema.get("maxItems", float("inf"))
        return lambda value: type(value) is list and least <= len(value) <= most and all(map(item, value))

    def _object(self, schema: Mapping[str, Any]) -> Check:
        known = {key: self.check(part) for key, part in schema.get("properties", {}).items()}
        of_others = schema.get("additionalProperties", True)
        other = _anything if of_others is True else _nothing if of_others is False else self.check(of_others)
        own = schema.get("patternProperties", {})
        _refuse(own.keys() - {OWN_KEY})
        name = self._string(schema.get("propertyNames", {}))
        required = frozenset(schema.get("required", ()))
        one_of = frozenset(key for part in schema.get("anyOf", ()) for key in part["required"])
        needed = [(key, frozenset(others)) for key, others in schema.get("dependentRequired", {}).items()]
        least = schema.get("minProperties", 0)
        _refuse({key for key in ("minProperties", "if", "else") if key in schema and schema[key] != TWO_NAMES[key]})

        def check(value: Any) -> bool:
            if type(value) is not dict or not required <= value.keys():
                return False
            if least and len(value) - sum(map(is_own_key, value)) < least:  # stricter than JSON Schema can be
                return False
            for key, item in value.items():
                check_item = known.get(key)
                if check_item is None:
                    if not (own and is_own_key(key)) and not (name(key) and other(item)):
                        return False
                elif not check_item(item):
                    return False
            if one_of and one_of.isdisjoint(value):
                return False
            return not needed or all(others <= value.keys() for key, others in needed if key in value)

        return check


def _any_of(checks: list[Check]) -> Check:
    if len(checks) == 1:
        return checks[0]

    def check(value: Any) -> bool:
        for each in checks:  # noqa: SIM110 - `any` takes twice as long
            if each(value):
                return True
        return False

    return check


def _among(values: list[Any]) -> Check:
    if all(type(value) is str for value in values):
        texts = frozenset(values)
        return lambda value: type(value) is str and value in texts
    return lambda value: any(type(value) is type(each) and value == each for each in values)


def _is_number(value: Any) -> bool:
    return type(value) is float or type(value) is int


def _anything(value: Any) -> bool:
    return True


def _nothing(value: Any) -> bool:
    return False


def _refuse(unknown: set[str] | frozenset[str]) -> None:
    if unknown:
        raise ValueError(f"{sorted(unknown)} of JSON Schema is not supported")
