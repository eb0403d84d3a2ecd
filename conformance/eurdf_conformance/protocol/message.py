"""Each message of the protocol as a frozen value, which has a JSON Schema of its own (`schema`).

A conversation is `start`, then any number of `load` and `evaluate`, then `stop`; each request is one line of JSON, and
each is answered by one line that repeats its id. The answer's ``outcome`` says what kind it is.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import BaseModel, ConfigDict, Field, SerializerFunctionWrapHandler, TypeAdapter, model_serializer

from eurdf_conformance.feature import Feature
from eurdf_conformance.level import Level, Version

PROTOCOL: Literal["1.0"] = "1.0"

#: Key of the line of `serve` if there is no answer: ``{"id": 1, "no_answer": "…"}``. It fits no schema, so it is
#: malformed; the runner reports its text.
NO_ANSWER = "no_answer"

Number = Annotated[float, Field(allow_inf_nan=False)]
Numbers = list[Number]
Row3 = Annotated[Numbers, Field(min_length=3, max_length=3)]


class Plain(BaseModel):
    """A part of a message with the same members in all versions of the format."""

    # Unknown members of an answer are an error: a misspelt one would be a part that nobody reads.
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class Value(Plain):
    """A part of a message."""

    #: Members that a message does not have where they are None: those that version 2.1 adds.
    optional: ClassVar[frozenset[str]] = frozenset()

    @model_serializer(mode="wrap")
    def _without_optional(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        written: dict[str, Any] = handler(self)
        return {name: value for name, value in written.items() if value is not None or name not in self.optional}


class Request(Value):
    """A request of the runner."""

    #: Kinds of answer beside `unsupported`, `skipped` and `errored`.
    outcomes: ClassVar[tuple[str, ...]]

    id: int = Field(description="Repeated by the answer.")


class Start(Request):
    """The first request."""

    outcomes = ("started",)

    command: Literal["start"] = "start"
    protocol: str = Field(default=PROTOCOL, description="Version of the protocol.")


class Load(Request):
    """Read a robot. It replaces the one read before, whatever the answer is."""

    outcomes = ("accepted", "rejected")

    command: Literal["load"] = "load"
    description: str = Field(description="Absolute path of the YAML file.")
    urdf: str = Field(description="Absolute path of the URDF that the description names, whether it exists or not.")


Quantity = Literal["poses", "residuals", "jacobian", "mass_matrix", "mass", "center_of_mass"]


class Evaluate(Request):
    """Compute poses and other quantities of the robot of the last `load`, which was accepted."""

    outcomes = ("evaluated",)

    command: Literal["evaluate"] = "evaluate"
    quantities: list[Quantity]
    frames: list[str] = Field(description="Names of the frames whose poses are requested.")
    configurations: list[dict[str, Numbers]] = Field(
        description="For each joint its coordinates as in files; those of a floating root under root_joint."
    )


class Stop(Request):
    """The last request; the process then ends by itself."""

    outcomes = ("stopped",)

    command: Literal["stop"] = "stop"


class Answer(Value):
    """An answer of a parser."""

    id: int = Field(description="The id of the request.")


class ParserInfo(Plain):
    """The parser that answers."""

    name: Annotated[str, Field(min_length=1)]
    version: str
    language: str


class Started(Answer):
    """The answer to `start`."""

    outcome: Literal["started"] = "started"
    protocol: Literal["1.0"]
    parser: ParserInfo
    claims: dict[Version, list[Level]] = Field(description="The claimed levels, for each version of the format.")
    lacks: list[Feature] = Field(default=[], description="Features that the parser lacks; left out if none.")

    @model_serializer(mode="wrap")
    def _without_empty(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {name: value for name, value in handler(self).items() if value or name != "lacks"}


class Issue(Value):
    """Something wrong with the files."""

    code: str | None = Field(default=None, description="Code of the diagnostic.")
    severity: Literal["error", "warning"] = "error"
    file: str | None = Field(default=None, description="Name of one of the two files, without its folder.")
    line: Annotated[int, Field(ge=1)] | None = None
    column: Annotated[int, Field(ge=1)] | None = Field(default=None, description="In characters.")
    message: str


class CanonicalMimic(Value):
    """q = multiplier · q_joint + offset, rad or m."""

    joint: str
    multiplier: Number
    offset: Number


class CanonicalJoint(Value):
    """A joint that moves."""

    optional = frozenset({"stiffness", "rest"})

    name: str
    type: Literal[
        "revolute",
        "continuous",
        "prismatic",
        "planar",
        "floating",
        "spherical",
        "universal",
        "cylindrical",
        "helical",
    ]
    parent: str = Field(description="A link of the parent body.")
    child: str = Field(description="A link of the child body.")
    lower: list[Number | None] = Field(description="One value per coordinate, rad or m; null: no limit.")
    upper: list[Number | None]
    velocity: list[Number | None] = Field(description="One value per velocity, rad/s or m/s; null: no limit.")
    effort: list[Number | None]
    damping: Numbers
    friction: Numbers
    armature: Numbers
    stiffness: Numbers | None = Field(default=None, description="One value per coordinate, N·m/rad or N/m.")
    rest: Numbers | None = Field(default=None, description="Rest positions of the springs, rad or m.")
    mimic: CanonicalMimic | None = None


class CanonicalCompliance(Value):
    """How much a closure gives way under load."""

    linear: Number = Field(default=0.0, description="m/N")
    angular: Number = Field(default=0.0, description="rad/(N·m)")


class CanonicalClosure(Value):
    """A closure between two frames, A and B."""

    optional = frozenset({"axes", "length", "compliance"})

    name: str
    type: Literal["3d", "6d", "hinge", "distance"]
    a: str = Field(description="A link of the body that carries frame A.")
    b: str = Field(description="A link of the body that carries frame B.")
    axes: Annotated[list[Row3], Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="Unit vectors of the axis of a hinge, in A and in B."
    )
    length: Number | None = Field(default=None, description="Length of a distance, m.")
    compliance: CanonicalCompliance | None = Field(default=None, description="Rigid if left out.")


class CanonicalCoupling(Value):
    """A linear relation of joint coordinates: Σ coefficient · coordinate = offset."""

    name: str
    joints: dict[str, Number] = Field(description="By joint, its coefficient.")
    offset: Number


class CanonicalActuator(Value):
    """A joint with a motor; gear ratio and rotor inertia have one value per velocity."""

    optional = frozenset({"name", "control"})

    joint: str
    gear_ratio: Numbers | None = None
    rotor_inertia: Numbers | None = None
    name: str | None = Field(default=None, description="Its name; that of the joint if left out.")
    control: Annotated[Numbers, Field(min_length=2, max_length=2)] | None = Field(
        default=None, description="Smallest and largest torque or force at the joint, N·m or N."
    )


class Pose(Value):
    """Pose of a frame in the world, or of a shape in the frame of its link."""

    rotation: Annotated[list[Row3], Field(min_length=3, max_length=3)]
    translation: Row3 = Field(description="m")


class CanonicalShape(Value):
    """A shape of a link."""

    optional = frozenset({"file"})

    link: str
    use: Literal["visual", "collision"]
    type: Literal["box", "cylinder", "sphere", "capsule", "mesh"]
    size: Numbers = Field(
        description="Box: lengths x, y, z; cylinder and capsule: radius, length; sphere: radius, all in m; "
        "mesh: scale x, y, z."
    )
    file: str | None = Field(default=None, description="File name of a mesh, as in the URDF.")
    pose: Pose = Field(description="Pose in the frame of the link.")


class CanonicalRobot(Value):
    """The canonical description of a robot, as a parser has read it: chapter The canonical description."""

    name: str
    version: Version
    root: Literal["fixed", "floating"]
    links: list[str]
    frames: list[str]
    joints: list[CanonicalJoint]
    closures: list[CanonicalClosure]
    actuators: list[CanonicalActuator]
    configurations: dict[str, dict[str, Numbers]]
    couplings: list[CanonicalCoupling] = Field(default=[], description="Left out where there are none.")
    shapes: list[CanonicalShape] = Field(
        default=[], description="Those of one link and use in the order of the URDF. Left out where there are none."
    )
    own: dict[str, Any] = Field(description="User data, by the JSON pointer to the key.")

    @model_serializer(mode="wrap")
    def _of_its_version(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Without `couplings` and `shapes` where there are none: version 2.0 does not have couplings."""
        return {name: value for name, value in handler(self).items() if value or name not in ("couplings", "shapes")}


