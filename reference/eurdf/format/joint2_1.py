"""Entries of joints in version 2.1: those of version 2.0, with springs, and joints freed from their leader."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import AfterValidator, Field, GetJsonSchemaHandler, Tag, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError
from typing_extensions import Self, TypeAliasType

from eurdf.format import version2
from eurdf.format.field import MayLack, StrictMapping, either
from eurdf.format.version2 import NonNegativePerVelocity, PerCoordinate


def _refuse_true(value: bool) -> bool:
    if value:
        raise PydanticCustomError("wrong-value", "must be false, not true")
    return value


class Added(StrictMapping):
    """What version 2.1 adds to the entry of a joint of any type."""

    stiffness: MayLack[NonNegativePerVelocity] = Field(
        default=None,
        title="Stiffness",
        description="Stiffness of a spring on each coordinate, N·m/rad or N/m, not negative: a number, or a list, one"
        " for each coordinate.",
        examples=[1200.0, [300, 200]],
    )
    rest: MayLack[PerCoordinate] = Field(
        default=None,
        title="Rest position",
        description="Coordinate at which the spring has no force, rad or m; 0 if left out: a number, or a list, one for"
        " each coordinate.",
        examples=[0.1, [0.1, -0.2]],
    )
    mimic: MayLack[Annotated[bool, AfterValidator(_refuse_true)]] = Field(
        default=None,
        title="Mimic",
        description="false: the joint has a coordinate of its own, although it has a <mimic> in the URDF.",
        examples=[False],
        json_schema_extra={"const": False},
    )

    @model_validator(mode="after")
    def _rest_of_a_spring(self) -> Self:
        if self.rest is not None and self.stiffness is None:
            raise PydanticCustomError("missing-key", "has 'rest' but lacks 'stiffness'", {"present": "rest"})
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler, /) -> JsonSchemaValue:
        """As generated, with a rest position only beside a stiffness."""
        written = super().__get_pydantic_json_schema__(schema, handler)
        handler.resolve_ref_schema(written)["dependentRequired"] = {"rest": ["stiffness"]}
        return written


#: Keys of the entry of a joint that version 2.1 adds.
ADDED = tuple(Added.model_fields)


class Overridden(version2.Overridden, Added):
    """A joint that keeps its type, with some properties in place of the URDF's."""

    one_of: ClassVar[tuple[str, ...]] = (*version2.Overridden.one_of, "stiffness", "mimic")


class Spherical(version2.Spherical, Added):
    """A ball joint."""


class Universal(version2.Universal, Added):
    """A cardan joint."""


class Cylindrical(version2.Cylindrical, Added):
    """A joint that slides along its axis and turns about it."""


class Helical(version2.Helical, Added):
    """A screw."""


class Fixed(version2.Fixed, Added):
    """A joint locked at its zero."""


Joint = TypeAliasType(
    "Joint",
    Annotated[
        Annotated[Literal["spherical", "cylindrical", "fixed"], Tag("type alone")]
        | Annotated[Overridden, Tag("kept type")]
        | Annotated[Spherical, Tag("spherical joint")]
        | Annotated[Universal, Tag("universal joint")]
        | Annotated[Cylindrical, Tag("cylindrical joint")]
        | Annotated[Helical, Tag("helical joint")]
        | Annotated[Fixed, Tag("fixed joint")],
        either(version2.joint_form, "a joint type, or a mapping {type: …, limits: …}"),
    ],
)
