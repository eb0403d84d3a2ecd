"""Limits of joints that follow from those of their motors."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.pinocchio.arguments import checked_array
from eurdf.transmissions.box import box_along, largest_box
from eurdf.transmissions.exceptions import NoTransmission
from eurdf.transmissions.polytope import Polytope, image_of_box, preimage_of_box
from eurdf.transmissions.transmission import Transmission, Transmissions, transmission

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A configuration bounds a box if the box uses more than this part of one of its half-spaces.
_BOUNDS = 1.0 - 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class SerialLimits:
    """The limits of joints at one configuration, as `serial_limits` returns them.

    Torques are in N·m or N, velocities in rad/s or m/s. A box is symmetric: |xⱼ| ≤ boxⱼ for all joints at once.

    Attributes:
        joints: Names of the joints, nJ.
        motors: Names of the motors.
        torque: The torques that the motors can produce at the joints.
        velocity: The joint velocities at which no motor exceeds its limit.
        torque_box: Half sides (nJ,) of the largest box of torques.
        velocity_box: Half sides (nJ,) of the largest box of velocities.
        torque_axes: Smallest and largest torque (nJ, 2) of each joint while the others have none: not a box.
        velocity_axes: Smallest and largest velocity (nJ, 2) of each joint while the others are still: not a box.
    """

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    torque: Polytope
    velocity: Polytope
    torque_box: Vector
    velocity_box: Vector
    torque_axes: Matrix
    velocity_axes: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class CommonLimits:
    """The limits of joints at B configurations, as `serial_limits` returns them.

    The boxes hold at these configurations, and may not hold between them. `each` has what belongs to one of them.

    Attributes:
        joints: Names of the joints, nJ.
        motors: Names of the motors.
        torque_box: Half sides (nJ,) of the largest box of torques that the motors can produce at all configurations.
        velocity_box: Half sides (nJ,) of the largest box of velocities that the motors allow at all configurations.
        torque_axes: As in `SerialLimits`, (B, nJ, 2).
        velocity_axes: As in `SerialLimits`, (B, nJ, 2).
        torque_bounded_by: Indices of the configurations that bound ``torque_box``.
        velocity_bounded_by: Indices of the configurations that bound ``velocity_box``.
        each: The limits at each configuration.
    """

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    torque_box: Vector
    velocity_box: Vector
    torque_axes: Matrix
    velocity_axes: Matrix
    torque_bounded_by: Indices
    velocity_bounded_by: Indices
    each: tuple[SerialLimits, ...]


def serial_limits(
    robot: Robot,
    joints: str | Iterable[str],
    q: Vector | Matrix | None = None,
    motors: str | Iterable[str] | None = None,
    *,
    torque_ratio: ArrayLike | None = None,
    velocity_ratio: ArrayLike | None = None,
) -> SerialLimits | CommonLimits:
    """The torques and velocities of joints that the limits of their motors allow.

    The torques are the polytope {Gᵀ τ_m : τ_m within the effort limits and control ranges of the motors}, the
    velocities are {v_J : |G v_J| ≤ limits}. A serial robot has one limit for each joint, a box: the largest symmetric
    one inside has the largest product of its sides. The limits of the joints themselves play no part. Torques are
    static, without friction.

    Args:
        robot: The robot.
        joints: As in `transmission`.
        q: A closed configuration (nq,), or several (B, nq), for a box that holds at all of them. The default is the
            `assembled` configuration, or the neutral one if there is none.
        motors: As in `transmission`.
        torque_ratio: Ratio (nJ,) of the sides of the box of torques, positive, in place of the largest product.
        velocity_ratio: Ratio (nJ,) of the sides of the box of velocities.

    Raises:
        NoTransmission: At a configuration, G or B_J does not exist, or the joints depend on each other.
        NotClosable: The loops are open at q.
        ValueError: A motor has no limit, or cannot be without torque; or an argument is wrong, as in `transmission`.
    """
    at = transmission(robot, joints, q, motors)
    ratios = [
        _checked_ratio(name, ratio, len(at.joints))
        for name, ratio in (("torque_ratio", torque_ratio), ("velocity_ratio", velocity_ratio))
    ]
    index = range(len(at)) if isinstance(at, Transmissions) else (None,)
    maps = [_complete(at, each) for each in index]
    if isinstance(at, Transmissions) and not len(at):
        raise ValueError("q has no rows; give at least one configuration")
    ranges = _ranges(robot, at.motors, at.joints)
    found = [_limits(at.joints, at.motors, G, *ranges, *ratios) for G in maps]
    if isinstance(at, Transmission):
        return found[0]
    boxes, bounded = [], []
    for polytopes, ratio in zip(
        ([each.torque for each in found], [each.velocity for each in found]), ratios, strict=True
    ):
        A, b = np.vstack([each.A for each in polytopes]), np.concatenate([each.b for each in polytopes])
        box = _box(A, b, ratio)
        used = (np.abs(A) @ box / b).reshape(len(found), -1).max(axis=1)
        boxes.append(box)
        bounded.append(np.flatnonzero(used > _BOUNDS))
    return CommonLimits(
        at.joints,
        at.motors,
        boxes[0],
        boxes[1],
        np.array([each.torque_axes for each in found]),
        np.array([each.velocity_axes for each in found]),
        bounded[0],
        bounded[1],
        tuple(found),
    )


def _limits(
    joints: tuple[str, ...],
    motors: tuple[str, ...],
    G: Matrix,
    lower: Vector,
    upper: Vector,
    fastest: Vector,
    torque_ratio: Vector | None,
    velocity_ratio: Vector | None,
) -> SerialLimits:
    torque, velocity = image_of_box(G, lower, upper), preimage_of_box(G, fastest)
    boxes = _box(torque.A, torque.b, torque_ratio), _box(velocity.A, velocity.b, velocity_ratio)
    return SerialLimits(joints, motors, torque, velocity, *boxes, torque.axes, velocity.axes)


def _box(A: Matrix, b: Vector, ratio: Vector | None) -> Vector:
    return largest_box(A, b) if ratio is None else box_along(A, b, ratio)


def _complete(at: Transmission | Transmissions, index: int | None) -> Matrix:
    """G (nm, nJ) of a configuration, of rank nJ."""
    if isinstance(at, Transmissions):
        assert index is not None
        G, complete = at.G[index], bool(at.rank_joints[index] == at.rank_motors[index] == len(at.joints))
        if complete and np.isfinite(G).all():
            return np.asarray(G)
        one, place = at[index], f"q[{index}]"
    else:
        one, place = at, "q"
    if one.G is None or one.B_J is None:
        which, reason = ("G", one.reason) if one.G is None else ("B_J", one.inverse_reason)
        raise NoTransmission(f"{which} at {place}", reason or "")
    if one.rank_joints < len(one.joints):
        raise NoTransmission(f"a set of limits at {place}", "the joints depend on each other; leave out some of them")
    return one.G


def _ranges(robot: Robot, motors: tuple[str, ...], joints: tuple[str, ...]) -> tuple[Vector, Vector, Vector]:
    """Smallest and largest torque, and largest velocity, of each motor."""
    control = dict(zip(robot.actuation.idx_v.tolist(), robot.actuation.control.tolist(), strict=True))
    of: dict[str, tuple[float, float, float]] = {}
    for name, slot in robot.slots.items():
        for k in range(slot.nv):
            properties = slot.joint.properties
            effort = properties.effort[k] if properties.effort else np.inf
            velocity = properties.velocity[k] if properties.velocity else np.inf
            lower, upper = control.get(slot.idx_v + k, (-np.inf, np.inf))
            label = name if slot.nv == 1 else f"{name}[{k}]"
            of[label] = max(lower, -effort), min(upper, effort), velocity
    for motor in motors:
        lower, upper, velocity = of[motor]
        for value, word in ((max(upper, -lower), "effort"), (velocity, "velocity")):
            if not np.isfinite(value):
                raise ValueError(f"motor '{motor}' has no {word} limit; state one in the description")
        if not lower < 0.0 < upper:
            raise ValueError(f"motor '{motor}' has the torque range {lower:g} to {upper:g}; it must include zero")
        if not velocity > 0.0:
            raise ValueError(f"motor '{motor}' has the velocity limit {velocity:g}; expected a positive one")
    lowers, uppers, fastest = np.array([of[motor] for motor in motors]).T
    return lowers, uppers, fastest


def _checked_ratio(name: str, ratio: ArrayLike | None, n: int) -> Vector | None:
    if ratio is None:
        return None
    given = checked_array(name, ratio, (n,))
    if not (given > 0.0).all():
        raise ValueError(f"{name} is {given.tolist()}; expected positive numbers")
    return given
