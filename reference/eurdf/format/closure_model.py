"""The models of frames, closures and couplings: each key once, with the version that adds it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from eurdf.format.conventions import VERSION2_1, is_own_key
from eurdf.format.mappings import Alone, Entry, OneOf, Record, entry, key, key_like, required
from eurdf.format.value_types import (
    FRAME_NAME,
    JOINT_NAME,
    LINK_NAME,
    NAME,
    NON_NEGATIVE,
    NON_ZERO,
    NUMBER,
    VECTOR,
    ByName,
    Check,
    Choice,
    ListOf,
    Number,
    Schema,
    Schemas,
)
from eurdf.mechanism.pose import Vector3
from eurdf.reading.yaml_node import Pointer

ORIGIN: Vector3 = (0.0, 0.0, 0.0)

#: The axes of a frame, by their letters.
AXES: Mapping[str, Vector3] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@entry
class NamedFrame(Entry):
    """A frame by its name."""

    kind: ClassVar[Literal["frame", "link", "joint"]] = "frame"
    xyz: ClassVar[Vector3] = ORIGIN
    rpy: ClassVar[Vector3] = ORIGIN
    target: str = required(FRAME_NAME, "Name", "Name of the frame, or of the link or joint whose frame it is.")


@entry
class Pose(Entry):
    """A pose, in the frame of a link or of a joint."""

    kind: ClassVar[Literal["frame", "link", "joint"]]
    xyz: Vector3 = key(VECTOR, "Position", "Origin x, y, z in its parent frame, m.", [0, 0, 0.31], default=ORIGIN)
    rpy: Vector3 = key(
        VECTOR,
        "Orientation",
        "Roll, pitch, yaw about the fixed axes x, y, z of its parent frame, rad.",
        [0, 1.5707963267948966, 0],
        default=ORIGIN,
    )

    @property
    def target(self) -> str:
        """Name of the link, or of the joint, on whose child's side the pose is."""
        name: str = getattr(self, self.kind)
        return name


@entry
class PoseOnLink(Pose):
    """A pose on a link."""

    title = "Pose on a link"
    kind = "link"
    link: str = required(LINK_NAME, "Link", "Link whose frame the pose is in.", "rod")


@entry
class PoseOnJoint(Pose):
    """A pose on a joint's frame."""

    title = "Pose on a joint"
    kind = "joint"
    joint: str = required(JOINT_NAME, "Joint", "Joint whose frame, on the child's side, the pose is in.", "motor_knee")


_FRAME_NAME = "Name of the frame, unique on the robot."


@entry
class FrameOnLink(PoseOnLink):
    """A frame added to a link."""

    title = "Frame on a link"
    name: str = required(NAME, "Name", _FRAME_NAME, "toe_tip")


@entry
class FrameOnJoint(PoseOnJoint):
    """A frame added to a joint's frame."""

    title = "Frame on a joint"
    name: str = required(NAME, "Name", _FRAME_NAME, "toe_tip")


FrameReference = NamedFrame | Pose
Frame = FrameOnLink | FrameOnJoint

_LINK_OR_JOINT = "use either 'link' or 'joint', not both"
FRAME_REFERENCE = OneOf(
    "the name of a frame, or a pose {link: …, xyz: …, rpy: …}",
    Alone(FRAME_NAME, "target", Record(NamedFrame)),
    Record(PoseOnLink),
    Record(PoseOnJoint),
    apart=_LINK_OR_JOINT,
)
FRAME = OneOf(
    "a mapping {name: …, link: …, xyz: …, rpy: …}", Record(FrameOnLink), Record(FrameOnJoint), apart=_LINK_OR_JOINT
)

# -- closures and couplings -------------------------------------------------------------------------------------------


@entry
class Compliance(Entry):
    """How much a closure gives way under load: a hint for simulators with soft constraints."""

    title = "Compliance"
    says_something = True
    linear: float | None = key(NON_NEGATIVE, "Linear compliance", "m/N, not negative; 0 is rigid.", 1e-6)
    angular: float | None = key(
        NON_NEGATIVE,
        "Angular compliance",
        "rad/(N·m), not negative; 0 is rigid. Only for closures that hold an orientation: 6d, hinge.",
        1e-4,
    )


class ClosureType(Choice):
    """A type of closure without keys of its own; one that begins with ``x-`` is user-defined (EU-CLO-012)."""

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        known = CLOSURE.values_of_type(file.version)
        if type(value) is not str:
            allowed = " or ".join(f"'{each}'" for each in self.values)
            file.report(at, "wrong-type", f"must be {allowed}, or begin with 'x-'", value)
        elif value not in known and not is_own_key(value):
            later = value in CLOSURE.values_of_type(VERSION2_1)
            file.report(at, "later-value" if later else "choice", value=value, about=known)

    def schema(self, schemas: Schemas) -> Schema:
        return {"oneOf": [super().schema(schemas), {"pattern": "^x-", "type": "string"}]}


