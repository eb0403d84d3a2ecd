"""The torques and velocities of passive joints that the limits of the actuators allow, one joint at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Vector
from eurdf.errors import NoTransmission
from eurdf.kinematics.scale import characteristic_length, velocity_scale
from eurdf.kinematics.tolerances import MOVES
from eurdf.transmissions.motors import motor_ranges
from eurdf.transmissions.selection import selectable, selection
from eurdf.transmissions.transmission import at_one, require

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True)
class PassiveLimit:
    """What the actuators do at a passive joint, at one configuration.

    Attributes:
        name: The joint; of one with several velocities ``joint[0]``, ….
        unit: Of its coordinate.
        velocity: Its largest velocity, each actuator at a velocity limit, rad/s or m/s; inf if an actuator has none.
        torque: The smallest and the largest torque, N·m or N, that the actuators produce there while the other passive
            joints have none; infinite if no actuator that moves the joint has a limit.
    """

    name: str
    unit: Literal["rad", "m"]
    velocity: float
    torque: tuple[float, float]


def passive_limits(robot: Robot, q: Vector) -> tuple[PassiveLimit, ...]:
    """The limits of the passive joints that the actuators move, and that they determine, in file order.

    The velocities of a joint are v = b v_m, so that the largest one is Σ |bᵢ| limitᵢ. A torque τ at the joint alone
    needs τ_m = bᵀ τ of the actuators: static, without friction, gravity and springs. The limits of the joint itself
    play no part.

    Args:
        robot: The robot.
        q: A closed configuration (nq,).

    Returns:
        One for each joint velocity; those of planar, spherical and floating joints are left out.

    Raises:
        NoTransmission: The actuators depend on each other, or are at a dead point.
        NotClosable: The loops are open at q.
        ValueError: An actuator is planar, spherical or floating, has an effort or velocity limit that is not positive,
            or a control range that is not from below to above zero; or springs block actuators.
    """
    actuated = set(robot.actuation.joints)
    passive = [name for name, _ in selectable(robot) if name not in actuated]
    if not actuated or not passive:
        return ()
    motors, joints = selection(robot, robot.actuation.joints, "actuators"), selection(robot, passive)
    at = at_one(robot, joints, q, motors)
    if at.rank_motors < len(motors):
        reason = f"only {at.rank_motors} of {len(motors)} actuator velocities are independent here"
        raise NoTransmission(
            "a limit of each passive joint", f"{reason}; name joints and motors in eurdf.transmissions.serial_limits"
        )
    free = {
        robot.tree.velocity_names[velocity]
        for name, velocity in zip(joints.names, joints.velocities.tolist(), strict=True)
        if name in at.undetermined
    }
    if free:
        determined = [name for name in passive if name not in free]
        if not determined:
            return ()
        joints = selection(robot, determined)
        at = at_one(robot, joints, q, motors)
    (B_J,) = require(at, "B_J")
    lower, upper, fastest = motor_ranges(robot, motors.names, motors.velocities)
    unit = velocity_scale(robot, characteristic_length(robot))
    moves = np.abs(B_J) * unit[motors.velocities] / unit[joints.velocities][:, None] > MOVES
    found = []
    for name, own_unit, b, moved in zip(joints.names, joints.units, B_J, moves, strict=True):
        if moved.any():
            b, low, high = b[moved], lower[moved], upper[moved]
            ends = np.sort(np.array((low / b, high / b)), axis=0)
            velocity = float(np.abs(b) @ fastest[moved])
            found.append(PassiveLimit(name, own_unit, velocity, (float(ends[0].max()), float(ends[1].min()))))
    return tuple(found)
