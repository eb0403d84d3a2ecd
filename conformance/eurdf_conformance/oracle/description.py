"""What a description says, whatever its version: the input of `tree`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from eurdf_conformance.level import Version
from eurdf_conformance.oracle.spatial import Array

ClosureType = Literal["3d", "6d", "hinge", "distance"]

#: A number for all coordinates or velocities of a joint, or one each.
PerNumber = list[float]


@dataclass(frozen=True)
class FrameReference:
    """A frame, as chapter Frames lets one say it: by a name, or at a pose on a link or a joint."""

    on: Literal["name", "link", "joint"]
    name: str
    #: In the frame of that name, link or joint.
    pose: Array


@dataclass(frozen=True)
class Closure:
    """Frames A and B, held together."""

    name: str
    type: ClosureType
    a: FrameReference
    b: FrameReference
    #: Of a hinge: unit vectors, in A and in B.
    axes: tuple[Array, ...] = ()
    #: Of a distance, m.
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
    """What a joint becomes, and what is stated of it; what is not stated stays the URDF's."""

    #: None: as it is. "pair": the two revolutes that version 1 makes, EU-ONE-006.
    type: str | None = None
    #: Unit vectors in the joint's frame, of a universal joint or a pair.
    axes: tuple[Array, ...] = ()
    #: Letters of the names of a pair.
    letters: str = ""
    #: m a revolution.
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
    #: By name; with `merges` that of the joint made, which need be none of the URDF's.
    changes: dict[str, Change] = field(default_factory=dict)
    actuators: tuple[Actuator, ...] = ()
    #: Frames that it adds, by name.
    frames: dict[str, FrameReference] = field(default_factory=dict)
    #: By name, for each joint its coordinates.
    configurations: dict[str, dict[str, list[float]]] = field(default_factory=dict)
    #: User data, by JSON pointer.
    own: dict[str, Any] = field(default_factory=dict)
