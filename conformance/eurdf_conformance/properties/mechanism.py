"""A mechanism as a plain value: the content of a robot's two files, without any spelling.

`urdf` and `document` write it down; relations change it. It is as free as the files are: nothing here checks it.
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

Vector = tuple[float, float, float]
Coordinates = tuple[float, ...]
Configuration = dict[str, Coordinates]

#: A number for all coordinates or velocities of a joint, or one each.
PerNumber = float | tuple[float, ...]

ZERO: Vector = (0.0, 0.0, 0.0)


class Part(BaseModel):
    """A part of a mechanism."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Pose(Part):
    """Origin, m, and roll, pitch, yaw, rad, EU-FRM-006."""

    xyz: Vector = ZERO
    rpy: Vector = ZERO


class Inertia(Part):
    """Mass, kg; centre of mass and axes; ixx, ixy, ixz, iyy, iyz, izz about that centre along those axes, kg·m²."""

    mass: float
    pose: Pose = Pose()
    moments: tuple[float, float, float, float, float, float]


class Link(Part):
    """A link of the URDF; without inertia it weighs nothing."""

    name: str
    inertia: Inertia | None = None


class Limit(Part):
    """Limits as a URDF has them; `lower` and `upper` of revolute and prismatic joints."""

    effort: float
    velocity: float
    lower: float | None = None
    upper: float | None = None


class Mimic(Part):
    """q = multiplier · q_joint + offset, rad or m."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


class Joint(Part):
    """A joint of the URDF."""

    name: str
    type: Literal["revolute", "continuous", "prismatic", "planar", "floating", "fixed"]
    parent: str
    child: str
    origin: Pose = Pose()
    axis: Vector | None = None
    limit: Limit | None = None
    damping: float | None = None
    friction: float | None = None
    mimic: Mimic | None = None


class Change(Part):
    """What the description states about a joint: a new type, properties, or both."""

    type: Literal["spherical", "universal", "cylindrical", "helical", "fixed"] | None = None
    #: Of a universal joint: two letters, or two vectors in the joint's frame.
    axes: str | tuple[Vector, Vector] | None = None
    #: Of a helical joint, m a revolution.
    pitch: float | None = None
    #: Joints of the URDF that are merged into one spherical joint.
    merges: tuple[str, ...] = ()
    lower: PerNumber | None = None
    upper: PerNumber | None = None
    velocity: PerNumber | None = None
    effort: PerNumber | None = None
    damping: PerNumber | None = None
    friction: PerNumber | None = None
    armature: PerNumber | None = None
    #: Of version 2.1: a spring on each coordinate.
    stiffness: PerNumber | None = None
    rest: PerNumber | None = None
    #: Of version 2.1: whether the joint mimics no other, whatever the URDF says.
    freed: bool = False
    #: User data, under keys that begin with `x-`.
    own: dict[str, Any] = {}

    @property
    def says_something(self) -> bool:
        """Whether it states a type or a property; otherwise the file has no entry for the joint."""
        return self != Change(own=self.own)


class Spot(Part):
    """A frame at a pose in the frame of a link or a joint."""

    on: Literal["link", "joint"]
    of: str
    pose: Pose = Pose()


class Frame(Part):
    """A frame that the description adds."""

    name: str
    spot: Spot


class Compliance(Part):
    """What a closure gives way by, m/N and rad/(N·m)."""

    linear: float | None = None
    angular: float | None = None


class Closure(Part):
    """A closure between frames A and B; each is a name, or a pose written in place."""

    name: str
    type: Literal["3d", "6d", "hinge", "distance"]
    a: str | Spot
    b: str | Spot
    #: Of a hinge, the axis in A and in B, or one each.
    axis: Vector | None = None
    axes: tuple[Vector, Vector] | None = None
    #: Of a distance, m.
    length: float | None = None
    #: Of version 2.1.
    compliance: Compliance | None = None


class Coupling(Part):
    """Σ coefficient · coordinate = offset."""

    name: str
    joints: dict[str, float]
    offset: float = 0.0


class Actuator(Part):
    """A joint with a motor."""

    joint: str
    gear_ratio: float | None = None
    rotor_inertia: float | None = None
    #: Of version 2.1.
    name: str | None = None
    control: tuple[float, float] | None = None


class Mechanism(Part):
    """The content of a robot's two files."""

    name: str = "robot"
    root: Literal["fixed", "floating"] = "fixed"
    links: tuple[Link, ...]
    joints: tuple[Joint, ...] = ()
    #: By the name of the joint that is changed, or made.
    changes: dict[str, Change] = {}
    frames: tuple[Frame, ...] = ()
    closures: tuple[Closure, ...] = ()
    #: Of version 2.1.
    couplings: tuple[Coupling, ...] = ()
    actuators: tuple[Actuator, ...] = ()
    #: At `assembled` every closure is closed. Those of version 1, whose files have none, are asked for all the same.
    configurations: dict[str, Configuration] = {}
    #: User data, under keys that begin with `x-`.
    own: dict[str, Any] = {}

    @property
    def merged(self) -> dict[str, str]:
        """For each merged joint, the name of the joint that it is merged into."""
        return {joint: name for name, change in self.changes.items() for joint in change.merges}

    def type_of(self, joint: Joint) -> str:
        """Type that a joint of the URDF has in the mechanism; `merged` if it is merged into another."""
        if joint.name in self.merged:
            return "merged"
        return (self.changes[joint.name].type if joint.name in self.changes else None) or joint.type

    def mimics(self, joint: Joint) -> bool:
        """Whether a joint of the URDF mimics another one."""
        entry = self.changes.get(self.merged.get(joint.name, joint.name))
        return joint.mimic is not None and not (entry and entry.freed)

    def types(self) -> dict[str, str]:
        """The type of each moving joint, including joints made by merging and mimic joints."""
        found = {joint.name: self.type_of(joint) for joint in self.joints}
        found |= {name: "spherical" for name, change in self.changes.items() if change.merges}
        if self.root == "floating":
            found["root_joint"] = "floating"
        return {name: kind for name, kind in found.items() if kind not in ("fixed", "merged")}

    def replace(self, **parts: Any) -> Mechanism:
        """The same mechanism with some parts replaced."""
        return self.model_copy(update=parts)
