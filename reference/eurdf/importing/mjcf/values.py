"""Values of a compiled model as those of a mechanism."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from eurdf.mechanism.pose import Pose, Quaternion, Vector3

#: Lengths (m), and parts of unit vectors, that differ by no more are equal.
SAME = 1e-9


def usable(name: str) -> str:
    """A name that a description can contain wherever it names something: ``x-`` begins user data there."""
    return f"_{name}" if name.startswith("x-") else name


def vector(values: Sequence[float]) -> Vector3:
    """Three numbers."""
    x, y, z = (float(value) for value in values)
    return x, y, z


class NoDirection(ValueError):  # noqa: N818 - named as the other refusals are
    """A quaternion or an axis has no direction, as MuJoCo makes of numbers that overflow."""


def must_have_direction(what: str, values: Sequence[float]) -> float:
    """The length of a quaternion or an axis.

    Raises:
        NoDirection: It is zero, or not finite.
    """
    length = math.hypot(*values)
    if not 0.0 < length < math.inf:
        shown = " ".join(f"{value:g}" for value in values)
        raise NoDirection(f"the {what} {shown}; its length must be finite, and not zero")
    return length


def xyzw(wxyz: Sequence[float]) -> Quaternion:
    """The unit quaternion x y z w along one of MuJoCo, w x y z.

    Raises:
        NoDirection: Its length is zero, or not finite.
    """
    norm = must_have_direction("quaternion", wxyz)
    w, x, y, z = (float(value) / norm for value in wxyz)
    return x, y, z, w


def pose_from(xyz: Sequence[float], wxyz: Sequence[float]) -> Pose:
    """The pose of a position, m, and a quaternion of MuJoCo."""
    return Pose(vector(xyz), xyzw(wxyz))


def cross(a: Vector3, b: Vector3) -> Vector3:
    """The vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a: Vector3, b: Vector3) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def row(rows: Sequence[Any], index: int) -> Sequence[float]:
    """A row of an array that a release of MuJoCo may not have."""
    return flat(rows[index]) if rows else ()


def flat(value: Any) -> Sequence[float]:
    """A number, or some, as a sequence."""
    return value if isinstance(value, list) else (value,)
