"""The Pinocchio joint model of each joint type."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import pinocchio as pin

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import Vector3, squarable

# Pinocchio takes an axis for a coordinate axis within this distance (Eigen's isApprox).
_ALIGNED = 1e-12

_ONE_CONTINUOUS_JOINT = """<robot name=""><link name="a"/><link name="b"/><joint name="j" type="continuous">
<parent link="a"/><child link="b"/><axis xyz="{}"/></joint></robot>"""

_REVOLUTE = tuple(pin.JointModel(kind()) for kind in (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ))
_CONTINUOUS = tuple(pin.JointModel(kind()) for kind in (pin.JointModelRUBX, pin.JointModelRUBY, pin.JointModelRUBZ))
_PRISMATIC = tuple(pin.JointModel(kind()) for kind in (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ))
_HELICAL = (pin.JointModelHX, pin.JointModelHY, pin.JointModelHZ)
_PLANAR = pin.JointModel(pin.JointModelPlanar())
_FLOATING = pin.JointModel(pin.JointModelFreeFlyer())
_SPHERICAL = pin.JointModel(pin.JointModelSpherical())


def joint_model(joint: Joint, *, unwrapped: bool = False) -> pin.JointModel:
    """The model of a moving joint. It may be shared: copy it before changing it.

    Args:
        joint: Any joint but a fixed one.
        unwrapped: Whether the coordinate of a continuous joint is an unwrapped angle instead of (cos, sin).
    """
    match joint.type:
        case JointType.REVOLUTE:
            return _revolute(joint.axes[0])
        case JointType.CONTINUOUS:
            return _revolute(joint.axes[0]) if unwrapped else _continuous(joint.axes[0])
        case JointType.PRISMATIC:
            return _prismatic(joint.axes[0])
        case JointType.SPHERICAL:
            return _SPHERICAL
        case JointType.UNIVERSAL:
            return _universal(joint.axes[0], joint.axes[1])
        case JointType.CYLINDRICAL:
            return _in_series(_prismatic(joint.axes[0]), _revolute(joint.axes[0]))
        case JointType.HELICAL:
            return _helical(joint.axes[0], joint.pitch)
        case JointType.PLANAR:
            return _PLANAR
        case JointType.FLOATING:
            return _FLOATING
        case JointType.FIXED:
            raise ValueError(f"joint '{joint.name}' is fixed and has no joint model")


def unit(axis: Vector3) -> Vector3:
    """The axis at unit length, rounded as Eigen rounds it."""
    x, y, z = squarable(axis)
    norm = math.sqrt(x * x + y * y + z * z)
    return x / norm, y / norm, z / norm


@lru_cache(maxsize=256)
def aligned(axis: Vector3) -> int | None:
    """0, 1 or 2 for an axis that is, as written and within 1e-12, the unit vector of x, y or z; else None."""
    x, y, z = axis
    for index, (along, first, second) in enumerate(((x, y, z), (y, x, z), (z, x, y))):
        if abs(along - 1.0) <= _ALIGNED:
            off = first * first + second * second + (along - 1.0) * (along - 1.0)
            square = first * first + second * second + along * along
            return index if off <= _ALIGNED * _ALIGNED * min(square, 1.0) else None
    return None


# Models are kept: the legs of a robot have the same axes, and to make one takes longer than all else of a joint. Equal
# axes have equal models: -0.0, which equals 0.0, becomes 0.0.
@lru_cache(maxsize=256)
def _revolute(axis: Vector3) -> pin.JointModel:
    index = aligned(axis)
    if index is not None:
        return _REVOLUTE[index]
    return pin.JointModel(pin.JointModelRevoluteUnaligned(np.array(unit(axis)) + 0.0))


@lru_cache(maxsize=256)
def _prismatic(axis: Vector3) -> pin.JointModel:
    index = aligned(axis)
    if index is not None:
        return _PRISMATIC[index]
    return pin.JointModel(pin.JointModelPrismaticUnaligned(np.array(unit(axis)) + 0.0))


def _continuous(axis: Vector3) -> pin.JointModel:
    index = aligned(axis)
    if index is not None:
        return _CONTINUOUS[index]
    return _continuous_about(" ".join(map(repr, squarable(axis))))


@lru_cache(maxsize=256)
def _continuous_about(xyz: str) -> pin.JointModel:
    """Python cannot give JointModelRevoluteUnboundedUnaligned its axis; Pinocchio's URDF parser can."""
    return pin.JointModel(pin.buildModelFromXML(_ONE_CONTINUOUS_JOINT.format(xyz)).joints[1])


def _helical(axis: Vector3, pitch: float) -> pin.JointModel:
    per_radian = pitch / (2.0 * math.pi)
    index = aligned(axis)
    if index is None:
        return pin.JointModelHelicalUnaligned(np.array(unit(axis)), per_radian)
    return _HELICAL[index](per_radian)


@lru_cache(maxsize=256)
def _universal(first: Vector3, second: Vector3) -> pin.JointModel:
    """Two revolutes in one point. Pinocchio's universal joint requires exactly perpendicular axes."""
    (a, b, c), (x, y, z) = unit(first), unit(second)
    if a * x + b * y + c * z == 0.0:
        return pin.JointModel(pin.JointModelUniversal(np.array((a, b, c)) + 0.0, np.array((x, y, z)) + 0.0))
    return _in_series(_revolute(first), _revolute(second))


def _in_series(first: pin.JointModel, second: pin.JointModel) -> pin.JointModel:
    composite = pin.JointModelComposite(2)
    composite.addJoint(first)
    composite.addJoint(second)
    return pin.JointModel(composite)
