"""The models of joints and actuators: each key once, with the version that adds it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from eurdf.format.closure_model import AXES
from eurdf.format.conventions import VERSION2_1
from eurdf.format.mappings import Alone, Entry, OneOf, Record, entry, in_order, key, required
from eurdf.format.value_types import (
    MOVING_JOINT_NAME,
    NAME,
    NON_NEGATIVE,
    NON_ZERO,
    NUMBER,
    URDF_JOINT_NAME,
    VECTOR,
    Check,
    Choice,
    ListOf,
    Never,
    Number,
)
from eurdf.mechanism.pose import Vector3
from eurdf.reading.yaml_node import Pointer

#: One number for all coordinates or velocities of a joint, or one each.
Numbers = float | tuple[float, ...]


class OneOrList(OneOf):
    """One number for all coordinates of a joint, or a list, one each."""

    def __init__(self, name: str, number: Number, most: int = 6) -> None:
        super().__init__("a number or a list of numbers", number, ListOf(number, 1, most), name=name)

    def write(self, value: Numbers) -> Any:
        """One number if all are equal."""
        form = self.all_forms[isinstance(value, tuple) and len(set(value)) > 1]
        return form.write(value[0] if isinstance(value, tuple) and len(set(value)) == 1 else value)


class TwoAxes(OneOf):
    """Two axes: two of the letters x, y and z, or two vectors; read as vectors."""

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        """Letters in a list are one error."""
        if type(value) is list and value and all(type(item) is str and item.lower() in AXES for item in value):
            file.report(at, "wrong-type", f"must be {self.expected}", value)
        else:
            super().check(value, at, file)

    def read(self, value: Any, at: Pointer) -> tuple[Vector3, ...]:
        return tuple(AXES[letter] for letter in value) if isinstance(value, str) else super().read(value, at)

    def write(self, value: tuple[Vector3, ...]) -> Any:
        letters = "".join(letter for axis in value for letter, unit in AXES.items() if axis == unit)
        return letters if len(letters) == len(value) else self.all_forms[1].write(value)


LIMIT_PER_VELOCITY = OneOrList("LimitPerVelocity", Number(least=0, most=None))
NON_NEGATIVE_PER_VELOCITY = OneOrList("NonNegativePerVelocity", NON_NEGATIVE)


@entry
class LimitsEntry(Entry):
    """Limits of a joint; each that is left out stays the URDF's. A number is for all coordinates, a list one each."""

    title = "Limits"
    says_something = True
    lower: Numbers | None = key(
        OneOrList("LowerLimit", Number(least=None)),
        "Lower limit",
        "Smallest position, rad or m; below -1e15 none.",
        -1.57,
        [-0.5, -0.3],
    )
    upper: Numbers | None = key(
        OneOrList("UpperLimit", Number(most=None)),
        "Upper limit",
        "Largest position, rad or m; above 1e15 none.",
        1.57,
        [0.5, 0.3],
    )
    velocity: Numbers | None = key(
        LIMIT_PER_VELOCITY,
        "Velocity limit",
        "Largest speed, rad/s or m/s, not negative; above 1e15 none.",
        12.0,
        [8, 8],
    )
    effort: Numbers | None = key(
        LIMIT_PER_VELOCITY,
        "Effort limit",
        "Largest torque or force, N·m or N, not negative; above 1e15 none.",
        80.0,
        [40, 40],
    )


_LIMITS = Record(LimitsEntry)


@entry
class JointEntry(Entry):
    """What a description says of a joint of any type.

    Attributes:
        name: JointEntry of the URDF; of merged joints, the one that results.
        type: New type, or None to keep the URDF's own.
        merges: Names of three joints of the URDF that become this one; empty where none do.
        axes: Two axes of a universal joint in the joint's frame, as written; empty where none are.
        pitch: m per revolution, of a helical joint.
        split: A universal joint of version 1: two revolutes ``name_A`` and ``name_B``, for letters such as ``XY``.
    """

    needs: ClassVar[Mapping[str, str]] = {"rest": "stiffness"}
    name: str = ""
    stiffness: Numbers | None = key(
        NON_NEGATIVE_PER_VELOCITY,
        "Stiffness",
        "Stiffness of a spring on each coordinate, N·m/rad or N/m, not negative: a number, or a list, one for each"
        " coordinate.",
        1200.0,
        [300, 200],
        since=VERSION2_1,
    )
    rest: Numbers | None = key(
        OneOrList("PerCoordinate", NUMBER),
        "Rest position",
        "Coordinate at which the spring has no force, rad or m; 0 if left out: a number, or a list, one for each"
        " coordinate.",
        0.1,
        [0.1, -0.2],
        since=VERSION2_1,
    )
    mimic: bool | None = key(
        Never(),
        "Mimic",
        "false: the joint has a coordinate of its own, although it has a <mimic> in the URDF.",
        False,
        since=VERSION2_1,
    )
    limits: LimitsEntry | None = key(
        _LIMITS,
        "Joint limits",
        "Position (rad, m), velocity (rad/s, m/s) and effort (N·m, N) limits in place of the URDF's.",
        {"velocity": 12.0, "effort": 80.0},
    )
    damping: Numbers | None = key(
        NON_NEGATIVE_PER_VELOCITY,
        "Damping",
        "Viscous damping, N·m·s/rad or N·s/m, not negative: a number, or a list, one for each velocity.",
        0.1,
        [0.1, 0.2],
    )
    friction: Numbers | None = key(
        NON_NEGATIVE_PER_VELOCITY,
        "Friction",
        "Dry friction, N·m or N, not negative: a number, or a list, one for each velocity.",
        0.5,
        [0.5, 0.5],
    )
    armature: Numbers | None = key(
        NON_NEGATIVE_PER_VELOCITY,
        "Armature",
        "Reflected inertia, kg·m² or kg, not negative: a number, or a list, one for each velocity.",
        0.02,
        [0.02, 0.02],
    )
    type: str | None = None
    merges: tuple[str, ...] = ()
    axes: tuple[Vector3, ...] = ()
    pitch: float = 0.0
    split: str = ""

    @property
    def properties(self) -> dict[tuple[str, ...], Numbers]:
        """The properties that it states, by the keys on the way to each."""
        stated: list[tuple[tuple[str, ...], Numbers | None]]
        stated = [(("limits", name), getattr(self.limits, name, None)) for name in _LIMITS.all_keys]
        stated += [((name,), getattr(self, name)) for name in _PROPERTIES]
        return {keys: numbers for keys, numbers in stated if numbers is not None}


