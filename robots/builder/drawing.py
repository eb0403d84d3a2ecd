"""A robot drawn in one assembled pose, in world coordinates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robots.builder.joint import Joint, ball, cross, unit, universal
from robots.builder.mirror import mirrored_joint, mirrored_shape, mirrored_solid, mirrored_turn, mirrored_vector
from robots.builder.shape import Cylinder, Matrix3, Shape, Sphere, Vector3, midpoint
from robots.builder.solid import Solid

Color = tuple[float, float, float, float]

#: Of a joint: one number, or a list of several.
Coordinates = float | Sequence[float]

#: What a rod has at its end: a joint, or (at its second end) a point that a 3d closure holds.
End = Literal["ball", "universal", "point"]


@dataclass(frozen=True, slots=True)
class Body:
    """A body.

    Attributes:
        name: Unique among bodies.
        joint: The joint that carries it; None for the root.
        shapes: What it is made of.
        contacts: Those of its shapes that may touch other things.
        material: Name of its colour.
        solid: Mass, centre of mass and inertia, where they are not those of its shapes.
    """

    name: str
    joint: Joint | None
    shapes: tuple[Shape, ...]
    contacts: tuple[Shape, ...]
    material: str
    solid: Solid | None = None

    @property
    def origin(self) -> Vector3:
        """Origin of its frame in the world, m: its joint; for the root, the world's own origin."""
        return self.joint.at if self.joint else (0.0, 0.0, 0.0)

    @property
    def rotation(self) -> Matrix3:
        """Orientation of its frame in the world, 3 x 3: its joint's; for the root, the world's own."""
        return self.joint.rotation if self.joint else np.eye(3)


@dataclass(frozen=True, slots=True)
class Closure:
    """A loop closure: two bodies are held together. Its frames are along the axes of the world.

    Attributes:
        name: Unique among closures.
        type: ``3d`` holds a point, ``6d`` the orientation too, ``hinge`` an axis too, ``distance`` the distance of two.
        bodies: The two bodies, A and B.
        points: The points on A and on B in the world, m; one and the same, except for a distance.
        axis: Of a hinge, in the world.
    """

    name: str
    type: Literal["3d", "6d", "hinge", "distance"]
    bodies: tuple[str, str]
    points: tuple[Vector3, Vector3]
    axis: Vector3 | None = None

    @property
    def frames(self) -> tuple[str, str]:
        """Names of the two frames, on A and on B."""
        return (f"{self.name}_a", f"{self.name}_b")


@dataclass(frozen=True, slots=True)
class Coupling:
    """A linear relation of joint coordinates: the products of coefficients (by joint) and coordinates add up to 0."""

    name: str
    joints: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Frame:
    """A named frame of a body, such as a sole or an IMU.

    Attributes:
        name: Unique among frames.
        body: The body it is on.
        at: Its origin in the world, m.
        rpy: Its orientation in the world: roll, pitch, yaw about the fixed axes, rad.
    """

    name: str
    body: str
    at: Vector3
    rpy: Vector3 = (0.0, 0.0, 0.0)