@entry
class _Closure(Entry):
    """Two frames, related by a closure of some type."""

    name: str = required(NAME, "Name", "Name of the closure, unique in the file.", "knee_rod")
    type: str
    frames: tuple[FrameReference, FrameReference] = required(
        ListOf(FRAME_REFERENCE, 2, 2),
        "Frames A and B",
        "Two frames, each a name, or a pose on a link or joint.",
        ["rod_tip", "knee_crank"],
        [{"link": "rod", "xyz": [0, 0, 0.31]}, "foot_ball"],
    )
    compliance: Compliance | None = key(
        Record(Compliance),
        "Compliance",
        "How much the closure gives way under load; it does not change the residual. Rigid if left out.",
        {"linear": 1e-6, "angular": 1e-4},
        since=VERSION2_1,
    )


@entry
class Closure(_Closure):
    """Two frames that are joined."""

    title = "Closure"
    type: str = required(
        ClosureType("3d", "6d"),
        "Type",
        "3d: the origins of frames A and B coincide (3 rows, m). 6d: their orientations also agree (6 rows, m and"
        " rad). A user-defined type begins with x-.",
        "6d",
        "3d",
    )


@entry
class _TypedClosure(_Closure):
    """Two frames, related by a closure of a type that has keys of its own."""

    since = VERSION2_1
    name: str = key_like(_Closure, "name", "knee_pin")
    frames: tuple[FrameReference, FrameReference] = key_like(_Closure, "frames", ["coupler_tip", "rocker_tip"])


@entry
class _Hinge(_TypedClosure):
    """Two frames that turn about one axis."""

    type: str = required(
        Choice("hinge"),
        "Type",
        "hinge: the origin of frame B is held on that of A, and an axis of B along an axis of A (5 rows, m and rad).",
        "hinge",
    )


@entry
class Hinge(_Hinge):
    """A hinge about one axis, which both frames have."""

    title = "Hinge closure"
    axis: Vector3 = key(
        VECTOR,
        "Axis",
        "The axis in frame A and in frame B: a vector of any length but zero, no unit.",
        [0, 1, 0],
        default=AXES["z"],
    )

    @property
    def axes(self) -> tuple[Vector3, Vector3]:
        """The axis in frame A, and that in frame B."""
        return self.axis, self.axis


@entry
class HingeAboutTwo(_Hinge):
    """A hinge that holds an axis of frame B along an axis of frame A."""

    title = "Hinge closure with two axes"
    axes: tuple[Vector3, Vector3] = required(
        ListOf(VECTOR, 2, 2),
        "Axes",
        "The axis in frame A, and the axis in frame B: vectors of any length but zero, no unit.",
        [[0, 0, 1], [0, 1, 0]],
    )


@entry
class Distance(_TypedClosure):
    """Two frames whose origins are at a fixed distance."""

    title = "Distance closure"
    type: str = required(
        Choice("distance"),
        "Type",
        "distance: the origins of frames A and B are at a fixed distance, as those of the ball joints of a rod (1 row,"
        " m).",
        "distance",
    )
    length: float = required(
        Number(least=1e-4), "Length", "Distance between the origins of A and B, m, at least 0.0001.", 0.155
    )


AnyClosure = Closure | Hinge | HingeAboutTwo | Distance

CLOSURE = OneOf(
    "a mapping {name: …, type: …, frames: …}",
    *map(Record, (Closure, Hinge, HingeAboutTwo, Distance)),
    apart="'{key}' goes with type '{owner}'",
)


@entry
class Coupling(Entry):
    """A linear relation of joint coordinates."""

    title = "Coupling"
    name: str = required(NAME, "Name", "Name of the coupling, unique among closures and couplings.", "knee_gear")
    joints: Mapping[str, float] = required(
        ByName(NON_ZERO, 2),
        "Joints",
        "By joint, its coefficient, not 0: the coordinates (rad, m) times the coefficients add up to 'offset'. Two or"
        " more revolute, continuous, prismatic or helical joints.",
        {"motor_1": 0.5, "motor_2": 0.5, "knee": -1},
    )
    offset: float = key(
        NUMBER,
        "Offset",
        "What the coordinates times the coefficients add up to, in the unit of these products.",
        0.2,
        default=0.0,
    )
