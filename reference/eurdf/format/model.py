"""The models of a file of version 1, 2.0 and 2.1: each key once, with the version that adds it.

From the models follow the check of a file, its JSON Schema (`eurdf.format.schema`), what is read from it
(`eurdf.format.read`), the mappings that are written, and the hints on errors (`eurdf.format.messages`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import Any, ClassVar, Literal

from eurdf.format.closure_model import CLOSURE, FRAME, ClosureEntry, CouplingEntry, Frame, FrameReference
from eurdf.format.conventions import VERSION2_0, VERSION2_1, VERSION_KEY, Version
from eurdf.format.joint_model import ACTUATOR, JOINT, Geared, JointEntry, OneOrList
from eurdf.format.mappings import Entry, Record, entry, key, required
from eurdf.format.value_types import (
    FRAME_NAME,
    JOINT_NAME,
    MOVING_JOINT_NAME,
    NAME,
    NUMBER,
    URDF_JOINT_NAME,
    Anything,
    ByName,
    Check,
    Choice,
    ListOf,
    ThisVersion,
    Violation,
)
from eurdf.mechanism.mechanism import Root
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument


class CoordinateList(OneOrList):
    """The coordinates of a joint, read as a tuple in any case."""

    def read(self, value: Any, at: Pointer) -> tuple[float, ...]:
        read = super().read(value, at)
        return read if isinstance(read, tuple) else (read,)

    def write(self, value: Any) -> Any:
        """One number if there is one."""
        return self.all_forms[len(value) != 1].write(value if len(value) != 1 else value[0])


@entry
class Version2(Entry):
    """A robot's loop closures, actuators, joints, frames and configurations beside its URDF."""

    title = "Extended URDF, version {version}"
    extended_urdf: Version = required(ThisVersion(), "Version", "Version of the format, in quotes.")
    urdf: str = key(NAME, "URDF file", "Path of the URDF, relative to this file.", "robot.urdf", default="robot.urdf")
    root: Root = key(
        Choice("fixed", "floating"),
        "Root",
        "Whether the root link is fixed to the world or floats in it.",
        "floating",
        default="fixed",
    )
    closures: tuple[ClosureEntry, ...] = key(
        ListOf(CLOSURE),
        "Loop closures",
        "Pairs of frames that are held together.",
        [{"name": "knee_rod", "type": "6d", "frames": ["rod_tip", "knee_crank"]}],
        default=(),
    )
    joints: tuple[JointEntry, ...] = key(
        ByName(JOINT, entries=True, keys=JOINT_NAME),
        "Joints",
        "By name, joints of a type that URDF lacks, and properties in place of the URDF's. The name is a joint of the"
        " URDF, or with 'merges' that of the joint made.",
        {"hip_ball": "spherical", "ball_screw": {"type": "helical", "pitch": 0.005}},
        default=(),
    )
    actuators: tuple[Geared, ...] = key(
        ListOf(ACTUATOR),
        "Actuators",
        "The joints that have a motor: names, or mappings that describe the motor.",
        ["motor_hip_x", {"joint": "motor_knee", "gear_ratio": 50, "rotor_inertia": 1.2e-4}],
        default=(),
    )
    frames: tuple[Frame, ...] = key(
        ListOf(FRAME),
        "Frames",
        "Frames added to links or joints.",
        [{"name": "toe_tip", "link": "foot", "xyz": [0.12, 0, -0.03]}],
        default=(),
    )
    configurations: Mapping[str, Mapping[str, tuple[float, ...]]] = key(
        ByName(ByName(CoordinateList("Coordinates", NUMBER, 7), keys=MOVING_JOINT_NAME)),
        "Configurations",
        "By name, the coordinates of joints: a number or a list. Angle in rad, length in m; spherical: a unit"
        " quaternion x y z w; universal: two angles; cylindrical: length, angle; planar: x, y, angle; floating: x y z"
        " and a quaternion. Other joints are neutral, which must be within their limits. All closures are closed at"
        " 'assembled'.",
        {"assembled": {"motor_knee": 0.4, "hip_ball": [0, 0, 0, 1]}},
        default={},
    )
    metadata: Mapping[str, object] = key(
        Anything(),
        "Metadata",
        "Information about the file, such as license and source.",
        {"license": "BSD-3-Clause", "source": "CAD export of 2025-03-01"},
        default={},
    )
    couplings: tuple[CouplingEntry, ...] = key(
        ListOf(Record(CouplingEntry)),
        "Couplings",
        "Linear relations of joint coordinates, as gears, belts and differentials make them.",
        [{"name": "knee_gear", "joints": {"motor_1": 0.5, "motor_2": 0.5, "knee": -1}}],
        default=(),
        since=VERSION2_1,
    )


