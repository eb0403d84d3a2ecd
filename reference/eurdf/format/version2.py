"""Version 2.0 of the YAML file, as pydantic models: its structure, before names are resolved."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeVar

from pydantic import ConfigDict, Field, GetJsonSchemaHandler, Tag, model_validator
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError
from typing_extensions import Self, TypeAliasType

from eurdf.format.field import (
    ByName,
    FrameName,
    JointName,
    LinkName,
    MayLack,
    MovingJointName,
    NonNegative,
    NonZero,
    Number,
    StrictMapping,
    UrdfJointName,
    either,
)
from eurdf.format.numbers import LARGEST

Name = Annotated[str, Field(min_length=1)]

# Named, so that the schema holds each of them once.
Vector = TypeAliasType("Vector", Annotated[list[Number], Field(min_length=3, max_length=3)])


def _number_form(value: Any) -> str | None:
    if isinstance(value, list):
        return "list of numbers"
    return "one number" if isinstance(value, int | float) and not isinstance(value, bool) else None


_NUMBERS = either(_number_form, "a number or a list of numbers")

_T = TypeVar("_T")
_OneOrList = Annotated[
    Annotated[_T, Tag("one number")] | Annotated[list[_T], Field(min_length=1, max_length=6), Tag("list of numbers")],
    _NUMBERS,
]

PerCoordinate = TypeAliasType("PerCoordinate", _OneOrList[Number])
NonNegativePerVelocity = TypeAliasType("NonNegativePerVelocity", _OneOrList[NonNegative])
# EU-FIL-006: limits have no bound on the side where they do not limit.
LowerLimit = TypeAliasType("LowerLimit", _OneOrList[Annotated[float, Field(le=LARGEST)]])
UpperLimit = TypeAliasType("UpperLimit", _OneOrList[Annotated[float, Field(ge=-LARGEST)]])
LimitPerVelocity = TypeAliasType("LimitPerVelocity", _OneOrList[Annotated[float, Field(ge=0)]])
Coordinates = TypeAliasType(
    "Coordinates",
    Annotated[
        Annotated[Number, Tag("one number")]
        | Annotated[list[Number], Field(min_length=1, max_length=7), Tag("list of numbers")],
        _NUMBERS,
    ],
)


class SaysSomething(StrictMapping):
    """A mapping that must have at least one of some keys."""

    one_of: ClassVar[tuple[str, ...]] = ()

    @model_validator(mode="after")
    def _has_one(self) -> Self:
        if self.model_fields_set.isdisjoint(self.one_of):
            keys = ", ".join(f"'{key}'" for key in self.one_of)
            raise PydanticCustomError("missing-key", "must have at least one of {keys}", {"keys": keys})
        return self

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler, /) -> JsonSchemaValue:
        """As generated, with at least one of the keys required."""
        written = super().__get_pydantic_json_schema__(schema, handler)
        handler.resolve_ref_schema(written)["anyOf"] = [{"required": [key]} for key in cls.one_of]
        return written


class Pose(StrictMapping):
    """A pose, in the frame of a link or of a joint."""

    xyz: Vector = Field(
        default=[0.0, 0.0, 0.0],
        title="Position",
        description="Origin x, y, z in its parent frame, m.",
        examples=[[0, 0, 0.31]],
    )
    rpy: Vector = Field(
        default=[0.0, 0.0, 0.0],
        title="Orientation",
        description="Roll, pitch, yaw about the fixed axes x, y, z of its parent frame, rad.",
        examples=[[0, 1.5707963267948966, 0]],
    )


class PoseOnLink(Pose):
    """A pose on a link."""

    model_config = ConfigDict(title="Pose on a link")

    link: LinkName = Field(title="Link", description="Link whose frame the pose is in.", examples=["rod"])


class PoseOnJoint(Pose):
    """A pose on a joint's frame."""

    model_config = ConfigDict(title="Pose on a joint")

    joint: JointName = Field(
        title="Joint",
        description="Joint whose frame, on the child's side, the pose is in.",
        examples=["motor_knee"],
    )


class FrameOnLink(PoseOnLink):
    """A frame added to a link."""

    model_config = ConfigDict(title="Frame on a link")

    name: Name = Field(title="Name", description="Name of the frame, unique on the robot.", examples=["toe_tip"])


class FrameOnJoint(PoseOnJoint):
    """A frame added to a joint's frame."""

    model_config = ConfigDict(title="Frame on a joint")

    name: Name = Field(title="Name", description="Name of the frame, unique on the robot.", examples=["toe_tip"])


