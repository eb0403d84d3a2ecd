"""A robot drawn in one assembled pose, in world coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from robots.builder.joint import Joint, ball
from robots.builder.shape import Cylinder, Shape, Sphere, Vector3, midpoint

Color = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Body:
    """A body.

    Attributes:
        name: Unique among bodies.
        joint: The joint that carries it; None for the root.
        shapes: What it is made of.
        contacts: Those of its shapes that may touch other things.
        material: Name of its colour.
    """

    name: str
    joint: Joint | None
    shapes: tuple[Shape, ...]
    contacts: tuple[Shape, ...]
    material: str

    @property
    def origin(self) -> Vector3:
        """Origin of its frame in the world, m: its joint; for the root, the world's own origin."""
        return self.joint.at if self.joint else (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Closure:
    """A loop closure: at one point of the drawing, two bodies are held together.

    Attributes:
        name: Unique among closures.
        type: ``3d`` holds the point, ``6d`` the orientation too.
        bodies: The two bodies, A and B.
        at: The point in the world, m.
    """

    name: str
    type: Literal["3d", "6d"]
    bodies: tuple[str, str]
    at: Vector3

    @property
    def frames(self) -> tuple[str, str]:
        """Names of the two frames, on A and on B."""
        return (f"{self.name}_a", f"{self.name}_b")


class Drawing:
    """A robot as it is drawn: bodies, each with the joint that carries it, and closures.

    Attributes:
        name: Name of the robot.
        materials: Colours by name: red, green, blue, alpha from 0 to 1.
        metadata: What the description says of itself.
        bodies: By name; parents before their children.
        closures: In the order drawn.
    """

    def __init__(self, name: str, materials: Mapping[str, Color], metadata: Mapping[str, str]) -> None:
        self.name = name
        self.materials = materials
        self.metadata = metadata
        self.bodies: dict[str, Body] = {}
        self.closures: list[Closure] = []

    @property
    def joints(self) -> list[Joint]:
        """The joints, parents before their children."""
        return [body.joint for body in self.bodies.values() if body.joint]

    def body(
        self, name: str, joint: Joint | None, *shapes: Shape, material: str, contacts: tuple[Shape, ...] = ()
    ) -> None:
        """Draws a body and the joint that carries it (None for the root, which comes first).

        Args:
            name: Unique among the bodies.
            joint: The joint that carries it.
            shapes: What it is made of.
            material: Name of its colour.
            contacts: Those of its shapes that may touch other things.

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
        self.bodies[name] = Body(name, joint, shapes, contacts, material)

    def close(self, name: str, type: Literal["3d", "6d"], body_a: str, body_b: str, at: Vector3) -> None:  # noqa: A002
        """Closes a loop: holds two bodies together at a point of the world (m).

        Raises:
            ValueError: If a body is not drawn.
        """
        for body in (body_a, body_b):
            if body not in self.bodies:
                raise ValueError(f"closure '{name}' is on '{body}', which is not drawn")
        self.closures.append(Closure(name, type, (body_a, body_b), at))

    def rod(
        self,
        name: str,
        start: tuple[str, Vector3],
        end: tuple[str, Vector3],
        *,
        radius: float,
        mass: float,
        material: str,
    ) -> None:
        """Draws a rod with a ball joint at each end: cut in the middle, and the halves held together by a 6d closure.

        Args:
            name: The halves are ``name_start`` and ``name_end``, their balls ``ball_name_start`` and ``ball_name_end``,
                the closure ``name``.
            start: Body at one end, and the centre of the ball in the world, m.
            end: Likewise at the other.
            radius: m; the heads are spheres of twice that radius.
            mass: Of the whole rod, kg; each head has an eighth of it.
            material: Name of its colour.
        """
        middle = midpoint(start[1], end[1])
        for side, (parent, at) in (("start", start), ("end", end)):
            self.body(
                f"{name}_{side}",
                ball(f"ball_{name}_{side}", parent, at),
                Cylinder(at, middle, radius, mass * 0.375),
                Sphere(at, 2.0 * radius, mass * 0.125),
                material=material,
            )
        self.close(name, "6d", f"{name}_start", f"{name}_end", middle)
