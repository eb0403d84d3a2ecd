"""Positions of the motors and of the serial joints in a configuration."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.kinematics.array import Indices, Mask, Vector
from eurdf.transmissions.selection import Selection

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class JointCoordinates:
    """Where the positions of selected joints are in q: one number for each of their n velocities.

    Attributes:
        of: The joints.
        units: Unit (n,) of each position.
        coordinates: Indices (n,) in q: of the number, or of the cosine of a (cos, sin) pair.
        circular: Which of them (n,) are angles whose whole turns change nothing: (cos, sin) pairs in q.
    """

    of: Selection
    units: tuple[Literal["m", "rad"], ...]
    coordinates: Indices
    circular: Mask

    def __len__(self) -> int:
        return len(self.of)

    def read(self, q: Vector) -> Vector:
        """The positions (n,) at q (nq,), rad or m; an angle of a pair is from -pi to pi."""
        at = q[self.coordinates]
        if not self.circular.any():
            return at
        return np.where(self.circular, np.arctan2(q[np.where(self.circular, self.coordinates + 1, 0)], at), at)

    def write(self, positions: Vector, q: Vector) -> None:
        """Change q (nq,) so that the joints are at the positions (n,)."""
        if not self.circular.any():
            q[self.coordinates] = positions
            return
        q[self.coordinates] = np.where(self.circular, np.cos(positions), positions)
        q[self.coordinates[self.circular] + 1] = np.sin(positions[self.circular])

    def nearest(self, positions: Vector, to: Vector) -> Vector:
        """The positions (n,), with angles whose whole turns change nothing as near as possible to others (n,)."""
        if not self.circular.any():
            return positions
        turns = np.round((positions - to) / (2.0 * np.pi))
        return np.where(self.circular, positions - 2.0 * np.pi * turns, positions)

    def by_joint(self, positions: Vector) -> dict[str, list[float]]:
        """The coordinates of each joint, as files state them."""
        found: dict[str, list[float]] = {}
        for name, value in zip(self.of.names, positions.tolist(), strict=True):
            found.setdefault(name.partition("[")[0], []).append(value)
        return found


def coordinates_of(robot: Robot, joints: Selection) -> JointCoordinates:
    """Where the positions of joints are in q."""
    units: list[Literal["m", "rad"]] = []
    coordinates: list[int] = []
    circular: list[bool] = []
    for name in joints.joints:
        slot = robot.slots[name]
        units += ["m" if of == "length" else "rad" for of in slot.joint.type.coordinates]
        coordinates += range(slot.idx_q, slot.idx_q + slot.nv)
        circular += [slot.nq > slot.nv] * slot.nv
    return JointCoordinates(joints, tuple(units), np.array(coordinates, np.intp), np.array(circular))
