"""Bodies, the links of the robot, with inertia and shapes, and frames fixed to them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from eurdf.mechanism.pose import IDENTITY, Pose


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
        visuals: Visual shapes, in file order.
        collisions: Collision shapes, in file order.
        virtual: Whether the body is not a link of the URDF but connects the two revolutes that a universal joint of
            version 1 was split into. It has neither inertia nor shape nor a frame of its own.
    """

    name: str
    inertia: Inertia | None = None
    visuals: tuple[Shape, ...] = ()
    collisions: tuple[Shape, ...] = ()
    virtual: bool = False


@dataclass(frozen=True, slots=True)
class Frame:
    """A named frame that is neither that of a body nor that of a joint.

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


#: What an anchor in the world has in place of the name of a body: no link has an empty name.
WORLD = ""


@dataclass(frozen=True, slots=True)
class Anchor:
    """One side of a closure.

    Attributes:
        body: Body it is fixed to, or `WORLD`.
        pose: Pose in that body's frame.
        frame: Name the description gives it; empty for a pose written in place.
    """

    body: str
    pose: Pose = IDENTITY
    frame: str = ""
