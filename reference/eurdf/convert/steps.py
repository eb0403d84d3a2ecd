"""A joint as joints of a format that lacks its type."""

from __future__ import annotations

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.pose import direction

#: Largest cosine of the axes of a universal joint that are perpendicular but for rounding.
_SKEW = 1e-9


def is_skew(joint: Joint) -> bool:
    """Whether the axes of a universal joint are not perpendicular."""
    (ax, ay, az), (bx, by, bz) = map(direction, joint.axes)
    return abs(ax * bx + ay * by + az * bz) > _SKEW