def _pose_form(prefix: str) -> Callable[[Any], str | None]:
    def form(value: Any) -> str | None:
        if isinstance(value, dict):
            return prefix + (" on joint" if "joint" in value and "link" not in value else " on link")
        return "by name" if isinstance(value, str) else None

    return form


FrameReference = Annotated[
    Annotated[FrameName, Tag("by name")]
    | Annotated[PoseOnLink, Tag("pose on link")]
    | Annotated[PoseOnJoint, Tag("pose on joint")],
    either(_pose_form("pose"), "the name of a frame, or a pose {link: …, xyz: …, rpy: …}"),
]
Frame = Annotated[
    Annotated[FrameOnLink, Tag("frame on link")] | Annotated[FrameOnJoint, Tag("frame on joint")],
    either(_pose_form("frame"), "a mapping {name: …, link: …, xyz: …, rpy: …}"),
]

ClosureType = Annotated[
    Annotated[Literal["3d", "6d"], Tag("known type")] | Annotated[str, Field(pattern="^x-"), Tag("own type")],
    either(
        lambda value: ("own type" if value.startswith("x-") else "known type") if isinstance(value, str) else None,
        "'3d' or '6d', or begin with 'x-'",
    ),
]


class Closure(StrictMapping):
    """Two frames that are joined."""

    model_config = ConfigDict(title="Closure")

    name: Name = Field(title="Name", description="Name of the closure, unique in the file.", examples=["knee_rod"])
    type: ClosureType = Field(
        title="Type",
        description="3d: the origins of frames A and B coincide (3 rows, m). 6d: their orientations also agree (6"
        " rows, m and rad). A user-defined type begins with x-.",
        examples=["6d", "3d"],
    )
    frames: Annotated[list[FrameReference], Field(min_length=2, max_length=2)] = Field(
        title="Frames A and B",
        description="Two frames, each a name, or a pose on a link or joint.",
        examples=[["rod_tip", "knee_crank"], [{"link": "rod", "xyz": [0, 0, 0.31]}, "foot_ball"]],
    )


class Limits(SaysSomething):
    """Limits of a joint; each that is left out stays the URDF's. A number is for all coordinates, a list one each."""

    one_of: ClassVar[tuple[str, ...]] = ("lower", "upper", "velocity", "effort")
    model_config = ConfigDict(title="Limits")

    lower: MayLack[LowerLimit] = Field(
        default=None,
        title="Lower limit",
        description="Smallest position, rad or m; below -1e15 none.",
        examples=[-1.57, [-0.5, -0.3]],
    )
    upper: MayLack[UpperLimit] = Field(
        default=None,
        title="Upper limit",
        description="Largest position, rad or m; above 1e15 none.",
        examples=[1.57, [0.5, 0.3]],
    )
    velocity: MayLack[LimitPerVelocity] = Field(
        default=None,
        title="Velocity limit",
        description="Largest speed, rad/s or m/s, not negative; above 1e15 none.",
        examples=[12.0, [8, 8]],
    )
    effort: MayLack[LimitPerVelocity] = Field(
        default=None,
        title="Effort limit",
        description="Largest torque or force, N·m or N, not negative; above 1e15 none.",
        examples=[80.0, [40, 40]],
    )


class JointProperties(StrictMapping):
    """What a joint of any type may say in place of its URDF."""

    limits: MayLack[Limits] = Field(
        default=None,
        title="Joint limits",
        description="Position (rad, m), velocity (rad/s, m/s) and effort (N·m, N) limits in place of the URDF's.",
        examples=[{"velocity": 12.0, "effort": 80.0}],
    )
    damping: MayLack[NonNegativePerVelocity] = Field(
        default=None,
        title="Damping",
        description="Viscous damping, N·m·s/rad or N·s/m, not negative: a number, or a list, one for each velocity.",
        examples=[0.1, [0.1, 0.2]],
    )
    friction: MayLack[NonNegativePerVelocity] = Field(
        default=None,
        title="Friction",
        description="Dry friction, N·m or N, not negative: a number, or a list, one for each velocity.",
        examples=[0.5, [0.5, 0.5]],
    )
    armature: MayLack[NonNegativePerVelocity] = Field(
        default=None,
        title="Armature",
        description="Reflected inertia, kg·m² or kg, not negative: a number, or a list, one for each velocity.",
        examples=[0.02, [0.02, 0.02]],
    )


class Overridden(JointProperties, SaysSomething):
    """A joint that keeps its type, with some properties in place of the URDF's."""

    one_of: ClassVar[tuple[str, ...]] = ("limits", "damping", "friction", "armature")
    model_config = ConfigDict(title="Joint that keeps its type")


