"""The Pinocchio joint models of each joint type."""

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

# About or along x, y and z, and any other axis.
_CONTINUOUS = tuple(pin.JointModel(kind()) for kind in (pin.JointModelRUBX, pin.JointModelRUBY, pin.JointModelRUBZ))
_MODELS = {
    "turn": (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ, pin.JointModelRevoluteUnaligned),
    "slide": (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ, pin.JointModelPrismaticUnaligned),
    "screw": (pin.JointModelHX, pin.JointModelHY, pin.JointModelHZ, pin.JointModelHelicalUnaligned),
}
_WHOLE = {
    JointType.PLANAR: pin.JointModel(pin.JointModelPlanar()),
    JointType.FLOATING: pin.JointModel(pin.JointModelFreeFlyer()),
    JointType.SPHERICAL: pin.JointModel(pin.JointModelSpherical()),
}


def joint_models(joint: Joint, *, unwrapped: bool = False) -> tuple[pin.JointModel, ...]:
    """The models of a moving joint, in series. They may be shared: copy one before changing it.

    Each has a motion subspace that does not depend on its coordinates: of others, such as `JointModelUniversal` and
    `JointModelComposite`, Pinocchio 4.1 has wrong derivatives. So a joint about or along axes of its own has one model
    for each of them.

    Args:
        joint: Any joint but a fixed one.
        unwrapped: Whether the coordinate of a continuous joint is an unwrapped angle instead of (cos, sin).
    """
    kind = joint.type
    if kind.moving_frame:
        return (_WHOLE[kind],)
    if is_circular(kind, unwrapped=unwrapped):
        return (_continuous(joint.axes[0]),)
    steps = ((step, joint.axes[at] if isinstance(at, int) else at) for step, at in kind.steps)
    return tuple(_along(step, axis, joint.pitch) for step, axis in steps)


def number_of_models(kind: JointType) -> int:
    """Number of joints that the model has for a joint of the type; one for a fixed joint, which is a frame."""
    return 1 if kind.moving_frame else max(1, len(kind.steps))


def is_circular(kind: JointType, *, unwrapped: bool) -> bool:
    """Whether Pinocchio has the last coordinate, an angle, as (cos, sin): one number more in q."""
    return kind.coordinates[-1:] == ("angle",) and not kind.limited and (kind.moving_frame or not unwrapped)


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
def _along(kind: str, axis: Vector3, pitch: float) -> pin.JointModel:
    """The model of a turn, slide or screw."""
    per_radian = (pitch / (2.0 * math.pi),) if kind == "screw" else ()
    index = aligned(axis)
    if index is not None:
        return pin.JointModel(_MODELS[kind][index](*per_radian))
    return pin.JointModel(_MODELS[kind][3](np.array(unit(axis)) + 0.0, *per_radian))


def _continuous(axis: Vector3) -> pin.JointModel:
    index = aligned(axis)
    if index is not None:
        return _CONTINUOUS[index]
    return _continuous_about(" ".join(map(repr, squarable(axis))))


@lru_cache(maxsize=256)
def _continuous_about(xyz: str) -> pin.JointModel:
    """Python cannot give JointModelRevoluteUnboundedUnaligned its axis; Pinocchio's URDF parser can."""
    return pin.JointModel(pin.buildModelFromXML(_ONE_CONTINUOUS_JOINT.format(xyz)).joints[1])