@entry
class Description(Version2):
    """What a file of any version says, before any name in it is looked up.

    Attributes:
        document: The file.
        own_data: User data, as plain values, by the pointer of their key: at any level of a version 2 file, at the top
            of a version 1 file.
    """

    document: YamlDocument = field(repr=False, compare=False)
    own_data: Mapping[Pointer, object] = field(default_factory=dict)

    @property
    def version(self) -> Version:
        """The version of the file."""
        return self.extended_urdf

    @property
    def actuators_key(self) -> str:
        """The key that lists the actuators."""
        return "name_mot" if self.version == "1" else "actuators"

    @property
    def references(self) -> tuple[FrameReference, ...]:
        """The frames of the closures, and those that are added."""
        return (*(side for closure in self.closures for side in closure.frames), *self.frames)


class _NamePairs(ListOf):
    """A list of pairs of names; EU-ONE-001: one of names, a pair without brackets, gives one error, not two."""

    def check(self, value: Any, at: Pointer, file: Check) -> None:
        if isinstance(value, list) and value and all(isinstance(item, str) for item in value):
            file.report(at, "wrong-type", "must be a list of pairs: [[A, B], …]", value)
        else:
            super().check(value, at, file)


@entry
class Version1(Entry):
    """A robot's loop closures, actuators and joints beside its URDF, in the published dialect.

    The file has no version key. Keys other than these five are user-defined.
    """

    title = "Extended URDF, version 1"
    needs: ClassVar[Mapping[str, str]] = {"joint_name": "joint_type", "joint_type": "joint_name"}
    is_open = True
    closed_loop: tuple[tuple[str, str], ...] = key(
        _NamePairs(ListOf(FRAME_NAME, 2, 2)),
        "Loop closures",
        "Pairs of frames, A and B, that a closure joins: names of links or joints of the URDF.",
        [["rod_tip", "knee_crank"]],
        default=(),
        becomes="closures",
    )
    type: tuple[str, ...] | None = key(
        ListOf(Choice("3d", "3D", "6d", "6D")),
        "Closure types",
        "One for each pair of 'closed_loop', in its order. 3d: the origins of frames A and B coincide. 6d: their"
        " orientations also agree. If the key is left out, all closures are 6d.",
        ["6d", "3d"],
        becomes="closures",
    )
    name_mot: tuple[str, ...] = key(
        ListOf(MOVING_JOINT_NAME),
        "Actuated joints",
        "Names of the joints that have a motor.",
        ["motor_hip_x", "motor_knee"],
        default=(),
        becomes="actuators",
    )
    joint_name: tuple[str, ...] = key(
        ListOf(URDF_JOINT_NAME),
        "Replaced joints",
        "Joints of the URDF that get a type which URDF does not have; needs 'joint_type'.",
        ["hip_ball", "knee_cardan"],
        default=(),
        becomes="joints",
    )
    joint_type: tuple[str, ...] = key(
        ListOf(Choice("SPHERICAL", "FIXED", *(f"UJOINT_{a}{b}" for a in "XYZ" for b in "XYZ" if a != b))),
        "Their types",
        "One for each joint of 'joint_name', in its order, in capitals. SPHERICAL: a ball joint. UJOINT_AB: two"
        " revolutes about the axes A, then B, of the joint's frame. FIXED: locked at zero.",
        ["SPHERICAL", "UJOINT_XY"],
        default=(),
        becomes="joints",
    )


VERSION1 = Record(Version1)
VERSION2 = Record(Version2)
DESCRIPTION = Record(Description)

#: The mapping that a file of each version is.
MODELS: Mapping[Version, Record] = {"1": VERSION1, "2.0": VERSION2, "2.1": VERSION2}


def violations(version: Version, data: Mapping[str, Any]) -> list[Violation]:
    """What is wrong with the content of a file (EU-SCH-001 to EU-SCH-006, EU-EXT-001)."""
    check = Check(version)
    MODELS[version].check(data, (), check)
    return check.found


def lowest_version(content: Mapping[str, Any]) -> Literal["2.0", "2.1"]:
    """The lowest version that has all keys and types of the content of a file; which version that states is ignored."""
    found = violations(VERSION2_0, {**content, VERSION_KEY: VERSION2_0})
    return VERSION2_1 if any(each.code in ("unknown-key", "later-value") for each in found) else VERSION2_0