class Spherical(JointProperties):
    """A ball joint."""

    model_config = ConfigDict(title="Spherical joint")

    type: Literal["spherical"] = Field(
        title="Type", description="A ball joint: three rotations, a unit quaternion.", examples=["spherical"]
    )
    merges: MayLack[Annotated[list[UrdfJointName], Field(min_length=3, max_length=3)]] = Field(
        default=None,
        title="Merged joints",
        description="Three different rotary joints of the URDF, each the only child of the one before, whose axes meet"
        " in one point: together they are this joint.",
        examples=[["toe_rx", "toe_ry", "toe_rz"]],
    )


Letters = Literal["xy", "xz", "yx", "yz", "zx", "zy"]


class Universal(JointProperties):
    """A cardan joint."""

    model_config = ConfigDict(title="Universal joint")

    type: Literal["universal"] = Field(
        title="Type", description="A cardan joint: two rotations about crossing axes.", examples=["universal"]
    )
    axes: Annotated[
        Annotated[Letters, Tag("letters")]
        | Annotated[list[Vector], Field(min_length=2, max_length=2), Tag("two vectors")],
        either(
            lambda value: {str: "letters", list: "two vectors"}.get(type(value)),
            "two letters such as xy, or two vectors",
        ),
    ] = Field(
        title="Axes",
        description="First and second axis in the joint's frame: two different letters of x, y, z, or two vectors (of"
        " any length, no unit).",
        examples=["xy", [[1, 0, 0], [0, 0.7, 0.7]]],
    )


class Cylindrical(JointProperties):
    """A joint that slides along its axis and turns about it."""

    model_config = ConfigDict(title="Cylindrical joint")

    type: Literal["cylindrical"] = Field(
        title="Type", description="Slides along the URDF joint's axis and turns about it.", examples=["cylindrical"]
    )


class Helical(JointProperties):
    """A screw."""

    model_config = ConfigDict(title="Helical joint")

    type: Literal["helical"] = Field(
        title="Type", description="A screw: turns about the URDF joint's axis and moves along it.", examples=["helical"]
    )
    pitch: Number = Field(
        title="Pitch",
        description="Advance along the axis, m per revolution; positive for a right-handed screw.",
        examples=[0.005],
    )


class Fixed(JointProperties):
    """A joint locked at its zero."""

    model_config = ConfigDict(title="Fixed joint")

    type: Literal["fixed"] = Field(title="Type", description="Locked at its zero position.", examples=["fixed"])


#: The key that implies the type of a joint whose type is missing.
_TOLD_BY = {"axes": "universal", "pitch": "helical", "merges": "spherical"}

_JOINT_MODELS: dict[str, type[JointProperties]] = {
    "spherical": Spherical,
    "universal": Universal,
    "cylindrical": Cylindrical,
    "helical": Helical,
    "fixed": Fixed,
}


def joint_form(value: Any) -> str | None:
    """The tag of the form that the entry of a joint has, or None."""
    if isinstance(value, str):
        return "type alone"
    if not isinstance(value, dict):
        return None
    if "type" in value:
        kind = value["type"]
    else:
        kind = next((kind for key, kind in _TOLD_BY.items() if key in value), None)
        if kind is None:
            return "kept type"
    return f"{kind} joint" if isinstance(kind, str) and kind in _JOINT_MODELS else None


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
        either(joint_form, "a joint type, or a mapping {type: …, limits: …}"),
    ],
)


class Geared(StrictMapping):
    """An actuated joint and its gear."""

    model_config = ConfigDict(title="Actuator with a gear")

    joint: MovingJointName = Field(title="Joint", description="The actuated joint.", examples=["motor_knee"])
    gear_ratio: MayLack[NonZero] = Field(
        default=None,
        title="Gear ratio",
        description="Motor revolutions per revolution of the joint (per metre for a sliding joint), not 0; negative"
        " where they turn in opposite senses.",
        examples=[50],
    )
    rotor_inertia: MayLack[NonNegative] = Field(
        default=None,
        title="Rotor inertia",
        description="Inertia of the motor's rotor about its own axis, kg·m², not negative.",
        examples=[1.2e-4],
    )


def actuator_form(value: Any) -> str | None:
    """The tag of the form that an actuator has, or None."""
    if isinstance(value, dict):
        return "geared actuator"
    return "by name" if isinstance(value, str) else None


Actuator = Annotated[
    Annotated[MovingJointName, Tag("by name")] | Annotated[Geared, Tag("geared actuator")],
    either(actuator_form, "the name of a joint, or a mapping {joint: …, gear_ratio: …}"),
]


