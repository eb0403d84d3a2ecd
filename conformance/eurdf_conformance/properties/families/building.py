"""Builds a mechanism from the poses of its frames in the world; joints and closures follow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from eurdf_conformance.oracle.spatial import unit
from eurdf_conformance.oracle.transform import transform
from eurdf_conformance.properties.example import Example
from eurdf_conformance.properties.mechanism import (
    Actuator,
    Change,
    Closure,
    Coordinates,
    Inertia,
    Joint,
    Limit,
    Link,
    Mechanism,
    Pose,
    Spot,
    Vector,
)
from eurdf_conformance.properties.placement import Matrix, inverse, matrix_of, pose_of

#: The pose of a whole family: along no axis of the world.
ASKEW = Pose(xyz=(0.1, -0.2, 0.3), rpy=(0.4, -0.5, 0.6))

_WIDE = Limit(effort=10.0, velocity=10.0, lower=-6.0, upper=6.0)
_BRICK = Inertia(mass=1.0, pose=Pose(xyz=(0.02, 0.01, 0.03)), moments=(0.02, 0.001, 0.0, 0.03, 0.0, 0.025))
_Kind = Literal["revolute", "prismatic", "spherical", "universal"]


class Building:
    """A mechanism that starts from the link `ground`."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._frames = {"ground": np.eye(4)}
        self._links = [Link(name="ground")]
        self._joints: list[Joint] = []
        self._changes: dict[str, Change] = {}
        self._closures: list[Closure] = []
        self._motors: list[Actuator] = []
        self._q: dict[str, Coordinates] = {}

    def joint(
        self,
        kind: _Kind,
        parent: str,
        link: str,
        where: Matrix,
        q: Coordinates,
        axis: Vector = (0.0, 0.0, 1.0),
        *,
        motor: bool = False,
    ) -> None:
        """Add a link and its joint, which is named after the link with `_joint` appended.

        Args:
            kind: Type of the joint; a universal one turns about its x and then its y.
            parent: The link that it hangs from.
            link: The link.
            where: Its pose where the mechanism is assembled, with the whole not yet askew.
            q: The joint's coordinates there.
            axis: Of the joint, in its own frame.
            motor: Whether it is actuated.
        """
        name = f"{link}_joint"
        axes = np.eye(3)[:2] if kind == "universal" else unit(np.array(axis))[None, :]
        self._frames[link] = matrix_of(ASKEW) @ where
        jMc = transform(kind, axes, 0.0, np.array(q))
        origin = inverse(self._frames[parent]) @ self._frames[link] @ inverse(jMc)
        written: Any = "prismatic" if kind == "prismatic" else "revolute"
        self._joints.append(
            Joint(name=name, type=written, parent=parent, child=link, origin=pose_of(origin), axis=axis, limit=_WIDE)
        )
        self._links.append(Link(name=link, inertia=_BRICK))
        if kind in ("spherical", "universal"):
            self._changes[name] = Change(type=kind, axes="xy" if kind == "universal" else None)
        self._motors += [Actuator(joint=name)] * motor
        self._q[name] = q

    def close(self, kind: Literal["3d", "6d"], a: str, b: str, where: Matrix) -> None:
        """Add a closure between a frame of one link and one of another, at a pose in the assembled mechanism."""
        M = matrix_of(ASKEW) @ where
        spots = [Spot(on="link", of=link, pose=pose_of(inverse(self._frames[link]) @ M)) for link in (a, b)]
        name = f"closure_{len(self._closures) + 1}"
        self._closures.append(Closure(name=name, type=kind, a=spots[0], b=spots[1]))

    def example(self, nv: int, rank: int, uncontrolled: int) -> Example:
        """The mechanism with its known counts."""
        mechanism = Mechanism(
            name=self._name,
            links=tuple(self._links),
            joints=tuple(self._joints),
            changes=self._changes,
            closures=tuple(self._closures),
            actuators=tuple(self._motors),
            configurations={"assembled": self._q},
        )
        nc = sum(3 if closure.type == "3d" else 6 for closure in self._closures)
        return Example(mechanism=mechanism, known=(nv, nc, rank, nv - rank, nc - rank, uncontrolled))


def at(p: Sequence[float] | Matrix, R: Matrix | None = None) -> Matrix:
    """The pose (R, p)."""
    M = np.eye(4)
    M[:3, 3] = p
    if R is not None:
        M[:3, :3] = R
    return M


def along(axis: Sequence[float] | Matrix) -> Matrix:
    """A rotation whose z is a direction."""
    z = unit(np.array(axis, dtype=float))
    x = unit(np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z))
    return np.array([x, np.cross(z, x), z]).T


def angle(i: int) -> float:
    """A nonzero angle for the i-th joint, rad."""
    return 0.3 + 0.2 * (i % 5) if i % 2 else -0.2 - 0.15 * (i % 4)
