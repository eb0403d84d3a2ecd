"""Actuators in version 2.1: those of version 2.0, with a name and the range of the motor's torque."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, Tag

from eurdf.format import version2
from eurdf.format.field import MayLack, MovingJointName, Number, StrictMapping, either
from eurdf.format.version2 import Name


class Added(StrictMapping):
    """What version 2.1 adds to an actuator."""

    name: MayLack[Name] = Field(
        default=None,
        title="Name",
        description="Name of the actuator, unique in the file; that of the joint if left out.",
        examples=["left_knee"],
    )
    control: MayLack[Annotated[list[Number], Field(min_length=2, max_length=2)]] = Field(
        default=None,
        title="Control range",
        description="Smallest and largest torque or force of the motor, at the joint, N·m or N.",
        examples=[[-80, 80]],
    )


#: Keys of an actuator that version 2.1 adds.
ADDED = tuple(Added.model_fields)


class Geared(version2.Geared, Added):
    """An actuated joint and its motor."""


Actuator = Annotated[
    Annotated[MovingJointName, Tag("by name")] | Annotated[Geared, Tag("geared actuator")],
    either(version2.actuator_form, "the name of a joint, or a mapping {joint: …, gear_ratio: …}"),
]
