"""The output of ``eurdf transmission --json``, and the ``transmission.json`` that ``eurdf serial`` writes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np

from eurdf.array import Matrix, Vector
from eurdf.json_schema import PAIRS, ROW, Count
from eurdf.pinocchio.robot import Robot
from eurdf.transmissions.inertia import reflected_inertia
from eurdf.transmissions.limits import CommonLimits, SerialLimits, serial_limits
from eurdf.transmissions.motors import linkage_bodies
from eurdf.transmissions.polynomial_map import PolynomialMap
from eurdf.transmissions.positions import beyond_limits
from eurdf.transmissions.selection import Selection
from eurdf.transmissions.serial_model import Choice, Neglected
from eurdf.transmissions.transmission import at_one

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True, slots=True)
class AxisInfo:
    """A joint or motor velocity."""

    name: str
    """Name of the joint; of one with several velocities, its number in brackets too."""
    unit: Literal["rad", "m"]
    """Unit of its position; velocities are per s, torques in N·m for rad, forces in N for m."""


@dataclass(frozen=True, slots=True)
class LimitsInfo:
    """What the limits of the motors leave to the joints, in the order of the joints."""

    torque: tuple[tuple[float, float], ...]
    """Smallest and largest torque or force of each joint while the others have none; not a box."""
    torque_box: tuple[float, ...]
    """Half sides of the largest box of torques around zero that the motors can produce."""
    velocity: tuple[tuple[float, float], ...]
    """Smallest and largest velocity of each joint while the others are still; not a box."""
    velocity_box: tuple[float, ...]
    """Half sides of the largest box of velocities around zero that the motors allow."""


@dataclass(frozen=True, slots=True)
class InertiaInfo:
    """Terms of the inertia that the joints feel, in kg·m², kg·m or kg."""

    LIKE: ClassVar = "eurdf.transmissions.inertia:ReflectedInertia"

    rotors: Rows
    linkage: Rows
    serial: Rows
    other_armature: Rows


@dataclass(frozen=True, slots=True)
class PoseInfo:
    """The transmission at one configuration."""

    LIKE: ClassVar = "eurdf.transmissions.transmission:Transmission"

    joints: tuple[float, ...]
    """Positions of the joints."""
    reached: bool
    """Whether the joints reach these positions within the position limits; if not, what follows is null or empty."""
    motors: tuple[float, ...] | None = None
    """Positions of the motors."""
    beyond: tuple[str, ...] = ()
    """Joints beyond their position limits there; none at the poses of a grid."""
    G: Rows | None = None
    B_J: Rows | None = None
    rank_motors: Count | None = None
    rank_joints: Count | None = None
    condition: float | None = None
    reason: str | None = None
    inverse_reason: str | None = None
    limits: LimitsInfo | None = None
    """Limits of the joints; null where there are none, see limits_reason of the robot."""
    inertia: InertiaInfo | None = None
    """The inertia that the joints feel; null if G does not exist."""


@dataclass(frozen=True, slots=True)
class TransmissionInfo:
    """The output of 'eurdf transmission --json'."""

    name: str
    """Name of the robot in the URDF."""
    joints: tuple[AxisInfo, ...]
    """The joints."""
    motors: tuple[AxisInfo, ...]
    """The motors that move them."""
    linkage: tuple[str, ...]
    """Links that the equivalent serial robot does not have."""
    limits_reason: str | None
    """Why limits of joints are missing, such as a motor without an effort limit, or null."""
    poses: tuple[PoseInfo, ...]
    """One configuration, or those of the grid, with the last joint first to change."""
    common: LimitsInfo | None
    """Limits that hold at all poses that are reached; null if there are none."""


def transmission_info(
    robot: Robot,
    joints: Selection,
    motors: Selection,
    configurations: Sequence[Vector | None],
    positions: Sequence[Sequence[float]],
    progress: Callable[[float, float], None] | None = None,
) -> TransmissionInfo:
    """A transmission as ``eurdf transmission`` shows it, at closed configurations (nq,) and positions of the joints.

    A configuration is None where the joints cannot be reached. What shows the progress is called after each pose.
    """
    reasons: list[str] = []
    poses: list[PoseInfo] = []
    for q, own in zip(configurations, positions, strict=True):
        poses.append(_pose(robot, joints, motors, q, own, reasons))
        if progress is not None:
            progress(len(poses), len(positions))
    inside = [q for q, pose in zip(configurations, poses, strict=True) if pose.limits is not None]
    return TransmissionInfo(
        name=robot.mechanism.name,
        joints=_axes(joints),
        motors=_axes(motors),
        linkage=linkage_bodies(robot, joints, motors),
        limits_reason=reasons[0] if reasons else None,
        poses=tuple(poses),
        common=_limits(serial_limits(robot, joints.joints, np.array(inside), motors=motors.joints)) if inside else None,
    )


def _pose(
    robot: Robot, joints: Selection, motors: Selection, q: Vector | None, positions: Sequence[float], reasons: list[str]
) -> PoseInfo:
    if q is None:
        return PoseInfo(tuple(positions), reached=False)
    at, coordinates = at_one(robot, joints, q, motors), robot.joint_positions(q)
    limits = inertia = None
    if at.G is not None and at.rank_joints == len(at.joints):
        if at.B_J is not None:
            try:
                limits = _limits(serial_limits(robot, joints.joints, q, motors=motors.joints))
            except ValueError as reason:  # a motor has no limits
                reasons.append(str(reason))
        terms = reflected_inertia(robot, joints.joints, q, motors=motors.joints)
        inertia = InertiaInfo(*map(_rows, (terms.rotors, terms.linkage, terms.serial, terms.other_armature)))
    return PoseInfo(
        joints=tuple(positions),
        reached=True,
        motors=tuple(value for name in motors.joints for value in coordinates[name]),
        beyond=beyond_limits(robot, q),
        G=None if at.G is None else _rows(at.G),
        B_J=None if at.B_J is None else _rows(at.B_J),
        rank_motors=at.rank_motors,
        rank_joints=at.rank_joints,
        condition=at.condition,
        reason=at.reason,
        inverse_reason=at.inverse_reason,
        limits=limits,
        inertia=inertia,
    )


def _limits(found: SerialLimits | CommonLimits) -> LimitsInfo:
    axes = [found.torque_axes, found.velocity_axes]
    if isinstance(found, CommonLimits):
        axes = [np.stack((each[..., 0].max(axis=0), each[..., 1].min(axis=0)), axis=-1) for each in axes]
    torque, velocity = (tuple((lower, upper) for lower, upper in each.tolist()) for each in axes)
    return LimitsInfo(torque, tuple(found.torque_box.tolist()), velocity, tuple(found.velocity_box.tolist()))


def _axes(chosen: Selection) -> tuple[AxisInfo, ...]:
    return tuple(map(AxisInfo, chosen.names, chosen.units))


def _rows(matrix: Matrix) -> Rows:
    return tuple(tuple(row) for row in matrix.tolist())


@dataclass(frozen=True, slots=True)
class SerialInfo:
    """The transmission.json that 'eurdf serial' writes."""

    LIKE: ClassVar = "eurdf.transmissions.serial_model:SerialTwin"

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    lumped: tuple[str, ...]
    """Bodies left out; their masses are lumped onto those that carry them."""
    lumped_at: dict[str, Annotated[Vector, ROW]]
    """Coordinates of the joints of the parallel robot at which they are lumped, as in files."""
    chosen: Choice
    position: Annotated[Matrix, PAIRS]
    torque: tuple[float | None, ...]
    velocity: tuple[float | None, ...]
    armature: Annotated[Vector, ROW]
    damping: Annotated[Vector, ROW]
    friction: Annotated[Vector, ROW]
    neglected: Neglected
    stops: dict[str, int]
    """Number of points at the edge of the workspace, by what ends the motion there."""
    map: PolynomialMap
    notes: tuple[str, ...]
