"""Actuated and free parts of configurations and velocities.

Source: `qmot`, `qfree`, `mergeq`, `vmot`, `vfree` and `mergev` of the toolbox of Batto, De Matteïs and Mansard, 2025.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices, Vector

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def split_configuration(robot: Robot, q: Vector) -> tuple[Vector, Vector]:
    """The coordinates of the actuated joints, and all others.

    Args:
        robot: The robot.
        q: Configuration (nq,), in rad, m, cosines and sines, and quaternions, as Pinocchio has them.

    Returns:
        q_actuated, joint by joint in the order of ``robot.actuation.joints``, and q_free, in the order of the model.

    Raises:
        ValueError: ``q`` has another shape.
    """
    return _split("configuration", q, robot.actuation.idx_q, robot.model.nq)


def merge_configuration(robot: Robot, q_actuated: Vector, q_free: Vector) -> Vector:
    """The configuration (nq,) that `split_configuration` splits into the two given.

    Raises:
        ValueError: One of them has not the shape that it splits into.
    """
    return _merge("configuration", q_actuated, q_free, robot.actuation.idx_q, robot.model.nq)


def split_velocity(robot: Robot, v: Vector) -> tuple[Vector, Vector]:
    """The velocities of the actuated joints, Sᵀ v, and all others; accelerations and torques split alike.

    Args:
        robot: The robot.
        v: Velocity (nv,), rad/s or m/s.

    Returns:
        v_actuated (nu,), in the order of ``robot.actuation``, and v_free (nv - nu,), in the order of the model.

    Raises:
        ValueError: ``v`` has another shape.
    """
    return _split("velocity", v, robot.actuation.idx_v, robot.model.nv)


def merge_velocity(robot: Robot, v_actuated: Vector, v_free: Vector) -> Vector:
    """The velocity (nv,) that `split_velocity` splits into the two given.

    Raises:
        ValueError: One of them has not the shape that it splits into.
    """
    return _merge("velocity", v_actuated, v_free, robot.actuation.idx_v, robot.model.nv)


def _split(what: str, whole: Vector, actuated: Indices, size: int) -> tuple[Vector, Vector]:
    whole = _of_size(f"a {what} of this robot", whole, size)
    return whole[actuated], np.delete(whole, actuated)


def _merge(what: str, of_actuated: Vector, of_others: Vector, actuated: Indices, size: int) -> Vector:
    whole = np.empty(size)
    whole[actuated] = _of_size(f"the actuated part of a {what} of this robot", of_actuated, len(actuated))
    others = np.delete(np.arange(size), actuated)
    whole[others] = _of_size(f"the free part of a {what} of this robot", of_others, len(others))
    return whole


def _of_size(what: str, values: Vector, size: int) -> Vector:
    vector = np.asarray(values, dtype=np.float64)
    if vector.shape != (size,):
        raise ValueError(f"{what} has the shape ({size},), not {vector.shape}")
    return vector
