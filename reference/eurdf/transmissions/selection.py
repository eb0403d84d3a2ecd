"""The joints and motors of a transmission: their names, and their velocities."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices
from eurdf.kinematics.named import unknown_joint
from eurdf.pinocchio.arguments import as_names

if TYPE_CHECKING:
    from eurdf.pinocchio.configuration import Slot
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class Selection:
    """Some joints of a robot.

    Attributes:
        joints: Their names.
        velocities: Indices (n,) in v of their velocities, joint by joint.
        names: A name for each velocity: that of the joint; with several velocities ``joint[0]``, ``joint[1]``.

    The indices are read-only, as a selection is kept with the robot.
    """

    joints: tuple[str, ...]
    velocities: Indices
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        self.velocities.flags.writeable = False

    def __len__(self) -> int:
        return len(self.names)


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
    return _selected(given, [_slot(robot, name) for name in given])


def selectable(robot: Robot) -> list[tuple[str, Slot]]:
    """The joints that `selection` accepts."""
    return [(name, slot) for name, slot in robot.slots.items() if not slot.joint.type.moving_frame]


def _selected(names: Sequence[str], slots: Sequence[Slot]) -> Selection:
    velocities = [slot.idx_v + k for slot in slots for k in range(slot.nv)]
    labels = [
        name if slot.nv == 1 else f"{name}[{k}]"
        for name, slot in zip(names, slots, strict=True)
        for k in range(slot.nv)
    ]
    return Selection(tuple(names), np.array(velocities, np.intp), tuple(labels))


def _slot(robot: Robot, name: str) -> Slot:
    slot = robot.slots.get(name)
    if slot is not None:
        if not slot.joint.type.moving_frame:
            return slot
        kind = slot.joint.type.value
        raise ValueError(f"joint '{name}' is {kind}; a transmission is between joints whose coordinates have rates")
    raise unknown_joint(robot, name)
