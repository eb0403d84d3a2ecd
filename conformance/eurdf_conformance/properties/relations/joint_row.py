"""A joint with several velocities, or with a pitch, as a row of prismatic and revolute joints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from eurdf_conformance.properties.mechanism import Change, Coordinates, Joint, Mechanism, Mimic, Vector
from eurdf_conformance.properties.placement import Matrix, rotation_of

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_AXES = {"x": X, "y": Y, "z": Z}

#: What becomes a row.
KINDS = frozenset({"universal", "cylindrical", "helical", "planar", "floating"})

Part = tuple[str, Literal["prismatic", "continuous"], Vector | None]


@dataclass(frozen=True)
class JointRow:
    """Joints in a row; the last one has the name of the joint that they replace.

    Attributes:
        parts: For each its name, type and axis.
        coordinates: From those of the joint, those of each part that has some.
        velocities: From the coordinates of the joint, the matrix that takes its velocities to those of the parts.
        change: What the description makes of the last one.
        mimic: What the first one follows.
    """

    parts: tuple[Part, ...]
    coordinates: Callable[[Coordinates], list[Coordinates]]
    velocities: Callable[[Coordinates], Matrix]
    change: Change | None = None
    mimic: Mimic | None = None

    @property
    def movers(self) -> list[str]:
        """The parts that have coordinates of their own."""
        names = [name for name, _, _ in self.parts]
        return names[1:] if self.mimic else names


def row_of(mechanism: Mechanism, joint: Joint) -> JointRow | None:
    """The row for a joint of the URDF, if it can be replaced by one."""
    name, axis = joint.name, joint.axis or X
    change = mechanism.changes.get(name, Change())
    one, two, three = (f"{name} part {i}" for i in range(3))
    match mechanism.type_of(joint):
        case "universal":
            first, second = (_AXES[each] if isinstance(each, str) else each for each in change.axes or ())
            parts: tuple[Part, ...] = (one, "continuous", first), (name, "continuous", second)
            return JointRow(parts, lambda q: [q[:1], q[1:]], lambda q: np.eye(2))
        case "cylindrical":
            parts = (one, "prismatic", axis), (name, "continuous", axis)
            return JointRow(parts, lambda q: [q[:1], q[1:]], lambda q: np.eye(2))
        case "helical":
            parts = (one, "prismatic", axis), (name, "continuous", axis)
            advance = Mimic(joint=name, multiplier=(change.pitch or 0.0) / (2.0 * np.pi))
            return JointRow(parts, lambda q: [q], lambda q: np.eye(1), mimic=advance)
        case "planar":
            parts = (one, "prismatic", X), (two, "prismatic", Y), (name, "continuous", Z)
            return JointRow(parts, lambda q: [q[:1], q[1:2], q[2:]], lambda q: _turned(_about_z(q[2]), 2))
        case "floating":
            parts = (one, "prismatic", X), (two, "prismatic", Y), (three, "prismatic", Z), (name, "continuous", None)
            return JointRow(
                parts,
                lambda q: [q[:1], q[1:2], q[2:3], q[3:]],
                lambda q: _turned(rotation_of(q[3:]), 3),
                change=Change(type="spherical"),
            )
    return None


def _about_z(angle: float) -> Matrix:
    return rotation_of((0.0, 0.0, float(np.sin(angle / 2.0)), float(np.cos(angle / 2.0))))


def _turned(R: Matrix, lengths: int) -> Matrix:
    """A joint sees how it slides from the child's frame, and its row from the frame that it hangs from."""
    J = np.eye(3 if lengths == 2 else 6)
    J[:lengths, :lengths] = R[:lengths, :lengths]
    return J
