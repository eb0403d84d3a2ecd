"""Frames fixed to bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from eurdf.mechanism.pose import IDENTITY, Pose


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


@dataclass(frozen=True, slots=True)
class Anchor:
    """One side of a closure.

    Attributes:
        body: Body it is fixed to.
        pose: Pose in that body's frame.
        frame: Name the description gives it; empty for a pose written in place.
    """

    body: str
    pose: Pose = IDENTITY
    frame: str = ""
