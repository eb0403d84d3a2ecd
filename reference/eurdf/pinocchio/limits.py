"""Limits, dissipation and motor constants of all joints, one vector a property."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain

import numpy as np
import pinocchio as pin

from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.mechanism import Joint

# Pinocchio bounds a cosine, a sine and each component of a unit quaternion by this: never reached, and finite.
_UNIT = 1.01
_INF = math.inf


def set_limits(model: pin.Model, joints: Sequence[tuple[Joint, int]], root_nq: int, root_nv: int) -> None:
    """Write the properties of the joints into the model's vectors.

    Where Pinocchio holds an angle as (cos, sin), or an orientation as a quaternion, position limits have no place in
    the model. The properties of a root joint, the first in the model, stay as they are.

    Args:
        model: All joints are in it, with Pinocchio's default properties.
        joints: Those with coordinates of their own, in the model's order, each with its number of coordinates there.
        root_nq: Number of coordinates of the root joint; 0 without one.
        root_nv: Number of its velocities.
    """

    def vector(values: list[tuple[float, ...]], default: float, root: np.ndarray) -> np.ndarray:
        filled = (value or (default,) * nv for value, nv in zip(values, widths, strict=True))
        return np.array([*root[:root_nv], *chain.from_iterable(filled)])

    widths = [joint.coordinates.nv for joint, _ in joints]
    bounds = [_position_bounds(joint, nq) for joint, nq in joints]
    model.lowerPositionLimit = np.array(
        [*model.lowerPositionLimit[:root_nq], *chain.from_iterable(lower for lower, _ in bounds)]
    )
    model.upperPositionLimit = np.array(
        [*model.upperPositionLimit[:root_nq], *chain.from_iterable(upper for _, upper in bounds)]
    )
    velocity = vector([joint.velocity for joint, _ in joints], _INF, model.upperVelocityLimit)
    # Pinocchio 4.1 gives the lower velocity limit the sign of the upper one. Whichever it gave its defaults is kept.
    model.lowerVelocityLimit = np.copysign(velocity, model.lowerVelocityLimit)
    model.upperVelocityLimit = velocity
    effort = vector([joint.effort for joint, _ in joints], _INF, model.upperEffortLimit)
    model.lowerEffortLimit = -effort
    model.upperEffortLimit = effort
    friction = vector([joint.friction for joint, _ in joints], 0.0, model.upperDryFrictionLimit)
    model.lowerDryFrictionLimit = -friction
    model.upperDryFrictionLimit = friction
    model.damping = vector([joint.damping for joint, _ in joints], 0.0, model.damping)
    model.armature = vector([joint.armature for joint, _ in joints], 0.0, model.armature)
    model.rotorInertia = vector([joint.rotor_inertia for joint, _ in joints], 0.0, model.rotorInertia)
    model.rotorGearRatio = vector([joint.gear_ratio for joint, _ in joints], 1.0, model.rotorGearRatio)


def _position_bounds(joint: Joint, nq: int) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Lower and upper position limits as Pinocchio's coordinates have them, ``nq`` numbers each."""
    names = len(joint.coordinates.names)
    lower = joint.lower or (-_INF,) * names
    upper = joint.upper or (_INF,) * names
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
