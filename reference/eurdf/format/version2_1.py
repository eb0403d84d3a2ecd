"""Version 2.1 of the YAML file, as pydantic models: version 2.0, and what it adds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, Tag

from eurdf.format import version2
from eurdf.format.field import StrictMapping, either
from eurdf.format.version2 import Closure, FrameReference, Name, Vector, Version2

VERSION: Literal["2.1"] = "2.1"

#: Keys of a closure that version 2.1 adds.
_AXES = ("axis", "axes")


class _Hinge(StrictMapping):
    """Two frames that turn about one axis."""

    name: Name = Field(title="Name", description="Name of the closure, unique in the file.", examples=["knee_pin"])
    type: Literal["hinge"] = Field(
        title="Type",
        description="hinge: the origin of frame B is held on that of A, and an axis of B along an axis of A (5 rows, m"
        " and rad).",
        examples=["hinge"],
    )
    frames: Annotated[list[FrameReference], Field(min_length=2, max_length=2)] = Field(
        title="Frames A and B",
        description="Two frames, each a name, or a pose on a link or joint.",
        examples=[["coupler_tip", "rocker_tip"]],
    )


class Hinge(_Hinge):
    """A hinge about one axis, which both frames have."""

    model_config = ConfigDict(title="Hinge closure")

    axis: Vector = Field(
        default=[0.0, 0.0, 1.0],
        title="Axis",
        description="The axis in frame A and in frame B: a vector of any length but zero, no unit.",
        examples=[[0, 1, 0]],
    )


class HingeAboutTwo(_Hinge):
    """A hinge that holds an axis of frame B along an axis of frame A."""

    model_config = ConfigDict(title="Hinge closure with two axes")

    axes: Annotated[list[Vector], Field(min_length=2, max_length=2)] = Field(
        title="Axes",
        description="The axis in frame A, and the axis in frame B: vectors of any length but zero, no unit.",
        examples=[[[0, 0, 1], [0, 1, 0]]],
    )


def _closure_form(value: Any) -> str | None:
    if not isinstance(value, dict):
        return None
    if value.get("type", "hinge") != "hinge" or value.keys().isdisjoint(("type", *_AXES)):
        return "plain closure"
    return "hinge with axes" if "axes" in value else "hinge"


AnyClosure = Annotated[
    Annotated[Closure, Tag("plain closure")]
    | Annotated[Hinge, Tag("hinge")]
    | Annotated[HingeAboutTwo, Tag("hinge with axes")],
    either(_closure_form, "a mapping {name: …, type: …, frames: …}"),
]


class Version2_1(Version2):  # noqa: N801 - the version has a point
    """A robot's loop closures, actuators, joints, frames and configurations beside its URDF."""

    model_config = ConfigDict(title="Extended URDF, version 2.1")

    extended_urdf: Literal["2.1"] = Field(  # type: ignore[assignment]  # another version
        title="Version", description="Version of the format, in quotes.", examples=["2.1"]
    )
    closures: list[AnyClosure] = Field(  # type: ignore[assignment]  # of more types
        default=[],
        title="Loop closures",
        description="Pairs of frames that are held together.",
        examples=[[{"name": "knee_pin", "type": "hinge", "frames": ["coupler_tip", "rocker_tip"], "axis": [0, 1, 0]}]],
    )


_ALONE = "'axis' and 'axes' exclude one another"

#: As in version 2.0, and of the forms that version 2.1 adds.
KEYS: Mapping[str, tuple[str, ...]] = {
    **version2.KEYS,
    "plain closure": version2.KEYS["closures"],
    "hinge": tuple(Hinge.model_fields),
    "hinge with axes": tuple(HingeAboutTwo.model_fields),
}
TAGS = version2.TAGS | {"plain closure", "hinge", "hinge with axes"}
EXCLUDED: Mapping[str, Mapping[str, str]] = {
    **version2.EXCLUDED,
    "plain closure": {key: f"'{key}' goes with type 'hinge'" for key in _AXES},
    "hinge with axes": {"axis": _ALONE},
}

#: Types of closure in each version, beside user-defined ones.
CLOSURE_TYPES: Mapping[str, tuple[str, ...]] = {"2.0": ("3d", "6d"), VERSION: ("3d", "6d", "hinge")}

#: Keys of a closure that version 2.1 adds.
ADDED_KEYS = frozenset(_AXES)
