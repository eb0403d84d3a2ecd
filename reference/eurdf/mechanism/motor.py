"""The motors of actuated joints."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Motor:
    """What a description states of a motor beside its gear, which is a property of the joint.

    Attributes:
        name: Name of the actuator.
        control: Smallest and largest torque (N·m) or force (N) at each velocity of the joint, or None.
    """

    name: str
    control: tuple[float, float] | None = None
