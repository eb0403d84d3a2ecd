"""Each constraint of the schemas has a case: a parser that lacks one of them accepts an invalid description."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator
from functools import reduce
from operator import getitem
from typing import Any

import pytest
from jsonschema import Draft202012Validator, ValidationError

from eurdf.format.conventions import Version
from eurdf.format.schema import NUMBERS, SchemaVersion, json_schema
from eurdf.reading.source import decoded
from eurdf.reading.yaml_reader import read_yaml
from eurdf_conformance.corpus.case import InvalidCase
from eurdf_conformance.corpus.read import all_cases

CODES = (
    "missing-key",
    "unknown-key",
    "wrong-type",
    "wrong-length",
    "wrong-value",
    "out-of-range",
    "conflicting-keys",
    "number-out-of-bounds",
)
REMOVED = (
    "additionalProperties",
    "dependentRequired",
    "minItems",
    "maxItems",
    "minLength",
    "minimum",
    "maximum",
    "not",
    "enum",
)

#: What distinguishes the forms of an entry: an entry without it has another form.
TOLD_APART = {"type"}


def _invalid(version: Version) -> list[Any]:
    """The descriptions of cases of schema errors; what is invalid in version 2.0 is read as 2.1 too."""
    found = []
    for case in all_cases():
        if not isinstance(case.case, InvalidCase) or case.case.code not in CODES:
            continue
        written = NUMBERS[case.case.version]
        if written != version and (written, version) != ("2.0", "2.1"):
            continue
        data = read_yaml(decoded(case.files[case.case.description], case.case.description)).data
        if "extended_urdf" in data and written != version:
            data = {**data, "extended_urdf": version}
        found.append(data)
    return found


def _constraints(schema: Any, at: tuple[str | int, ...] = ()) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Where there is a constraint, and its key; of a list of required keys, one of them."""
    if isinstance(schema, list):
        for index, part in enumerate(schema):
            yield from _constraints(part, (*at, index))
    if not isinstance(schema, dict):
        return
    is_schema = not at or at[-1] not in ("properties", "$defs", "patternProperties")
    for key, value in schema.items():
        if is_schema and key == "required" and "anyOf" not in at:
            yield from ((at, f"required {name}") for name in value if name not in TOLD_APART)
        elif is_schema and key in REMOVED and (key != "additionalProperties" or value is False):
            yield at, key
        if key not in ("default", "examples", "if", "else"):
            yield from _constraints(value, (*at, key))


def _without(schema: Any, at: tuple[str | int, ...], constraint: str) -> Any:
    """The schema without one constraint; what does not contain it is shared, not copied."""
    if at:
        changed = copy.copy(schema)
        changed[at[0]] = _without(schema[at[0]], at[1:], constraint)
        return changed
    key, _, name = constraint.partition(" ")
    changed = {other: value for other, value in schema.items() if other != key}
    if name:
        changed[key] = [other for other in schema[key] if other != name]
    if key == "enum":
        changed["type"] = "string"
    return changed


def _failing(errors: Iterable[ValidationError]) -> Iterator[tuple[int, str]]:
    """The schemas that errors are of, each with the constraint that failed, in every form of a value."""
    for error in errors:
        yield id(error.schema), str(error.validator)
        yield from _failing(error.context or ())


@pytest.mark.parametrize("version", ["1", "2", "2.1"])
def test_each_constraint_of_a_schema_has_a_case(version: SchemaVersion) -> None:
    schema = json_schema(version)
    validator = Draft202012Validator(schema)
    failing: dict[tuple[int, str], list[Any]] = {}  # the descriptions, by what is invalid in them
    for data in _invalid(NUMBERS[version]):
        for failed in {*_failing(validator.iter_errors(data))}:
            failing.setdefault(failed, []).append(data)
    untested = []
    for at, constraint in _constraints(schema):
        accepts = Draft202012Validator(_without(schema, at, constraint)).is_valid
        constrained: Any = reduce(getitem, at, schema)  # type: ignore[arg-type]
        candidates = failing.get((id(constrained), constraint.partition(" ")[0]), ())
        if not any(map(accepts, candidates)) and "HingeAboutTwo" not in at:  # which is a hinge
            untested.append(f"{'/'.join(map(str, at))}: {constraint}")
    assert untested == []
