"""The content of a description of either version: the input of `tree`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from eurdf_conformance.level import Version
from eurdf_conformance.oracle.spatial import Array

ClosureType = Literal["3d", "6d", "hinge", "distance"]

#: One number for all coordinates or velocities of a joint, or one for each.
PerNumber = list[float | None]


@dataclass(frozen=True)
class FrameReference:
    """A reference to a frame, chapter Frames: a name, or a pose on a link or a joint."""

    on: Literal["name", "link", "joint"]
    name: str
    #: In the frame of that name, link or joint.
    pose: Array


@dataclass(frozen=True)
class Closure:
    """A closure between frames A and B."""

    name: str
    type: ClosureType
    a: FrameReference
    b: FrameReference
    #: Unit vectors of the axis of a hinge, in A and in B.
    axes: tuple[Array, ...] = ()
    #: Length of a distance, m.
    length: float | None = None
    #: linear, m/N, and angular, rad/(N·m), where one of them is stated.
    compliance: dict[str, float] | None = None


@dataclass(frozen=True)
class Coupling:
    """Σ coefficient · coordinate = offset."""

    name: str
    #: By joint, none of them 0.
    coefficients: dict[str, float]
    offset: float


@dataclass(frozen=True)
class Change:
    """A joint's new type and its stated properties; other properties stay as in the URDF."""

    #: None: the type of the URDF. "pair": the two revolutes that version 1 makes, EU-ONE-006.
    type: str | None = None
    #: Axes of a universal joint or a pair: unit vectors in the joint's frame.
    axes: tuple[Array, ...] = ()
    #: The letters in the names of a pair.
    letters: str = ""
    #: m per revolution.
    pitch: float = 0.0
    merges: tuple[str, ...] = ()
    #: lower, upper, velocity, effort, damping, friction, armature, stiffness, rest.
    stated: dict[str, PerNumber] = field(default_factory=dict)
    #: Whether the joint, or each of those merged, mimics no other, whatever the URDF says: EU-JNT-033.
    freed: bool = False


@dataclass(frozen=True)
class Actuator:
    """A joint with a motor."""

    joint: str
    gear_ratio: float = 1.0
    #: kg·m²
    rotor_inertia: float = 0.0
    name: str | None = None
    #: Smallest and largest torque or force, N·m or N.
    control: list[float] | None = None


@dataclass(frozen=True)
class Description:
    """One YAML file."""

    version: Version = "2"
    root: Literal["fixed", "floating"] = "fixed"
    closures: tuple[Closure, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    #: By name; with `merges` it is the name of the new joint, which may be new.
    changes: dict[str, Change] = field(default_factory=dict)
    actuators: tuple[Actuator, ...] = ()
    #: Frames that the description adds, by name.
    frames: dict[str, FrameReference] = field(default_factory=dict)
    #: Coordinates of joints, by name of the configuration.
    configurations: dict[str, dict[str, list[float]]] = field(default_factory=dict)
    #: User data, by JSON pointer.
    own: dict[str, Any] = field(default_factory=dict)
