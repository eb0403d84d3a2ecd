"""The parts of the models of both versions: a strict mapping, and the types of its fields."""

# Annotations are evaluated in this module: older pydantic looks an inherited one up in the module that inherits it.

from collections.abc import Callable
from typing import Annotated, Any, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema
from typing_extensions import TypeAliasType

from eurdf.format.numbers import LARGEST, SMALLEST, is_too_small, too_small
from eurdf.format.own_key import OWN_KEY, TWO_NAMES, is_own_key

#: Strict: no string is a number, a bool is no number, an int is one. Built at first use, since one run mostly
#: reads one version.
STRICT = ConfigDict(strict=True, allow_inf_nan=False, frozen=True, defer_build=True)

_OWN_DATA = {"title": "Own data", "description": "User data: kept, not interpreted."}


class StrictMapping(BaseModel):
    """A mapping that has its known keys and user-defined ones, ``x-…``, and no others."""

    model_config = ConfigDict(**STRICT, extra="allow")
    __pydantic_extra__: dict[Annotated[str, Field(pattern=OWN_KEY)], Any]

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler, /) -> JsonSchemaValue:
        """As generated, with ``x-…`` as the only further keys, and null nowhere."""
        written = handler(schema)
        mapping = handler.resolve_ref_schema(written)
        for name, field in cls.model_fields.items():
            entry = mapping["properties"][name]
            entry["title"] = field.title
            if field.default is None:
                del entry["default"]
        mapping["patternProperties"] = {OWN_KEY: _OWN_DATA}
        mapping["additionalProperties"] = False
        return written


class _NotNull:
    """Removes ``| None`` from the values that a file may have: in Python, None means that the key is left out."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        schema = handler(source)
        if schema["type"] != "nullable":
            raise TypeError("a value that may be left out is annotated '… | None'")
        inner: CoreSchema = schema["schema"]
        return inner


class _OwnKeysApart:
    """For a mapping whose keys are names: keys that begin with ``x-`` are not names and can have any value."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_before_validator_function(_without_own_keys, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        mapping = handler(schema)
        mapping["patternProperties"] = {OWN_KEY: _OWN_DATA}
        return mapping


class _TwoNames:
    """For a mapping with two names at least."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return handler(source)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        return {**handler(schema), **TWO_NAMES}


def _without_own_keys(value: Any) -> Any:
    """EU-EXT-004: user-defined keys are not names."""
    if isinstance(value, dict):
        return {key: item for key, item in value.items() if not is_own_key(key)}
    return value


def either(form: Callable[[Any], str | None], expected: str) -> Discriminator:
    """A union whose form is decided before validation, so that errors refer to the intended form only.

    Args:
        form: Gives the tag of the form that a value is meant to have, or None. No tag is a key of the format.
        expected: What the value must be, as the message says if it has no such form.
    """
    return Discriminator(form, custom_error_type="wrong-type", custom_error_message=f"must be {expected}")


def _refuse_zero(number: float) -> float:
    if number == 0.0:
        raise PydanticCustomError("out-of-range", "must not be 0")
    if is_too_small(number):
        raise PydanticCustomError("number-out-of-bounds", "is {what}", {"what": too_small(number)})
    return number


# Named, so that the schema holds the bounds of EU-FIL-005 once.
Number = TypeAliasType("Number", Annotated[float, Field(ge=-LARGEST, le=LARGEST)])
NonNegative = TypeAliasType("NonNegative", Annotated[float, Field(ge=0, le=LARGEST)])
#: One that others are divided by.
NonZero = TypeAliasType(
    "NonZero",
    Annotated[
        float,
        Field(
            ge=-LARGEST,
            le=LARGEST,
            # With its type, so that a text is one error in an editor, not two.
            json_schema_extra={"not": {"type": "number", "exclusiveMinimum": -SMALLEST, "exclusiveMaximum": SMALLEST}},
        ),
        AfterValidator(_refuse_zero),
    ],
)


_T = TypeVar("_T")

#: A value that may be left out but must not be null.
MayLack = Annotated[_T | None, _NotNull()]

#: A mapping from names to values, which can also contain user-defined keys.
ByName = Annotated[dict[Annotated[str, Field(min_length=1)], _T], _OwnKeysApart()]

#: The same with two names at least.
AtLeastTwoByName = Annotated[
    dict[Annotated[str, Field(min_length=1)], _T], Field(min_length=2), _OwnKeysApart(), _TwoNames()
]


# Each named type has a definition of its own in the schema; the names of one robot are inserted there.
LinkName = TypeAliasType(
    "LinkName", Annotated[str, Field(min_length=1, title="Link", description="Name of a link of the URDF.")]
)
UrdfJointName = TypeAliasType(
    "UrdfJointName",
    Annotated[str, Field(min_length=1, title="Joint of the URDF", description="Name of a joint of the URDF.")],
)
JointName = TypeAliasType(
    "JointName",
    Annotated[
        str,
        Field(min_length=1, title="Joint", description="Name of a joint, of the URDF or made by this file."),
    ],
)
MovingJointName = TypeAliasType(
    "MovingJointName",
    Annotated[
        str,
        Field(
            min_length=1,
            title="Moving joint",
            description="Name of a joint that can move, of the URDF or made by this file.",
        ),
    ],
)
FrameName = TypeAliasType(
    "FrameName",
    Annotated[
        str,
        Field(
            min_length=1,
            title="Frame",
            description="Name of a link, of a joint (its frame on the child's side), or of a frame of this file.",
        ),
    ],
)