@entry
class Overridden(JointEntry):
    """A joint that keeps its type, with some properties in place of the URDF's."""

    title = "Joint that keeps its type"
    says_something = True


@entry
class Spherical(JointEntry):
    """A ball joint."""

    title = "Spherical joint"
    type: str = required(Choice("spherical"), "Type", "A ball joint: three rotations, a unit quaternion.", "spherical")
    merges: tuple[str, ...] = key(
        ListOf(URDF_JOINT_NAME, 3, 3),
        "Merged joints",
        "Three different rotary joints of the URDF, each the only child of the one before, whose axes meet in one"
        " point: together they are this joint.",
        ["toe_rx", "toe_ry", "toe_rz"],
        default=(),
    )


@entry
class Universal(JointEntry):
    """A cardan joint."""

    title = "Universal joint"
    type: str = required(Choice("universal"), "Type", "A cardan joint: two rotations about crossing axes.", "universal")
    axes: tuple[Vector3, ...] = required(
        TwoAxes(
            "two letters such as xy, or two vectors", Choice("xy", "xz", "yx", "yz", "zx", "zy"), ListOf(VECTOR, 2, 2)
        ),
        "Axes",
        "First and second axis in the joint's frame: two different letters of x, y, z, or two vectors (of any length,"
        " no unit).",
        "xy",
        [[1, 0, 0], [0, 0.7, 0.7]],
    )


@entry
class Cylindrical(JointEntry):
    """A joint that slides along its axis and turns about it."""

    title = "Cylindrical joint"
    type: str = required(
        Choice("cylindrical"), "Type", "Slides along the URDF joint's axis and turns about it.", "cylindrical"
    )


@entry
class Helical(JointEntry):
    """A screw."""

    title = "Helical joint"
    type: str = required(
        Choice("helical"), "Type", "A screw: turns about the URDF joint's axis and moves along it.", "helical"
    )
    pitch: float = required(
        NUMBER, "Pitch", "Advance along the axis, m per revolution; positive for a right-handed screw.", 0.005
    )


@entry
class Fixed(JointEntry):
    """A joint locked at its zero."""

    title = "Fixed joint"
    type: str = required(Choice("fixed"), "Type", "Locked at its zero position.", "fixed")


class _JointRecord(Record):
    """The mapping of a joint, whose name is the last key on the way to it."""

    def read(self, value: dict[str, Any], at: Pointer, **more: Any) -> Any:
        return super().read(value, at, name=at[-1], **more)

    def write(self, value: Entry) -> dict[str, Any]:
        """What its type needs, then what it has in every version."""
        written = super().write(value)
        needed = [name for name in written if self.all_keys[name].required]
        return {name: written[name] for name in (*needed, *dict(in_order(self.all_keys))) if name in written}


_RECORDS = [_JointRecord(model) for model in JointEntry.__subclasses__()]

#: The types that need no more than their name.
NAMED = [
    name
    for record in _RECORDS
    for name in record.values_of_type()
    if all(key == "type" or not each.required for key, each in record.all_keys.items())
]

JOINT = OneOf(
    "a joint type, or a mapping {type: …, limits: …}",
    Alone(Choice(*NAMED), "type"),
    *_RECORDS,
    name="Joint",
    apart="'{key}' belongs to type '{owner}', not to type '{kind}'",
)

_PROPERTIES = [name for name, each in in_order(JOINT.keys(VERSION2_1)) if isinstance(each.type, OneOrList)]


@entry
class Geared(Entry):
    """An actuated joint and its motor."""

    title = "Actuator with a gear"
    name: str | None = key(
        NAME,
        "Name",
        "Name of the actuator, unique in the file; that of the joint if left out.",
        "left_knee",
        since=VERSION2_1,
    )
    control: tuple[float, float] | None = key(
        ListOf(NUMBER, 2, 2),
        "Control range",
        "Smallest and largest torque or force of the motor, at the joint, N·m or N.",
        [-80, 80],
        since=VERSION2_1,
    )
    joint: str = required(MOVING_JOINT_NAME, "Joint", "The actuated joint.", "motor_knee")
    gear_ratio: float | None = key(
        NON_ZERO,
        "Gear ratio",
        "Motor revolutions per revolution of the joint (per metre for a sliding joint), not 0; negative where they turn"
        " in opposite senses.",
        50,
    )
    rotor_inertia: float | None = key(
        NON_NEGATIVE, "Rotor inertia", "Inertia of the motor's rotor about its own axis, kg·m², not negative.", 1.2e-4
    )


ACTUATOR = OneOf(
    "the name of a joint, or a mapping {joint: …, gear_ratio: …}", Alone(MOVING_JOINT_NAME, "joint"), Record(Geared)
)
