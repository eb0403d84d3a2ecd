"""Limits, dissipation and motor constants of all joints, one vector for each property."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType

# Pinocchio bounds a cosine, a sine and each component of a unit quaternion by this: never reached, and finite.
_UNIT = 1.01
_INF = math.inf

Vector = npt.NDArray[np.float64]


def set_limits(model: pin.Model, joints: Sequence[tuple[Joint, int]], root_nq: int, root_nv: int) -> None:
    """Write the properties of the joints into the model's vectors.

    The model has no position limits for (cos, sin) pairs and quaternions. The properties of a root joint, the first in
    the model, are not changed.

    Args:
        model: All joints are in it, with Pinocchio's default properties.
        joints: Those with coordinates of their own, in the model's order, each with its number of coordinates there.
        root_nq: Number of coordinates of the root joint; 0 without one.
        root_nv: Number of its velocities.
    """
    lower, upper = _first(root_nq, model.lowerPositionLimit, model.upperPositionLimit)
    velocity, effort, friction, damping, armature, rotor_inertia, gear_ratio = _first(
        root_nv,
        model.upperVelocityLimit,
        model.upperEffortLimit,
        model.upperDryFrictionLimit,
        model.damping,
        model.armature,
        model.rotorInertia,
        model.rotorGearRatio,
    )
    for joint, nq in joints:
        lowest, highest = _position_bounds(joint, nq)
        lower += lowest
        upper += highest
        nv = joint.type.nv
        properties = joint.properties
        velocity += properties.velocity or (_INF,) * nv
        effort += properties.effort or (_INF,) * nv
        friction += properties.friction or (0.0,) * nv
        damping += properties.damping or (0.0,) * nv
        armature += properties.armature or (0.0,) * nv
        rotor_inertia += properties.rotor_inertia or (0.0,) * nv
        gear_ratio += properties.gear_ratio or (1.0,) * nv
    model.lowerPositionLimit = np.array(lower)
    model.upperPositionLimit = np.array(upper)
    # Pinocchio 4.1 gives the lower velocity limit the sign of the upper one. Whichever it gave its defaults is kept.
    model.lowerVelocityLimit = np.copysign(velocity, model.lowerVelocityLimit)
    model.upperVelocityLimit = np.array(velocity)
    model.upperEffortLimit = np.array(effort)
    model.lowerEffortLimit = -model.upperEffortLimit
    model.upperDryFrictionLimit = np.array(friction)
    model.lowerDryFrictionLimit = -model.upperDryFrictionLimit
    model.damping = np.array(damping)
    model.armature = np.array(armature)
    model.rotorInertia = np.array(rotor_inertia)
    model.rotorGearRatio = np.array(gear_ratio)


def _first(count: int, *vectors: Vector) -> list[list[float]]:
    """The first numbers of each vector."""
    return [vector[:count].tolist() if count else [] for vector in vectors]


def _position_bounds(joint: Joint, nq: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Lower and upper position limits as Pinocchio's coordinates have them, ``nq`` numbers each."""
    lower = joint.properties.lower or (-_INF,) * len(joint.type.coordinates)
    upper = joint.properties.upper or (_INF,) * len(joint.type.coordinates)
    kind = joint.type
    if kind is JointType.SPHERICAL or (kind is JointType.CONTINUOUS and nq == 2):
        plain = 0
    elif kind is JointType.PLANAR:
        plain = 2
    elif kind is JointType.FLOATING:
        plain = 3
    else:
        return lower, upper
    unit = (_UNIT,) * (nq - plain)
    return (*lower[:plain], *(-bound for bound in unit)), (*upper[:plain], *unit)
