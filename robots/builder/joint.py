"""Joints of a drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from robots.builder.shape import Vector3


@dataclass(frozen=True, slots=True)
class Motor:
    """What drives a joint.

    Attributes:
        effort: Largest torque at the joint, N·m.
        velocity: Largest velocity of the joint, rad/s.
        damping: N·m·s/rad.
        friction: N·m.
    """

    effort: float
    velocity: float
    damping: float = 0.0
    friction: float = 0.0


#: Of a joint that nothing drives; the velocity is there because URDF asks for one wherever there are stops.
PASSIVE = Motor(effort=0.0, velocity=20.0)


@dataclass(frozen=True, slots=True)
class Joint:
    """A joint, in the drawn pose, in world coordinates.

    Attributes:
        name: Unique among the joints.
        type: What the joint is. A spherical one stands in the URDF as a continuous one about ``axis``.
        parent: Body that it hangs the next one from.
        at: Its centre, m.
        axis: Unit vector.
        stops: Lowest and highest angle, rad, seen from the drawn pose; None where nothing stops it.
        motor: What drives it; None if nothing does.
    """

    name: str
    type: Literal["revolute", "spherical"]
    parent: str
    at: Vector3
    axis: Vector3
    stops: tuple[float, float] | None = None
    motor: Motor | None = None


def revolute(
    name: str,
    parent: str,
    at: Vector3,
    axis: Vector3,
    *,
    degrees: tuple[float, float] | None = None,
    drawn: float = 0.0,
    motor: Motor | None = None,
) -> Joint:
    """A revolute joint.

    Args:
        name: Unique among the joints.
        parent: Body that it hangs the next one from.
        at: Its centre in the world, m.
        axis: Its axis in the world; any length.
        degrees: Lowest and highest angle on the maker's scale, degrees; None where nothing stops it.
        drawn: Angle of the drawn pose on that scale, degrees.
        motor: What drives it.
    """
    stops = degrees and (round(math.radians(degrees[0] - drawn), 4), round(math.radians(degrees[1] - drawn), 4))
    length = math.hypot(*axis)
    unit = (axis[0] / length, axis[1] / length, axis[2] / length)
    return Joint(name, "revolute", parent, at, unit, stops, motor)


def ball(name: str, parent: str, at: Vector3) -> Joint:
    """A ball joint that nothing drives and nothing stops, at a point of the world (m)."""
    return Joint(name, "spherical", parent, at, (0.0, 0.0, 1.0))
