"""The description in the YAML file, of either version, before any name in it is looked up.

Every entry keeps the pointer to its place, as a tuple of keys and indices; `YamlDocument.place` turns it into a
line and a column.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from eurdf.mechanism.constraint import Compliance
from eurdf.mechanism.mechanism import Root
from eurdf.mechanism.pose import Vector3
from eurdf.reading.yaml_node import Pointer
from eurdf.reading.yaml_reader import YamlDocument

#: A type that the description gives to a joint of the URDF.
NewType = Literal["spherical", "universal", "cylindrical", "helical", "fixed"]


class FrameReference(NamedTuple):
    """A frame by its name, or as a pose on a link or on a joint's frame.

    Attributes:
        pointer: Its place.
        name: Name of the frame, or of the link or joint whose frame (on the child's side) the pose is in.
        kind: What the name is of; a frame has no pose.
        xyz: m.
        rpy: rad, about fixed axes.
    """

    pointer: Pointer
    name: str
    kind: Literal["frame", "link", "joint"] = "frame"
    xyz: Vector3 = (0.0, 0.0, 0.0)
    rpy: Vector3 = (0.0, 0.0, 0.0)


class ClosureEntry(NamedTuple):
    """A loop closure as written.

    Attributes:
        pointer: Where it is.
        name: Unique in the file.
        type: It can also be user-defined, ``x-…``.
        a: Frame A.
        b: Frame B.
        axes: Of a hinge: the axis in A and the axis in B, as written or z.
        axes_pointer: Where they are.
        length: Of a distance: m.
        compliance: None where none is written.
    """

    pointer: Pointer
    name: str
    type: str
    a: FrameReference
    b: FrameReference
    axes: tuple[Vector3, Vector3] | None = None
    axes_pointer: Pointer = ()
    length: float | None = None
    compliance: Compliance | None = None


class CouplingEntry(NamedTuple):
    """A linear relation of joint coordinates as written.

    Attributes:
        pointer: Where it is.
        name: Unique among closures and couplings.
        joints: Coefficients by the name of the joint, none of them 0.
        offset: What the products add up to.
    """

    pointer: Pointer
    name: str
    joints: Mapping[str, float]
    offset: float = 0.0


class JointEntry(NamedTuple):
    """The entry of one joint in the description.

    Attributes:
        pointer: The place of its value.
        name: Joint of the URDF; of merged joints, the one that results.
        type: New type, or None to keep the URDF's own.
        split: A universal joint of version 1: two revolutes ``name_A`` and ``name_B``, for letters such as ``XY``.
        axes: Two axes of a universal joint in the joint's frame, as written; empty where none are.
        pitch: m per revolution, of a helical joint.
        merges: Names of three joints of the URDF that become this one; empty where none do.
        lower: Position limits, one number for all coordinates or one each; None where not written. Likewise the rest.
        upper: See ``lower``.
        velocity: rad/s or m/s.
        effort: N·m or N.
        damping: N·m·s/rad or N·s/m.
        friction: N·m or N.
        armature: kg·m² or kg.
        stiffness: Of springs, N·m/rad or N/m.
        rest: Coordinates at which the springs have no force, rad or m.
        freed: Whether the joint, or each of those merged, has a coordinate of its own despite its ``<mimic>``.
    """

    pointer: Pointer
    name: str
    type: NewType | None = None
    split: str = ""
    axes: tuple[Vector3, ...] = ()
    pitch: float = 0.0
    merges: tuple[str, ...] = ()
    lower: float | tuple[float, ...] | None = None
    upper: float | tuple[float, ...] | None = None
    velocity: float | tuple[float, ...] | None = None
    effort: float | tuple[float, ...] | None = None
    damping: float | tuple[float, ...] | None = None
    friction: float | tuple[float, ...] | None = None
    armature: float | tuple[float, ...] | None = None
    stiffness: float | tuple[float, ...] | None = None
    rest: float | tuple[float, ...] | None = None
    freed: bool = False


class ActuatorEntry(NamedTuple):
    """An actuated joint; what is not written is None.

    Attributes:
        pointer: Where it is.
        joint: Name of the joint.
        gear_ratio: Motor revolutions per joint revolution.
        rotor_inertia: kg·m².
        name: Name of the actuator.
        control: Smallest and largest torque or force at the joint, N·m or N.
    """

    pointer: Pointer
    joint: str
    gear_ratio: float | None = None
    rotor_inertia: float | None = None
    name: str | None = None
    control: tuple[float, float] | None = None


class FrameEntry(NamedTuple):
    """A named frame on a link or on a joint's frame."""

    pointer: Pointer
    name: str
    reference: FrameReference


class ConfigurationEntry(NamedTuple):
    """A named configuration: for each joint its coordinates as written, always as a tuple."""

    pointer: Pointer
    name: str
    joints: Mapping[str, tuple[float, ...]]


@dataclass(frozen=True, slots=True)
class Extension:
    """The YAML file, of either version.

    Attributes:
        document: The file.
        version: ``1``, ``2.0`` or ``2.1``.
        urdf: Path of the URDF, relative to the YAML file.
        root: Whether the root link is fixed or floating.
        closures: In file order; likewise the other lists.
        metadata: The file's metadata.
        own_data: User data, as plain values, by the pointer of their key: at any level of a version 2 file,
            at the top of a version 1 file.
    """

    document: YamlDocument = field(repr=False, compare=False)
    version: Literal["1", "2.0", "2.1"]
    urdf: str = "robot.urdf"
    root: Root = "fixed"
    closures: tuple[ClosureEntry, ...] = ()
    couplings: tuple[CouplingEntry, ...] = ()
    joints: tuple[JointEntry, ...] = ()
    actuators: tuple[ActuatorEntry, ...] = ()
    frames: tuple[FrameEntry, ...] = ()
    configurations: tuple[ConfigurationEntry, ...] = ()
    metadata: Mapping[str, object] = field(default_factory=dict)
    own_data: Mapping[Pointer, object] = field(default_factory=dict)

    @property
    def references(self) -> tuple[FrameReference, ...]:
        """The frames of the closures, and those on which frames are added."""
        sides = (side for closure in self.closures for side in (closure.a, closure.b))
        return (*sides, *(frame.reference for frame in self.frames))


__all__ = [
    "ActuatorEntry",
    "ClosureEntry",
    "ConfigurationEntry",
    "CouplingEntry",
    "Extension",
    "FrameEntry",
    "FrameReference",
    "JointEntry",
]
