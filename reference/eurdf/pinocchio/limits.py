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

#: The properties that have a number for each velocity, what it is if the joint states none, and the model's vector.
_OF_VELOCITIES = (
    ("velocity", _INF, "upperVelocityLimit"),
    ("effort", _INF, "upperEffortLimit"),
    ("friction", 0.0, "upperDryFrictionLimit"),
    ("damping", 0.0, "damping"),
    ("armature", 0.0, "armature"),
    ("rotor_inertia", 0.0, "rotorInertia"),
    ("gear_ratio", 1.0, "rotorGearRatio"),
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
    found = _first(root_nv, *(getattr(model, vector) for _, _, vector in _OF_VELOCITIES))
    for joint, nq in joints:
        lowest, highest = _position_bounds(joint, nq)
        lower += lowest
        upper += highest
        nv, properties = joint.type.nv, joint.properties
        for numbers, (name, default, _) in zip(found, _OF_VELOCITIES, strict=True):
            numbers += getattr(properties, name) or (default,) * nv
    model.lowerPositionLimit, model.upperPositionLimit = np.array(lower), np.array(upper)
    for numbers, (_, _, vector) in zip(found, _OF_VELOCITIES, strict=True):
        setattr(model, vector, np.array(numbers))
    # Pinocchio 4.1 gives the lower velocity limit the sign of the upper one. Whichever it gave its defaults is kept.
    model.lowerVelocityLimit = np.copysign(model.upperVelocityLimit, model.lowerVelocityLimit)
    model.lowerEffortLimit, model.lowerDryFrictionLimit = -model.upperEffortLimit, -model.upperDryFrictionLimit


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
