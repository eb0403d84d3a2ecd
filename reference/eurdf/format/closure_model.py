"""The models of frames, closures and couplings: each key once, with the version that adds it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, make_dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from eurdf.closures import REGISTRY
from eurdf.format.conventions import VERSION2_1, Version, is_own_key
from eurdf.format.mappings import Alone, Entry, OneOf, Record, entry, key, key_like, required
from eurdf.format.value_types import (
    FRAME_NAME,
    JOINT_NAME,
    LINK_NAME,
    MOVING_JOINT_NAME,
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
    ValueType,
)
from eurdf.mechanism.constraint import ClosureKey, Form
from eurdf.mechanism.pose import ORIGIN, Vector3
from eurdf.reading.yaml_node import Pointer

if TYPE_CHECKING:
    from eurdf.closures.kind import ClosureKind

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
class PoseEntry(Entry):
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
class PoseOnLink(PoseEntry):
    """A pose on a link."""

    title = "Pose on a link"
    kind = "link"
    link: str = required(LINK_NAME, "Link", "Link whose frame the pose is in.", "rod")


@entry
class PoseOnJoint(PoseEntry):
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


FrameReference = NamedFrame | PoseEntry
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
class ComplianceEntry(Entry):
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


@entry
class ClosureEntry(Entry):
    """Two frames, related by a closure of some type.

    What a type has besides is in subclasses, which are made of its kind.
    """

    name: str = required(NAME, "Name", "Name of the closure, unique in the file.", "knee_rod")
    type: str = required(NAME, "Type", "")
    frames: tuple[FrameReference, FrameReference] = required(
        ListOf(FRAME_REFERENCE, 2, 2),
        "Frames A and B",
        "Two frames, each a name, or a pose on a link or joint.",
        ["rod_tip", "knee_crank"],
        [{"link": "rod", "xyz": [0, 0, 0.31]}, "foot_ball"],
    )
    compliance: ComplianceEntry | None = key(
        Record(ComplianceEntry),
        "Compliance",
        "How much the closure gives way under load; it does not change the residual. Rigid if left out.",
        {"linear": 1e-6, "angular": 1e-4},
        since=VERSION2_1,
    )

    @property
    def stated(self) -> dict[str, Any]:
        """What its type has besides, by key."""
        common = {each.name for each in fields(ClosureEntry)}
        return {each.name: getattr(self, each.name) for each in fields(self) if each.name not in common}


class _PlainType(Choice):
    """A type of version 1; one that begins with ``x-`` is user-defined (EU-CLO-012)."""

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        known = CLOSURE.forms.values_of_type(file.version)
        if type(value) is not str:
            allowed = " or ".join(f"'{each}'" for each in self.values)
            file.report(at, "wrong-type", f"must be {allowed}, or begin with 'x-'", value)
        elif value not in known and not is_own_key(value):
            later = value in CLOSURE.forms.values_of_type(VERSION2_1)
            file.report(at, "later-value" if later else "choice", value=value, about=known)

    def schema(self, schemas: Schemas) -> Schema:
        return {"oneOf": [super().schema(schemas), {"pattern": "^x-", "type": "string"}]}


def _meaning(kind: type[ClosureKind]) -> str:
    """What the schema says of a type."""
    rows = f"{len(kind.units)} row{'s' if len(kind.units) > 1 else ''}"
    return f"{kind.type}: {kind.text} ({rows}, {' and '.join(dict.fromkeys(kind.units))})."


def _key(stated: ClosureKey) -> Any:
    """The field of a model that is what a kind states in a key."""
    values: ValueType = VECTOR if stated.type == "Vector3" else ListOf(VECTOR, 2, 2)
    if stated.type == "float":
        values = NUMBER if stated.least is None else Number(least=stated.least)
    if stated.default is None:
        return required(values, stated.title, stated.text, stated.example)
    return key(values, stated.title, stated.text, stated.example, default=stated.default)


def _record(form: Form, since: Version, own: dict[str, Any]) -> Record:
    """A mapping that states a closure, by what its kind says; ``own`` fields replace those of `ClosureEntry`."""
    keys = own | {name: _key(each) for name, each in form.keys.items()}
    typed = [(name, Any, each) for name, each in keys.items()]
    about = {"title": form.title, "since": since, "__doc__": form.text}
    return Record(
        make_dataclass(form.name, typed, bases=(ClosureEntry,), namespace=about, kw_only=True, eq=False, repr=False)
    )


@cache
def _forms(types: tuple[str, ...]) -> OneOf:
    """The mappings of the types of closure: one for all those of version 1."""
    kinds = [REGISTRY[each] for each in types]
    plain = [kind for kind in kinds if kind.since == "1"]
    text = " ".join((*map(_meaning, plain), "A user-defined type begins with x-."))
    names = [kind.type for kind in plain]
    typed = {"type": required(_PlainType(*names), "Type", text, *reversed(names))}
    records = [_record(Form("Closure", "Closure", plain[0].summary, {}), "1", typed)]
    for kind in kinds:
        own = {
            "name": key_like(ClosureEntry, "name", "knee_pin"),
            "type": required(Choice(kind.type), "Type", _meaning(kind), kind.type),
            "frames": key_like(ClosureEntry, "frames", ["coupler_tip", "rocker_tip"]),
        }
        records += [_record(form, kind.since, own) for form in kind.forms() if kind not in plain]
    return OneOf("a mapping {name: …, type: …, frames: …}", *records, apart="'{key}' goes with type '{owner}'")


class AnyClosure(ValueType):
    """A closure of any type: its forms are made of the kinds when a file first has a closure."""

    types = (dict,)

    @property
    def forms(self) -> OneOf:
        """A mapping for the types of version 1, and those of each other type."""
        return _forms(tuple(REGISTRY))

    def entry(self, type_: str, stated: Mapping[str, Any], **common: Any) -> ClosureEntry:
        """A closure of a type, with what that has besides, by key."""
        records = (record for record in self.forms.records if type_ in record.values_of_type())
        model = next(record.model for record in records if stated.keys() <= record.all_keys.keys())
        closure: ClosureEntry = model(type=type_, **stated, **common)
        return closure

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        self.forms.check(value, at, file)

    def read(self, value: Any, at: Pointer) -> ClosureEntry:
        closure: ClosureEntry = self.forms.read(value, at)
        return closure

    def write(self, value: ClosureEntry) -> Any:
        return self.forms.write(value)

    def schema(self, schemas: Schemas) -> Schema:
        return self.forms.schema(schemas)


CLOSURE = AnyClosure()


@entry
class CouplingEntry(Entry):
    """A linear relation of joint coordinates."""

    title = "Coupling"
    name: str = required(NAME, "Name", "Name of the coupling, unique among closures and couplings.", "knee_gear")
    joints: Mapping[str, float] = required(
        ByName(NON_ZERO, 2, keys=MOVING_JOINT_NAME),
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
