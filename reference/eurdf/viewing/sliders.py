"""The coordinates that the user moves: those of joints, and those of the poses of planar, spherical and floating ones.

The velocities of these three are in the child's frame, so none of them is the rate of one coordinate. Positions are in
the joint's own frame, m; a planar joint has an angle, the others the rotation vector: the axis times the angle, rad.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.closures.se3 import quaternion_log
from eurdf.kinematics.analysis import Analysis
from eurdf.kinematics.position_limit import driven_coordinates, position_limits
from eurdf.kinematics.scale import characteristic_length
from eurdf.mechanism.joint_types import JointType

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

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


@dataclass(frozen=True, slots=True)
class Slider:
    """A coordinate that the user moves.

    Attributes:
        joint: Name of the joint.
        label: Name of the joint, and of the coordinate if it has several.
        unit: ``rad`` or ``m``.
        lower: Least value: the position limit; without one, half a turn or a characteristic length from the start.
        upper: Greatest value.
        number: Which of the joint's coordinates it is; of a planar, spherical or floating one, of its pose.
        velocity: Index in v of the velocity that drives it; None if it is of a pose, which several velocities drive.
        actuated: Whether the joint is actuated.
        follow: Names of the dependent actuators that follow, as the loops do not let this one move alone.
    """

    joint: str
    label: str
    unit: Literal["rad", "m"]
    lower: float
    upper: float
    number: int
    velocity: int | None
    actuated: bool
    follow: tuple[str, ...] = ()


def sliders_of(robot: Robot, q: Vector, analysis: Analysis) -> Iterator[Slider]:
    """The sliders of a robot that starts at q (nq,): of its actuators, or of all joints if there are none."""
    tree, limits = robot.tree, position_limits(robot)
    length = characteristic_length(robot)
    driven, coordinates = robot.cached(driven_coordinates)
    for name in robot.actuation.joints or robot.slots:
        slot, actuated = robot.slots[name], name in robot.actuation.joints
        kind = slot.joint.type
        if kind in NAMES and robot.constraints and not actuated:
            continue  # the velocities of a joint that is not actuated are not held, so its pose is not either
        dependent = [each for each in analysis.dependent_actuators if name in each]
        follow = tuple(other for each in dependent for other in each if other != name)
        for number, word in enumerate(NAMES.get(kind, ())):
            is_position = word.startswith("position")
            at = float(values_at(kind, q[slot.idx_q : slot.idx_q + slot.nq])[number]) if is_position else 0.0
            around = length if is_position else math.pi
            unit: Literal["rad", "m"] = "m" if is_position else "rad"
            yield Slider(name, f"{name} {word}", unit, at - around, at + around, number, None, actuated, follow)
        if kind in NAMES:
            continue
        turns = kind.is_axial and not kind.limited
        for number, velocity in enumerate(tree.velocities_of(name)):
            word = kind.coordinates[number]
            unit, around = ("m", length) if word == "length" else ("rad", math.pi)
            at = float(q[coordinates[velocity]]) if velocity in driven else 0.0
            lower, upper = float(limits.lower[velocity]), float(limits.upper[velocity])
            lower = min(lower, at) if math.isfinite(lower) else at - around
            upper = max(upper, at) if math.isfinite(upper) else at + around
            if turns:
                lower, upper = -math.pi, math.pi
            several = f" {number + 1} ({word})" if slot.nv > 1 else ""
            yield Slider(name, f"{name}{several}", unit, lower, upper, number, velocity, actuated, follow)


def values_at(kind: JointType, q: Vector) -> Vector:
    """The coordinates (n,) of the pose of a joint of a type, whose coordinates as Pinocchio has them are q."""
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
