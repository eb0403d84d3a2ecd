"""What a value of the YAML file may be: each type checks values, reads them, writes them, and has a JSON Schema.

The models (`eurdf.format.model`) consist of these types. They are plain data, since reading has no time for more: to
import pydantic and to build its models takes longer than all else of reading a description.
"""

from __future__ import annotations

import sys
from collections.abc import Collection
from typing import Any, Literal, NamedTuple

from eurdf.diagnostics.wording import plural
from eurdf.format.conventions import (
    LARGEST,
    OWN_KEY,
    SMALLEST,
    Version,
    is_own_key,
    is_too_small,
    lower_limit,
    too_large,
    too_small,
    upper_limit,
)
from eurdf.reading.yaml_node import Pointer

Schema = dict[str, Any]

#: What the schema says of user-defined keys.
OWN_DATA: Schema = {"title": "Own data", "description": "User data: kept, not interpreted."}

# -- checking and writing schemas --------------------------------------------------------------------------------------


class Violation(NamedTuple):
    """One error of a file.

    Attributes:
        pointer: The place of the value.
        code: That of the diagnostic.
        text: The message behind the name of the value.
        value: The value.
        about: What the message needs besides: of a ``choice`` the allowed values; of an unknown key its mapping's
            `Record` and the `OneOf` that this is one form of, or None; of a missing key the one that needs it.
    """

    pointer: Pointer
    code: str
    text: str = ""
    value: Any = None
    about: Any = None


class Check:
    """The check of one file of some version, and its errors."""

    def __init__(self, version: Version) -> None:
        self.version = version
        self.found: list[Violation] = []

    def report(self, pointer: Pointer, code: str, text: str = "", value: Any = None, about: Any = None) -> None:
        """Add an error."""
        self.found.append(Violation(pointer, code, text, value, about))


class Schemas:
    """The JSON Schemas of the types in one version; the definitions are of those that have a name, by that name."""

    def __init__(self, version: Version) -> None:
        self.version = version
        self.definitions: Schema = {}

    def of(self, kind: ValueType) -> Schema:
        """The schema of a type; of one that has a name, a reference to its definition."""
        if not kind.name:
            return kind.schema(self)
        if kind.name not in self.definitions:
            self.definitions[kind.name] = {}  # its place, for a type within itself
            self.definitions[kind.name] = kind.schema(self)
        return {"$ref": f"#/$defs/{kind.name}"}


# -- types ------------------------------------------------------------------------------------------------------------


class ValueType:
    """A type of values.

    Attributes:
        types: Types of the Python values that it is for.
        name: Of its definition in the schema; empty where the schema repeats it.
        since: The first version that has it.
    """

    types: Collection[type] = ()
    name = ""
    since: Version = "1"

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        """Report what is wrong with a value."""

    def read(self, value: Any, at: Pointer) -> Any:
        """What a valid value means."""
        return value

    def write(self, value: Any) -> Any:
        """The value of a file that means this."""
        return value

    def schema(self, schemas: Schemas) -> Schema:
        """The JSON Schema of the values."""
        raise NotImplementedError

    def default(self, value: Any) -> Any:
        """The value of a file that the schema shows for what a key means if it is left out; None for none."""
        return value


class Text(ValueType):
    """A text that is not empty."""

    types = (str,)

    def __init__(self, name: str = "", title: str = "", text: str = "") -> None:
        self.name = name
        self._shown = {"title": title, "description": text} if name else {}

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        if type(value) is not str:
            file.report(at, "wrong-type", "must be text", value)
        elif not value:
            file.report(at, "wrong-value", "is empty")

    def schema(self, schemas: Schemas) -> Schema:
        return {"minLength": 1, "type": "string", **self._shown}


