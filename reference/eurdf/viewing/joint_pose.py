"""The coordinates that sliders have of a planar, spherical or floating joint, and the motions that change them.

The velocities of these joints are in the child's frame, so none of them is the rate of one coordinate. Positions are in
the joint's own frame, m; a planar joint has an angle, the others the rotation vector: the axis times the angle, rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.closures.se3 import quaternion_log
from eurdf.mechanism.joint_types import JointType

#: Names of the coordinates of a rotation.
ROTATION = ("rotation x", "rotation y", "rotation z")

#: Names of the coordinates of each type.
NAMES: dict[JointType, tuple[str, ...]] = {
    kind: (
        *(name if name == "angle" else f"position {name}" for name in kind.coordinates[: kind.quaternion]),
        *(() if kind.quaternion is None else ROTATION),
    )
    for kind in JointType
    if kind.moving_frame
}

#: Length of the longest rotation vector, rad: at half a turn it has two directions.
LONGEST = math.pi * (1.0 - 1e-6)

# Rounding makes motions of this size, m or rad, which are left out.
_NONE = 1e-9


def values_at(kind: JointType, q: Vector) -> Vector:
    """The coordinates (n,).

    Args:
        kind: Type of the joint.
        q: Its coordinates as Pinocchio has them.
    """
    if kind.quaternion is None:
        x, y, cosine, sine = q
        return np.array((x, y, math.atan2(sine, cosine)))
    return np.concatenate((q[:-4], quaternion_log(np.asarray(q[-4:]))))


def motions(kind: JointType, here: Vector, there: Vector) -> Iterator[tuple[int, float]]:
    """Motions of one velocity each that lead, one after the other, from some coordinates (n,) to others, to 1e-9.

    A rotation is one about the x, one about the y and one about the z axis of the child.

    Yields:
        The number of the velocity in the joint, and how far to move it, m or rad.
    """
    if kind.quaternion is None:
        cosine, sine = math.cos(here[2]), math.sin(here[2])
        x, y, angle = there - here
        found = [cosine * x + sine * y, cosine * y - sine * x, math.remainder(angle, 2.0 * math.pi)]
    else:
        before, after = pin.exp3(here[-3:]), pin.exp3(there[-3:])
        shift = before.T @ (there - here)[:3] if kind.slides else ()
        found = [*shift, *_angles(before.T @ after)]
    yield from ((number, float(amount)) for number, amount in enumerate(found) if abs(amount) > _NONE)


def _angles(R: Matrix) -> tuple[float, float, float]:
    """The angles of R = Rx Ry Rz, less than half a turn from the identity."""
    return (
        math.atan2(-R[1, 2], R[2, 2]),
        math.atan2(R[0, 2], math.hypot(R[0, 0], R[0, 1])),
        math.atan2(-R[0, 1], R[0, 0]),
    )
