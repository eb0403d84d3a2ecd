"""Actuated and free parts of configurations and velocities.

Source: `qmot`, `qfree`, `mergeq`, `vmot`, `vfree` and `mergev` of the toolbox of Batto, De Matteïs and Mansard, 2025.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

import numpy as np

from eurdf.array import Indices, Vector
from eurdf.kinematics.named import Named, configuration_of, require_names, velocity_of
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.arguments import checked_array

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


def split_configuration(robot: Robot, q: Named) -> tuple[Vector, Vector]:
    """Split a configuration into the coordinates of the actuated joints and the others.

    Args:
        robot: The robot.
        q: Configuration (nq,), as in Pinocchio: rad, m, (cos, sin) pairs and quaternions.

    Returns:
        q_actuated, joint by joint in the order of ``robot.actuation.joints``, and q_free, in the order of the model.

    Raises:
        ValueError: ``q`` has a wrong shape or is not finite.
    """
    return _split(configuration_of(robot, q), robot.actuation.idx_q)


def merge_configuration(robot: Robot, q_actuated: Named, q_free: Named) -> Vector:
    """The inverse of `split_configuration`: the configuration (nq,).

    Args:
        robot: The robot.
        q_actuated: Coordinates of the actuated joints, joint by joint in the order of ``robot.actuation.joints``.
        q_free: The other coordinates, in the order of the model.

    Raises:
        ValueError: One of the parts has a wrong shape or is not finite.
    """
    return _merge(robot, "q", q_actuated, q_free, robot.actuation.idx_q)


def split_velocity(robot: Robot, v: Named) -> tuple[Vector, Vector]:
    """Split a velocity (or acceleration, or torque) into the part of the actuated joints, Sᵀ v, and the others.

    Args:
        robot: The robot.
        v: Velocity (nv,), rad/s or m/s.

    Returns:
        v_actuated (nu,), in the order of ``robot.actuation``, and v_free (nv - nu,), in the order of the model.

    Raises:
        ValueError: ``v`` has a wrong shape or is not finite.
    """
    return _split(velocity_of(robot, v), robot.actuation.idx_v)


def merge_velocity(robot: Robot, v_actuated: Named, v_free: Named) -> Vector:
    """The inverse of `split_velocity`: the velocity (nv,).

    Args:
        robot: The robot.
        v_actuated: Velocities (nu,) of the actuated joints, in the order of ``robot.actuation``, rad/s or m/s.
        v_free: The other velocities (nv - nu,), in the order of the model.

    Raises:
        ValueError: One of the parts has a wrong shape or is not finite.
    """
    return _merge(robot, "v", v_actuated, v_free, robot.actuation.idx_v)


def _split(whole: Vector, actuated: Indices) -> tuple[Vector, Vector]:
    return whole[actuated], np.delete(whole, actuated)


def _merge(robot: Robot, name: Literal["q", "v"], of_actuated: Named, of_others: Named, actuated: Indices) -> Vector:
    read = configuration_of if name == "q" else velocity_of
    whole = np.empty(robot.tree.nq if name == "q" else robot.tree.nv)
    joints = robot.actuation.joints
    others = tuple(joint for joint in (*_root_joint(robot), *robot.slots) if joint not in joints)
    parts = (
        (f"{name}_actuated", of_actuated, joints, actuated),
        (f"{name}_free", of_others, others, np.delete(np.arange(len(whole)), actuated)),
    )
    for argument, given, names, indices in parts:
        if isinstance(given, Mapping):
            require_names(given, names, argument)
            given = read(robot, given, argument)[indices]
        whole[indices] = checked_array(argument, given, (len(indices),))
    return whole


def _root_joint(robot: Robot) -> tuple[str, ...]:
    return (ROOT_JOINT,) if robot.mechanism.root == "floating" else ()