class Choice(ValueType):
    """One of several texts."""

    types = (str,)

    def __init__(self, *values: str) -> None:
        self.values = values

    def allowed(self, version: Version) -> tuple[str, ...]:
        """The texts, in a version."""
        return self.values

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        allowed = self.allowed(file.version)
        if type(value) is not str or value not in allowed:
            file.report(at, "choice", value=value, about=allowed)

    def schema(self, schemas: Schemas) -> Schema:
        allowed = self.allowed(schemas.version)
        return {"type": "string", **({"const": allowed[0]} if len(allowed) == 1 else {"enum": [*allowed]})}


class ThisVersion(Choice):
    """The version of the file."""

    def allowed(self, version: Version) -> tuple[str, ...]:
        return (version,)


class Number(ValueType):
    """A number.

    EU-FIL-006: one that has no bound on one side does not limit if it is beyond `LARGEST` on that side.

    Args:
        name: Of its definition.
        least: Smallest one, if any.
        most: Largest one, if any.
        divides: Whether others are divided by it.
    """

    types = (float, int)

    def __init__(
        self, name: str = "", least: float | None = -LARGEST, most: float | None = LARGEST, *, divides: bool = False
    ) -> None:
        self.name = name
        self.least, self.most, self.divides = least, most, divides

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        if type(value) is not float and type(value) is not int:
            file.report(at, "wrong-type", "must be a number", value)
        elif self.least is not None and value < self.least:
            if self.least == -LARGEST:
                file.report(at, "number-out-of-bounds", f"is {too_large(value)}")
            else:
                file.report(at, "out-of-range", f"must be at least {self.least:g}", value)
        elif self.most is not None and value > self.most:
            file.report(at, "number-out-of-bounds", f"is {too_large(value)}")
        elif self.divides and value == 0.0:
            file.report(at, "out-of-range", "must not be 0")
        elif self.divides and is_too_small(value):
            file.report(at, "number-out-of-bounds", f"is {too_small(value)}")

    def read(self, value: float, at: Pointer) -> float:
        number = lower_limit(value) if self.least is None else upper_limit(value) if self.most is None else value
        return float(number)

    def write(self, value: float) -> float:
        """Whole numbers as integers, and infinite ones as the largest double."""
        value = min(max(value, -sys.float_info.max), sys.float_info.max)
        return int(value) if isinstance(value, float) and value.is_integer() and abs(value) < LARGEST else value

    def schema(self, schemas: Schemas) -> Schema:
        found = {"minimum": self.least, "maximum": self.most}
        schema: Schema = {key: bound for key, bound in found.items() if bound is not None}
        if self.divides:  # with its type, so that a text is one error in an editor, not two
            schema["not"] = {"type": "number", "exclusiveMinimum": -SMALLEST, "exclusiveMaximum": SMALLEST}
        return {"type": "number", **schema}


class Never(ValueType):
    """The value false, and no other."""

    types = (bool,)

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        if type(value) is not bool:
            file.report(at, "wrong-type", "must be false", value)
        elif value:
            file.report(at, "wrong-value", "must be false, not true")

    def schema(self, schemas: Schemas) -> Schema:
        return {"const": False, "type": "boolean"}


class Anything(ValueType):
    """Any mapping."""

    types = (dict,)

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        if type(value) is not dict:
            file.report(at, "wrong-type", "must be a mapping", value)

    def write(self, value: Any) -> Any:
        return dict(value)

    def schema(self, schemas: Schemas) -> Schema:
        return {"type": "object", "additionalProperties": True}


