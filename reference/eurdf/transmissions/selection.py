"""The joints and motors of a transmission: their names, their velocities, and their positions in a configuration."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Indices, Mask, Vector
from eurdf.kinematics.named import unknown_joint
from eurdf.pinocchio.arguments import as_names

if TYPE_CHECKING:
    from eurdf.pinocchio.configuration import Slot
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """Some joints of a robot: a number for each of their n velocities, joint by joint.

    The arrays are read-only, as a selection is kept with the robot.

    Attributes:
        joints: Their names.
        names: A name for each velocity: that of the joint; with several velocities ``joint[0]``, ``joint[1]``.
        units: Unit (n,) of each position.
        velocities: Indices (n,) in v.
        coordinates: Indices (n,) in q: of the number, or of the cosine of a (cos, sin) pair.
        circular: Which of them (n,) are angles whose whole turns change nothing: (cos, sin) pairs in q.
    """

    joints: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[Literal["m", "rad"], ...]
    velocities: Indices
    coordinates: Indices
    circular: Mask

    def __post_init__(self) -> None:
        for indices in (self.velocities, self.coordinates, self.circular):
            indices.flags.writeable = False

    def __len__(self) -> int:
        return len(self.names)

    def read(self, q: Vector) -> Vector:
        """The positions (…, n) at q (…, nq), rad or m; an angle of a pair is from -pi to pi."""
        at = q[..., self.coordinates]
        if not self.circular.any():
            return at
        return np.where(self.circular, np.arctan2(q[..., np.where(self.circular, self.coordinates + 1, 0)], at), at)

    def write(self, positions: Vector, q: Vector) -> None:
        """Change q (nq,) so that the joints are at the positions (n,)."""
        if not self.circular.any():
            q[self.coordinates] = positions
            return
        q[self.coordinates] = np.where(self.circular, np.cos(positions), positions)
        q[self.coordinates[self.circular] + 1] = np.sin(positions[self.circular])

    def nearest(self, positions: Vector, to: Vector) -> Vector:
        """The positions (…, n), with angles whose whole turns change nothing as near as possible to others (…, n)."""
        if not self.circular.any():
            return positions
        turns = np.round((positions - to) / (2.0 * np.pi))
        return np.where(self.circular, positions - 2.0 * np.pi * turns, positions)


def selection(robot: Robot, joints: str | Iterable[str], argument: str = "joints") -> Selection:
    """The joints with these names.

    Args:
        robot: The robot.
        joints: Names of joints, at least one.
        argument: What they were given as.

    Raises:
        ValueError: A name is unknown or given twice, or its joint has no coordinate of its own whose rate is its
            velocity.
    """
    given = as_names(joints)
    if not given:
        raise ValueError(f"{argument} is empty; name at least one joint")
    twice = next((name for name in given if given.count(name) > 1), None)
    if twice is not None:
        raise ValueError(f"{argument} names '{twice}' twice")
    each = [(name, slot, k) for name in given for slot in [_slot(robot, name)] for k in range(slot.nv)]
    return Selection(
        given,
        tuple(name if slot.nv == 1 else f"{name}[{k}]" for name, slot, k in each),
        tuple("m" if slot.joint.type.coordinates[k] == "length" else "rad" for _, slot, k in each),
        np.array([slot.idx_v + k for _, slot, k in each], np.intp),
        np.array([slot.idx_q + k for _, slot, k in each], np.intp),
        np.array([slot.nq > slot.nv for _, slot, _ in each]),
    )


def selectable(robot: Robot) -> list[tuple[str, Slot]]:
    """The joints that `selection` accepts."""
    return [(name, slot) for name, slot in robot.slots.items() if not slot.joint.type.moving_frame]


def listed(names: Iterable[str]) -> str:
    """Names in a message."""
    return ", ".join(f"'{name}'" for name in names)


def _slot(robot: Robot, name: str) -> Slot:
    slot = robot.slots.get(name)
    if slot is not None:
        if not slot.joint.type.moving_frame:
            return slot
        kind = slot.joint.type.value
        raise ValueError(f"joint '{name}' is {kind}; a transmission is between joints whose coordinates have rates")
    raise unknown_joint(robot, name)
