"""The mechanism: bodies, joints, closures, actuators and frames as plain data.

Everything before it knows files and positions; everything after it knows only this. Units are SI (m, rad, kg, s, N,
N·m). Every tuple of bodies and joints is in the order of a depth-first walk from the root in which the joints of one
body come in the byte order of their names: the order of Pinocchio's and urdfdom's models.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from eurdf.mechanism.joint_type import COORDINATES, Coordinates, JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3

ClosureType = Literal["3d", "6d"]
Root = Literal["fixed", "floating"]

#: Name of the joint by which a floating root moves in the world, in every model.
ROOT_JOINT = "root_joint"


@dataclass(frozen=True, slots=True)
class Inertia:
    """Inertia of a body, as URDF gives it.

    Attributes:
        mass: kg.
        pose: Pose of the inertial frame in the body's frame; its origin is the centre of mass.
        moments: ixx, ixy, ixz, iyy, iyz, izz about the centre of mass, in the inertial frame, kg·m².
    """

    mass: float
    pose: Pose
    moments: tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Shape:
    """A geometry of a body.

    Attributes:
        kind: What it is.
        size: Box: x, y, z; cylinder and capsule: radius, length; sphere: radius; mesh: scale x, y, z. In m.
        filename: URI of the mesh as the URDF writes it; empty otherwise.
        pose: Pose in the body's frame.
        color: red, green, blue, alpha from 0 to 1; None where the URDF gives none.
        texture: File name of the material's texture; empty where there is none.
    """

    kind: Literal["box", "cylinder", "sphere", "capsule", "mesh"]
    size: tuple[float, ...]
    pose: Pose = IDENTITY
    filename: str = ""
    color: tuple[float, float, float, float] | None = None
    texture: str = ""


@dataclass(frozen=True, slots=True)
class Body:
    """A link.

    Attributes:
        name: Name of the link.
        inertia: None where the URDF gives none.
        visuals: What is seen, in file order.
        collisions: What collides, in file order.
        virtual: Whether the body is no link of the URDF, but stands between the two revolutes that a universal joint
            of version 1 was split into. It has neither inertia nor shape nor a frame of its own.
    """

    name: str
    inertia: Inertia | None = None
    visuals: tuple[Shape, ...] = ()
    collisions: tuple[Shape, ...] = ()
    virtual: bool = False


@dataclass(frozen=True, slots=True)
class Mimic:
    """q = multiplier · q_joint + offset, in rad or m."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint of the spanning tree.

    Attributes:
        name: Unique among the joints.
        type: One of the ten joint types.
        parent: Body it hangs from.
        child: Body it carries.
        placement: Pose of the joint in the frame of the parent body.
        offset: Pose of the child body's frame in the moving frame of the joint. The identity but for merged joints
            whose axes meet away from the last one's origin. The frame that bears the joint's name is the child's.
        axes: Directions in the joint's frame, as written, of any length but zero: one for revolute, continuous,
            prismatic, helical, cylindrical; two, first and second, for universal; none otherwise. Planar moves in
            the joint's xy plane.
        pitch: Advance of a helical joint along its axis, m per revolution, right-handed; 0 otherwise.
        lower: Lower position limits, one a coordinate as in `Coordinates`; -inf where there is none.
        upper: Upper position limits; inf where there is none.
        velocity: Velocity limits, one a velocity, rad/s or m/s; inf where there is none.
        effort: Effort limits, one a velocity, N·m or N; inf where there is none.
        damping: Viscous damping, one a velocity, N·m·s/rad or N·s/m.
        friction: Dry friction, one a velocity, N·m or N.
        armature: Reflected inertia, one a velocity, kg·m² or kg.
        gear_ratio: Motor revolutions per joint revolution, one a velocity.
        rotor_inertia: Inertia of the motor's rotor about its own axis, one a velocity, kg·m².
        mimic: The joint this one follows, or None.
    """

    name: str
    type: JointType
    parent: str
    child: str
    placement: Pose = IDENTITY
    offset: Pose = IDENTITY
    axes: tuple[Vector3, ...] = ()
    pitch: float = 0.0
    lower: tuple[float, ...] = ()
    upper: tuple[float, ...] = ()
    velocity: tuple[float, ...] = ()
    effort: tuple[float, ...] = ()
    damping: tuple[float, ...] = ()
    friction: tuple[float, ...] = ()
    armature: tuple[float, ...] = ()
    gear_ratio: tuple[float, ...] = ()
    rotor_inertia: tuple[float, ...] = ()
    mimic: Mimic | None = None

    @property
    def coordinates(self) -> Coordinates:
        """How its configuration is written in files and answers."""
        return COORDINATES[self.type]


@dataclass(frozen=True, slots=True)
class Frame:
    """A named frame that is neither a body's nor a joint's own.

    Attributes:
        name: As the description gives it, or the name of a joint that version 1 split in two.
        body: Body it is fixed to.
        pose: Pose in that body's frame.
        kind: ``frame`` for one that the description adds, ``joint`` for a joint of the URDF that was split.
    """

    name: str
    body: str
    pose: Pose = IDENTITY
    kind: Literal["frame", "joint"] = "frame"


@dataclass(frozen=True, slots=True)
class Anchor:
    """One side of a closure.

    Attributes:
        body: Body it is fixed to.
        pose: Pose in that body's frame.
        frame: Name the description gives it; empty for a pose written in place.
    """

    body: str
    pose: Pose = IDENTITY
    frame: str = ""


@dataclass(frozen=True, slots=True)
class Closure:
    """A loop closure: frame B is held on frame A, in position (3d) or in position and orientation (6d).

    Attributes:
        name: Unique among the closures.
        type: ``3d``, 3 rows: the origin of B, seen from A; or ``6d``, 6 rows: log6 of the pose of B in A.
        a: Frame A.
        b: Frame B.
    """

    name: str
    type: ClosureType
    a: Anchor
    b: Anchor

    @property
    def rows(self) -> int:
        """Number of constraint rows."""
        return 3 if self.type == "3d" else 6


@dataclass(frozen=True, slots=True)
class Mechanism:
    """A robot with closed kinematic chains.

    Attributes:
        name: Name of the robot in the URDF.
        version: Version of the description it was read from: ``1``, ``2.0``, or empty for a bare URDF.
        root: Whether the root body is fixed to the world or floats in it.
        bodies: In depth-first order; the first is the root.
        joints: In depth-first order, fixed ones too; ``joints[i].child`` is ``bodies[i + 1]``.
        frames: Frames beside those of bodies and joints, in file order.
        closures: In file order.
        actuators: Names of the actuated joints, in file order.
        configurations: By name; for each joint its coordinates, for a floating root those of `ROOT_JOINT`. A joint left
            out stands at its neutral.
        metadata: What the file says of itself.
        own_data: The user's own data in the file, as plain values, by the JSON pointer of their key.
    """

    name: str
    version: str
    root: Root
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...] = ()
    closures: tuple[Closure, ...] = ()
    actuators: tuple[str, ...] = ()
    configurations: Mapping[str, Mapping[str, tuple[float, ...]]] = field(default_factory=lambda: MappingProxyType({}))
    metadata: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    own_data: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def nc(self) -> int:
        """Number of constraint rows of all closures."""
        return sum(closure.rows for closure in self.closures)