class ListOf(ValueType):
    """A list with items of one type; read, it is a tuple."""

    types = (list,)

    def __init__(self, item: ValueType, least: int = 0, most: int | None = None, name: str = "") -> None:
        self.item, self.least, self.most, self.name = item, least, most, name

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        if type(value) is not list:
            file.report(at, "wrong-type", "must be a list", value)
        elif self.most is not None and len(value) > self.most:
            bound = "" if self.least == self.most else "at most "
            file.report(at, "wrong-length", f"must have {bound}{plural(self.most, 'item')}, not {len(value)}")
        else:
            before = len(file.found)
            for index, item in enumerate(value):
                self.item.check(item, (*at, index), file)
            if len(value) < self.least and len(file.found) == before:
                bound = "" if self.least == self.most else "at least "
                file.report(at, "wrong-length", f"must have {bound}{plural(self.least, 'item')}, not {len(value)}")

    def read(self, value: list[Any], at: Pointer) -> tuple[Any, ...]:
        read = self.item.read
        return tuple([read(item, (*at, index)) for index, item in enumerate(value)])

    def write(self, value: Collection[Any]) -> list[Any]:
        return [self.item.write(item) for item in value]

    def schema(self, schemas: Schemas) -> Schema:
        bounds = {key: bound for key, bound in (("minItems", self.least), ("maxItems", self.most)) if bound}
        return {"type": "array", "items": schemas.of(self.item), **bounds}

    def default(self, value: tuple[Any, ...]) -> list[Any] | None:
        return [*value] if len(value) >= self.least else None


class ByName(ValueType):
    """A mapping from names to values of one type.

    EU-EXT-004: keys that begin with ``x-`` are not names and can have any value.

    Args:
        item: Type of the values.
        least: Smallest number of names, 0 or 2.
        entries: Whether the values are entries that have their name; the mapping is then read as a tuple of them.
        keys: What the names are those of; None for names that are given here.
    """

    types = (dict,)

    def __init__(
        self, item: ValueType, least: Literal[0, 2] = 0, *, entries: bool = False, keys: Text | None = None
    ) -> None:
        self.item, self.least, self._entries, self.keys = item, least, entries, keys

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        if type(value) is not dict:
            file.report(at, "wrong-type", "must be a mapping", value)
            return
        before = len(file.found)
        named = {key: item for key, item in value.items() if not is_own_key(key)}
        for name, item in named.items():
            if not name:
                file.report((*at, name), "empty-name")
            self.item.check(item, (*at, name), file)
        if len(named) < self.least and len(file.found) == before:
            file.report(at, "wrong-length", f"must have at least {self.least} items, not {len(named)}")

    def read(self, value: dict[str, Any], at: Pointer) -> Any:
        read = {name: self.item.read(item, (*at, name)) for name, item in value.items() if not is_own_key(name)}
        return tuple(read.values()) if self._entries else read

    def write(self, value: Any) -> dict[str, Any]:
        items = {entry.name: entry for entry in value} if self._entries else value
        return {name: self.item.write(item) for name, item in items.items()}

    def schema(self, schemas: Schemas) -> Schema:
        schema: Schema = {
            "type": "object",
            "additionalProperties": schemas.of(self.item),
            "patternProperties": {OWN_KEY: OWN_DATA},
            "propertyNames": {"minLength": 1},
        }
        if self.least:
            # JSON Schema counts all keys of a mapping alike: where there are user-defined ones, two names make three
            # keys at least. It takes two of them or more for names, which `check` does not.
            schema["minProperties"] = self.least
            schema["if"] = {"propertyNames": {"not": {"pattern": OWN_KEY}}}
            schema["else"] = {"minProperties": self.least + 1}
        return schema

    def default(self, value: Any) -> Any:
        return {}


# -- types that several models use ------------------------------------------------------------------------------------

NAME = Text()
LINK_NAME = Text("LinkName", "Link", "Name of a link of the URDF.")
URDF_JOINT_NAME = Text("UrdfJointName", "Joint of the URDF", "Name of a joint of the URDF.")
JOINT_NAME = Text("JointName", "Joint", "Name of a joint, of the URDF or made by this file.")
MOVING_JOINT_NAME = Text(
    "MovingJointName", "Moving joint", "Name of a joint that can move, of the URDF or made by this file."
)
FRAME_NAME = Text(
    "FrameName", "Frame", "Name of a link, of a joint (its frame on the child's side), or of a frame of this file."
)

NUMBER = Number("Number")
NON_NEGATIVE = Number("NonNegative", 0)
NON_ZERO = Number("NonZero", divides=True)
VECTOR = ListOf(NUMBER, 3, 3, "Vector")
