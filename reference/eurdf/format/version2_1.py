"""Version 2.1 of the YAML file, as pydantic models: version 2.0, and what it adds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, Tag

from eurdf.format import actuator2_1, joint2_1, version2
from eurdf.format.compliance import Compliance, Compliant
from eurdf.format.field import AtLeastTwoByName, ByName, NonZero, Number, StrictMapping, either
from eurdf.format.numbers import LARGEST
from eurdf.format.version2 import FrameReference, Name, Vector, Version2

#: Smallest length of a distance closure, m.
LEAST_LENGTH = 1e-4

#: Keys of a closure that version 2.1 adds, by the type that they go with.
_KEYS_OF_TYPES = {"axis": "hinge", "axes": "hinge", "length": "distance"}


# A field of a base that is named earlier comes later: editors offer a name first.
class Closure(Compliant, version2.Closure):
    """Two frames that are joined."""


class _AddedClosure(StrictMapping):
    """Two frames, related by a closure of a type that version 2.0 does not have."""

    name: Name = Field(title="Name", description="Name of the closure, unique in the file.", examples=["knee_pin"])
    type: str
    frames: Annotated[list[FrameReference], Field(min_length=2, max_length=2)] = Field(
        title="Frames A and B",
        description="Two frames, each a name, or a pose on a link or joint.",
        examples=[["coupler_tip", "rocker_tip"]],
    )


class _Hinge(_AddedClosure):
    """Two frames that turn about one axis."""

    type: Literal["hinge"] = Field(
        title="Type",
        description="hinge: the origin of frame B is held on that of A, and an axis of B along an axis of A (5 rows, m"
        " and rad).",
        examples=["hinge"],
    )


class Hinge(Compliant, _Hinge):
    """A hinge about one axis, which both frames have."""

    model_config = ConfigDict(title="Hinge closure")

    axis: Vector = Field(
        default=[0.0, 0.0, 1.0],
        title="Axis",
        description="The axis in frame A and in frame B: a vector of any length but zero, no unit.",
        examples=[[0, 1, 0]],
    )


class HingeAboutTwo(Compliant, _Hinge):
    """A hinge that holds an axis of frame B along an axis of frame A."""

    model_config = ConfigDict(title="Hinge closure with two axes")

    axes: Annotated[list[Vector], Field(min_length=2, max_length=2)] = Field(
        title="Axes",
        description="The axis in frame A, and the axis in frame B: vectors of any length but zero, no unit.",
        examples=[[[0, 0, 1], [0, 1, 0]]],
    )


class Distance(Compliant, _AddedClosure):
    """Two frames whose origins are at a fixed distance."""

    model_config = ConfigDict(title="Distance closure")

    type: Literal["distance"] = Field(
        title="Type",
        description="distance: the origins of frames A and B are at a fixed distance, as those of the ball joints of a"
        " rod (1 row, m).",
        examples=["distance"],
    )
    length: Annotated[float, Field(ge=LEAST_LENGTH, le=LARGEST)] = Field(
        title="Length", description="Distance between the origins of A and B, m, at least 0.0001.", examples=[0.155]
    )


def _closure_form(value: Any) -> str | None:
    if not isinstance(value, dict):
        return None
    implied = next((kind for key, kind in _KEYS_OF_TYPES.items() if key in value), None)
    match value.get("type", implied):
        case "hinge":
            return "hinge with axes" if "axes" in value else "hinge"
        case "distance":
            return "distance"
    return "plain closure"


AnyClosure = Annotated[
    Annotated[Closure, Tag("plain closure")]
    | Annotated[Hinge, Tag("hinge")]
    | Annotated[HingeAboutTwo, Tag("hinge with axes")]
    | Annotated[Distance, Tag("distance")],
    either(_closure_form, "a mapping {name: …, type: …, frames: …}"),
]


class Coupling(StrictMapping):
    """A linear relation of joint coordinates."""

    model_config = ConfigDict(title="Coupling")

    name: Name = Field(
        title="Name", description="Name of the coupling, unique among closures and couplings.", examples=["knee_gear"]
    )
    joints: AtLeastTwoByName[NonZero] = Field(
        title="Joints",
        description="By joint, its coefficient, not 0: the coordinates (rad, m) times the coefficients add up to"
        " 'offset'. Two or more revolute, continuous, prismatic or helical joints.",
        examples=[{"motor_1": 0.5, "motor_2": 0.5, "knee": -1}],
    )
    offset: Number = Field(
        default=0.0,
        title="Offset",
        description="What the coordinates times the coefficients add up to, in the unit of these products.",
        examples=[0.2],
    )


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
    joints: ByName[joint2_1.Joint] = Field(  # type: ignore[assignment]  # with more properties
        default={},
        title="Joints",
        description=version2.Version2.model_fields["joints"].description,
        examples=[{"hip_ball": "spherical", "spring_ankle": {"stiffness": 1200.0, "rest": 0.1}}],
    )
    actuators: list[actuator2_1.Actuator] = Field(  # type: ignore[assignment]  # with more properties
        default=[],
        title="Actuators",
        description="The joints that have a motor: names, or mappings with name, gear and control range.",
        examples=[["motor_hip_x", {"joint": "motor_knee", "gear_ratio": 50, "control": [-80, 80]}]],
    )
    couplings: list[Coupling] = Field(
        default=[],
        title="Couplings",
        description="Linear relations of joint coordinates, as gears, belts and differentials make them.",
        examples=[[{"name": "knee_gear", "joints": {"motor_1": 0.5, "motor_2": 0.5, "knee": -1}}]],
    )


#: Forms of the entry of a joint that are mappings.
_JOINT_FORMS = ("kept type", *(f"{kind} joint" for kind in version2.JOINT_TYPES))

_ALONE = "'axis' and 'axes' exclude one another"


def _of_other_types(*kinds: str) -> dict[str, str]:
    """The keys of closures of other types than these, and why they do not go with them."""
    return {key: f"'{key}' goes with type '{kind}'" for key, kind in _KEYS_OF_TYPES.items() if kind not in kinds}


#: As in version 2.0, and of the forms that version 2.1 adds.
KEYS: Mapping[str, tuple[str, ...]] = {
    **version2.KEYS,
    "": tuple(Version2_1.model_fields),
    "couplings": tuple(Coupling.model_fields),
    "plain closure": tuple(Closure.model_fields),
    "compliance": tuple(Compliance.model_fields),
    "hinge": tuple(Hinge.model_fields),
    "hinge with axes": tuple(HingeAboutTwo.model_fields),
    "distance": tuple(Distance.model_fields),
    "geared actuator": (*version2.KEYS["geared actuator"], *actuator2_1.ADDED),
    **{form: (*version2.KEYS[form], *joint2_1.ADDED) for form in _JOINT_FORMS},
}
TAGS = version2.TAGS | {"plain closure", "hinge", "hinge with axes", "distance"}
EXCLUDED: Mapping[str, Mapping[str, str]] = {
    **version2.EXCLUDED,
    "plain closure": _of_other_types(),
    "hinge": _of_other_types("hinge"),
    "hinge with axes": {"axis": _ALONE, **_of_other_types("hinge")},
    "distance": _of_other_types("distance"),
}

#: Types of closure in each version, beside user-defined ones.
CLOSURE_TYPES: Mapping[str, tuple[str, ...]] = {"2.0": ("3d", "6d"), "2.1": ("3d", "6d", "hinge", "distance")}

#: Keys that version 2.1 adds, by the last field or tag on the way to their mapping.
ADDED_KEYS: Mapping[str, tuple[str, ...]] = {
    "": ("couplings",),
    "closures": (*_KEYS_OF_TYPES, "compliance"),
    "geared actuator": actuator2_1.ADDED,
    **dict.fromkeys(_JOINT_FORMS, joint2_1.ADDED),
}
