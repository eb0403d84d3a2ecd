"""Limits, dissipation and motor constants of all joints, one vector for each property."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from eurdf.array import Vector
from eurdf.mechanism.joint import Joint

# Pinocchio bounds a cosine, a sine and each component of a unit quaternion by this: never reached, and finite.
_UNIT = 1.01
_INF = math.inf

#: The properties that have a number for each velocity, and what it is if the joint states none.
_OF_VELOCITIES = (
    ("velocity", _INF),
    ("effort", _INF),
    ("friction", 0.0),
    ("damping", 0.0),
    ("armature", 0.0),
    ("rotor_inertia", 0.0),
    ("gear_ratio", 1.0),
)


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
    of_root = (
        model.upperVelocityLimit,
        model.upperEffortLimit,
        model.upperDryFrictionLimit,
        model.damping,
        model.armature,
        model.rotorInertia,
        model.rotorGearRatio,
    )
    found = _first(root_nv, *of_root)
    for joint, nq in joints:
        lowest, highest = _position_bounds(joint, nq)
        lower += lowest
        upper += highest
        nv, properties = joint.type.nv, joint.properties
        for numbers, (name, default) in zip(found, _OF_VELOCITIES, strict=True):
            numbers += getattr(properties, name) or (default,) * nv
    velocity, effort, friction, *others = map(np.array, found)
    model.lowerPositionLimit, model.upperPositionLimit = np.array(lower), np.array(upper)
    # Pinocchio 4.1 gives the lower velocity limit the sign of the upper one. Whichever it gave its defaults is kept.
    model.lowerVelocityLimit, model.upperVelocityLimit = np.copysign(velocity, model.lowerVelocityLimit), velocity
    model.lowerEffortLimit, model.upperEffortLimit = -effort, effort
    model.lowerDryFrictionLimit, model.upperDryFrictionLimit = -friction, friction
    model.damping, model.armature, model.rotorInertia, model.rotorGearRatio = others


def _first(count: int, *vectors: Vector) -> list[list[float]]:
    """The first numbers of each vector."""
    return [vector[:count].tolist() if count else [] for vector in vectors]


def _position_bounds(joint: Joint, nq: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Lower and upper position limits as Pinocchio's coordinates have them, ``nq`` numbers each."""
    lower = joint.properties.lower or (-_INF,) * len(joint.type.coordinates)
    upper = joint.properties.upper or (_INF,) * len(joint.type.coordinates)
    plain = joint.type.quaternion
    if nq > len(lower):  # the last coordinate is a (cos, sin) pair
        plain = len(lower) - 1
    if plain is None:
        return lower, upper
    unit = (_UNIT,) * (nq - plain)
    return (*lower[:plain], *(-bound for bound in unit)), (*upper[:plain], *unit)