class Version2(StrictMapping):
    """A robot's loop closures, actuators, joints, frames and configurations beside its URDF."""

    model_config = ConfigDict(title="Extended URDF, version 2.0")

    extended_urdf: Literal["2.0"] = Field(
        title="Version", description="Version of the format, in quotes.", examples=["2.0"]
    )
    urdf: Name = Field(
        default="robot.urdf",
        title="URDF file",
        description="Path of the URDF, relative to this file.",
        examples=["robot.urdf"],
    )
    root: Literal["fixed", "floating"] = Field(
        default="fixed",
        title="Root",
        description="Whether the root link is fixed to the world or floats in it.",
        examples=["floating"],
    )
    closures: list[Closure] = Field(
        default=[],
        title="Loop closures",
        description="Pairs of frames, each joined by a closure.",
        examples=[[{"name": "knee_rod", "type": "6d", "frames": ["rod_tip", "knee_crank"]}]],
    )
    joints: ByName[Joint] = Field(
        default={},
        title="Joints",
        description="By name, joints of a type that URDF lacks, and properties in place of the URDF's. The name is a"
        " joint of the URDF, or with 'merges' that of the joint made.",
        examples=[{"hip_ball": "spherical", "ball_screw": {"type": "helical", "pitch": 0.005}}],
    )
    actuators: list[Actuator] = Field(
        default=[],
        title="Actuators",
        description="The joints that have a motor: names, or mappings with the gear.",
        examples=[["motor_hip_x", {"joint": "motor_knee", "gear_ratio": 50, "rotor_inertia": 1.2e-4}]],
    )
    frames: list[Frame] = Field(
        default=[],
        title="Frames",
        description="Frames added to links or joints.",
        examples=[[{"name": "toe_tip", "link": "foot", "xyz": [0.12, 0, -0.03]}]],
    )
    configurations: ByName[ByName[Coordinates]] = Field(
        default={},
        title="Configurations",
        description="By name, the coordinates of joints: a number or a list. Angle in rad, length in m; spherical: a"
        " unit quaternion x y z w; universal: two angles; cylindrical: length, angle; planar: x, y, angle; floating: x"
        " y z and a quaternion. Other joints are neutral, which must be within their limits. All closures are closed at"
        " 'assembled'.",
        examples=[{"assembled": {"motor_knee": 0.4, "hip_ball": [0, 0, 0, 1]}}],
    )
    metadata: dict[str, Any] = Field(
        default={},
        title="Metadata",
        description="Information about the file, such as license and source.",
        examples=[{"license": "BSD-3-Clause", "source": "CAD export of 2025-03-01"}],
    )


#: The keys of a mapping, by the last field or tag on the way to it; empty for the file itself.
KEYS: Mapping[str, tuple[str, ...]] = {
    "": tuple(Version2.model_fields),
    "closures": tuple(Closure.model_fields),
    "pose on link": tuple(PoseOnLink.model_fields),
    "pose on joint": tuple(PoseOnJoint.model_fields),
    "frame on link": tuple(FrameOnLink.model_fields),
    "frame on joint": tuple(FrameOnJoint.model_fields),
    "geared actuator": tuple(Geared.model_fields),
    "limits": tuple(Limits.model_fields),
    "kept type": (*Overridden.model_fields, "type", *_TOLD_BY),
    **{f"{kind} joint": tuple(model.model_fields) for kind, model in _JOINT_MODELS.items()},
}

#: The tags that distinguish forms of a value; none is a key of the format.
TAGS = frozenset(
    {"by name", "one number", "list of numbers", "known type", "own type", "letters", "two vectors", "type alone"}
    | (KEYS.keys() - {"", "closures", "limits"})
)

#: Keys that do not go with the form that a mapping has, by its tag, and why.
EXCLUDED: Mapping[str, Mapping[str, str]] = {
    "pose on link": {"joint": "use either 'link' or 'joint', not both"},
    "frame on link": {"joint": "use either 'link' or 'joint', not both"},
    **{
        f"{kind} joint": {
            key: f"'{key}' belongs to type '{owner}', not to type '{kind}'"
            for key, owner in _TOLD_BY.items()
            if owner != kind
        }
        for kind in _JOINT_MODELS
    },
}

#: Types of a joint, where it is a mapping.
JOINT_TYPES = tuple(_JOINT_MODELS)

#: Keys of version 1, and where version 2.0 says the same.
FROM_VERSION1: Mapping[str, str] = {
    "closed_loop": "closures",
    "type": "closures",
    "name_mot": "actuators",
    "joint_name": "joints",
    "joint_type": "joints",
}