class Drawing:
    """A robot as it is drawn: bodies, each with the joint that carries it, and closures.

    Attributes:
        name: Name of the robot.
        materials: Colours by name: red, green, blue, alpha from 0 to 1.
        metadata: What the description says of itself.
        root: Whether its root is fixed or floats.
        bodies: By name; parents before their children.
        closures: In the order drawn.
        couplings: Likewise.
        frames: Likewise.
        configurations: Beside the drawn one, by name: coordinates by joint (rad, m; a list where there are several);
            those of joints left out are neutral.
    """

    def __init__(
        self,
        name: str,
        materials: Mapping[str, Color],
        metadata: Mapping[str, str],
        root: Literal["fixed", "floating"] = "fixed",
    ) -> None:
        self.name = name
        self.materials = materials
        self.metadata = metadata
        self.root = root
        self.bodies: dict[str, Body] = {}
        self.closures: list[Closure] = []
        self.couplings: list[Coupling] = []
        self.frames: list[Frame] = []
        self.configurations: dict[str, Mapping[str, Coordinates]] = {}

    @property
    def joints(self) -> list[Joint]:
        """The joints, parents before their children."""
        return [body.joint for body in self.bodies.values() if body.joint]

    def body(
        self,
        name: str,
        joint: Joint | None,
        *shapes: Shape,
        material: str,
        contacts: tuple[Shape, ...] = (),
        solid: Solid | None = None,
    ) -> None:
        """Draws a body and the joint that carries it (None for the root, which comes first).

        Args:
            name: Unique among the bodies.
            joint: The joint that carries it.
            shapes: What it is made of.
            material: Name of its colour.
            contacts: Those of its shapes that may touch other things.
            solid: Its mass, centre of mass and inertia where they are known; those of the shapes do not count then.

        Raises:
            ValueError: If the name is taken, the material or the parent is not drawn, or it is a second root.
        """
        if name in self.bodies:
            raise ValueError(f"there are two bodies '{name}'")
        if material not in self.materials:
            raise ValueError(f"body '{name}' is of '{material}', which is no material of the drawing")
        if joint is None and self.bodies:
            raise ValueError(f"body '{name}' is a second root")
        if joint and joint.name in (other.name for other in self.joints):
            raise ValueError(f"there are two joints '{joint.name}'")
        if joint and joint.parent not in self.bodies:
            raise ValueError(f"joint '{joint.name}' hangs from '{joint.parent}', which is not drawn yet")
        self.bodies[name] = Body(name, joint, shapes, contacts, material, solid)

    def close(self, name: str, type: Literal["3d", "6d"], body_a: str, body_b: str, at: Vector3) -> None:  # noqa: A002
        """Closes a loop: holds two bodies together at a point of the world (m).

        Raises:
            ValueError: If a body is not drawn.
        """
        self._add(Closure(name, type, (body_a, body_b), (at, at)))

    def hinge(self, name: str, body_a: str, body_b: str, at: Vector3, axis: Vector3) -> None:
        """Closes a loop by a pin at a point of the world (m) about an axis of the world.

        Raises:
            ValueError: If a body is not drawn.
        """
        self._add(Closure(name, "hinge", (body_a, body_b), (at, at), axis))

    def distance(self, name: str, start: tuple[str, Vector3], end: tuple[str, Vector3]) -> None:
        """Keeps two points of the world (m), each on a body, at the distance at which they are drawn.

        Raises:
            ValueError: If a body is not drawn.
        """
        self._add(Closure(name, "distance", (start[0], end[0]), (start[1], end[1])))

    def couple(self, name: str, **joints: float) -> None:
        """Couples joints by their coefficients. As drawn, every coordinate is 0, so the products add up to 0.

        Raises:
            ValueError: If a joint is not drawn.
        """
        self._require_joints(f"coupling '{name}'", joints)
        self.couplings.append(Coupling(name, joints))

    def frame(self, name: str, body: str, at: Vector3, rpy: Vector3 = (0.0, 0.0, 0.0)) -> None:
        """Names a frame of a body, at a point of the world (m), with a roll, pitch and yaw in the world (rad).

        Raises:
            ValueError: If the body is not drawn.
        """
        if body not in self.bodies:
            raise ValueError(f"frame '{name}' is on '{body}', which is not drawn")
        self.frames.append(Frame(name, body, at, rpy))

    def configure(self, name: str, **joints: Coordinates) -> None:
        """Names a configuration by the coordinates of joints, seen from the drawn pose (rad, m; quaternion x y z w).

        Raises:
            ValueError: If a joint is not drawn.
        """
        self._require_joints(f"configuration '{name}'", joints)
        self.configurations[name] = joints

    def _require_joints(self, what: str, joints: Iterable[str]) -> None:
        drawn = {joint.name for joint in self.joints}
        for joint in joints:
            if joint not in drawn:
                raise ValueError(f"{what} is of '{joint}', which is not drawn")

    def _add(self, closure: Closure) -> None:
        for body in closure.bodies:
            if body not in self.bodies:
                raise ValueError(f"closure '{closure.name}' is on '{body}', which is not drawn")
        self.closures.append(closure)

    def rod(
        self,
        name: str,
        start: tuple[str, Vector3],
        end: tuple[str, Vector3],
        *,
        radius: float,
        mass: float,
        material: str,
        ends: tuple[End, End] = ("ball", "ball"),
    ) -> None:
        """Draws a rod between two bodies, and closes the loop through it.

        With a joint at each end it is cut in the middle, and the halves are held together by a 6d closure. A rod that
        ends in a point is whole: it hangs from the joint at its start, and a 3d closure holds its end.

        Args:
            name: Of the closure, and of a whole rod. The halves of a cut one are ``name_start`` and ``name_end``. The
                joints are called by what they are: ``ball_name_start``, ``universal_name_end``, ``ball_name``.
            start: Body at one end, and the centre of the joint in the world, m.
            end: Likewise at the other.
            radius: m; the heads are spheres of twice that radius.
            mass: Of the whole rod, kg; each head has an eighth of it.
            material: Name of its colour.
            ends: What it has at its ends. The axes of a universal joint lie across the rod, the first one level, so
                that it cannot spin.

        Raises:
            ValueError: If it starts in a point, or something of that name is drawn.
        """
        if ends[0] == "point":
            raise ValueError(f"rod '{name}' starts in a point: it hangs from nothing")
        if ends[1] == "point":
            heads = (Sphere(start[1], 2.0 * radius, mass * 0.125), Sphere(end[1], 2.0 * radius, mass * 0.125))
            shaft = Cylinder(start[1], end[1], radius, mass * 0.75)
            self.body(name, _rod_joint(ends[0], name, start, end[1]), shaft, *heads, material=material)
            self.close(name, "3d", name, end[0], end[1])
            return
        middle = midpoint(start[1], end[1])
        for side, kind, (parent, at) in (("start", ends[0], start), ("end", ends[1], end)):
            half = f"{name}_{side}"
            shaft = Cylinder(at, middle, radius, mass * 0.375)
            head = Sphere(at, 2.0 * radius, mass * 0.125)
            self.body(half, _rod_joint(kind, half, (parent, at), middle), shaft, head, material=material)
        self.close(name, "6d", f"{name}_start", f"{name}_end", middle)

    def mirror(self, side: str, other: str) -> None:
        """Draws once more, mirrored in the plane y = 0, all that has ``side`` in its name, with ``other`` in its place.

        Configurations are not mirrored. Where a joint and its mirror image have the same coordinate (a
        quaternion: with x and z negated), what they carry is mirrored too.

        Args:
            side: Part of the names of the bodies, joints and closures to be mirrored: ``left``.
            other: What replaces it in the names of the mirror images: ``right``.

        Raises:
            ValueError: If something hangs from, holds or is on a body of that side but is not named so.
        """

        def renamed(name: str) -> str:
            return name.replace(side, other)

        for body in list(self.bodies.values()):
            of_side = side in body.name
            if body.joint and (side in body.joint.name) != of_side:
                raise ValueError(f"of body '{body.name}' and joint '{body.joint.name}', one is named '{side}' only")
            if body.joint and side in body.joint.parent and not of_side:
                raise ValueError(f"body '{body.name}' hangs from '{body.joint.parent}' but is not named '{side}'")
            if of_side:
                joint = mirrored_joint(body.joint, renamed) if body.joint else None
                contacts = tuple(map(mirrored_shape, body.contacts))
                shapes = map(mirrored_shape, body.shapes)
                solid = body.solid and mirrored_solid(body.solid)
                name = renamed(body.name)
                self.body(name, joint, *shapes, material=body.material, contacts=contacts, solid=solid)
        for closure in list(self.closures):
            a, b = closure.bodies
            if side in closure.name:
                first, second = map(mirrored_vector, closure.points)
                axis = closure.axis and mirrored_vector(closure.axis)
                ends = renamed(a), renamed(b)
                self._add(Closure(renamed(closure.name), closure.type, ends, (first, second), axis))
            elif side in a or side in b:
                raise ValueError(f"closure '{closure.name}' holds '{a}' and '{b}' but is not named '{side}'")
        for coupling in list(self.couplings):
            if side in coupling.name:
                joints = {renamed(joint): factor for joint, factor in coupling.joints.items()}
                self.couplings.append(Coupling(renamed(coupling.name), joints))
        for frame in list(self.frames):
            if side in frame.name:
                self.frame(
                    renamed(frame.name), renamed(frame.body), mirrored_vector(frame.at), mirrored_turn(frame.rpy)
                )
            elif side in frame.body:
                raise ValueError(f"frame '{frame.name}' is on '{frame.body}' but is not named '{side}'")


def _rod_joint(kind: End, rod: str, start: tuple[str, Vector3], toward: Vector3) -> Joint:
    """The joint at an end of a rod that runs from there toward a point."""
    parent, at = start
    if kind == "ball":
        return ball(f"ball_{rod}", parent, at)
    along = unit((toward[0] - at[0], toward[1] - at[1], toward[2] - at[2]))
    upright = abs(along[2]) > 1.0 - 1e-9
    level = (1.0, 0.0, 0.0) if upright else unit((-along[1], along[0], 0.0))
    return universal(f"universal_{rod}", parent, at, level, cross(along, level))