class Accepted(Answer):
    """An answer to `load`: the parser has read the robot."""

    outcome: Literal["accepted"] = "accepted"
    robot: CanonicalRobot | None = Field(description="null if the parser does not claim the level structure.")
    issues: list[Issue] = []


class Rejected(Answer):
    """An answer to `load`: the files have an error."""

    outcome: Literal["rejected"] = "rejected"
    issues: list[Issue]


class Jacobian(Value):
    """The constraint Jacobian K."""

    columns: list[tuple[str, int]] = Field(description="For each column its joint and index of the velocity, from 0.")
    rows: dict[str, list[Numbers]] = Field(description="The rows of each closure and coupling.")


class MassMatrix(Value):
    """The joint-space inertia M."""

    columns: list[tuple[str, int]]
    matrix: list[Numbers]


class Values(Value):
    """The requested quantities at one configuration."""

    poses: dict[str, Pose] | None = None
    residuals: dict[str, Numbers] | None = None
    jacobian: Jacobian | None = None
    mass_matrix: MassMatrix | None = None
    mass: Number | None = None
    center_of_mass: Row3 | None = None


class Evaluated(Answer):
    """The answer to `evaluate`: one value per configuration, in the order of the request."""

    outcome: Literal["evaluated"] = "evaluated"
    values: list[Values]


class Stopped(Answer):
    """The answer to `stop`."""

    outcome: Literal["stopped"] = "stopped"


class Unsupported(Answer):
    """An answer to any request except `stop`: the parser lacks a feature."""

    outcome: Literal["unsupported"] = "unsupported"
    feature: str = Field(description="A feature that the parser names in `lacks`; any other is not excused.")
    reason: str = ""


class Skipped(Answer):
    """An answer to any request except `stop`: the parser chooses not to answer, and gives a reason."""

    outcome: Literal["skipped"] = "skipped"
    reason: str


class Errored(Answer):
    """An answer to any request except `stop`: the parser reports that it failed."""

    outcome: Literal["errored"] = "errored"
    message: str


AnyRequest = Start | Load | Evaluate | Stop
AnyAnswer = Started | Accepted | Rejected | Evaluated | Stopped | Unsupported | Skipped | Errored

REQUEST: TypeAdapter[AnyRequest] = TypeAdapter(Annotated[AnyRequest, Field(discriminator="command")])
ANSWER: TypeAdapter[AnyAnswer] = TypeAdapter(Annotated[AnyAnswer, Field(discriminator="outcome")])
