"""Indices of the coordinates and velocities of each joint in a model's vectors."""

from __future__ import annotations

from typing import NamedTuple

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.mimic import following


class Slot(NamedTuple):
    """A joint with its own coordinates, and their indices.

    Attributes:
        joint: The joint.
        idx_q: Index of the first of its coordinates in q.
        nq: Number of its coordinates as Pinocchio has them.
        idx_v: Index of the first of its velocities in v.
        nv: Number of its velocities.
    """

    joint: Joint
    idx_q: int
    nq: int
    idx_v: int
    nv: int


def slots(mechanism: Mechanism) -> dict[str, Slot]:
    """The slots of all joints except fixed joints and mimic joints, in the order of the mechanism's joints.

    Args:
        mechanism: The mechanism; the indices are those in the model that `build_model` makes of it.
    """
    led = following(mechanism)
    mimics, unwrapped = led.mimics, led.unwrapped
    idx_q, idx_v = (7, 6) if mechanism.root == "floating" else (0, 0)
    found: dict[str, Slot] = {}
    for joint in (*led.late, *mechanism.joints):
        kind, name = joint.type, joint.name
        if kind.is_fixed or name in mimics or name in found:
            continue
        nq, nv = len(kind.coordinates), kind.nv
        if kind is JointType.PLANAR or (kind is JointType.CONTINUOUS and name not in unwrapped):
            nq += 1  # Pinocchio has their angle as (cos, sin)
        found[name] = Slot(joint, idx_q, nq, idx_v, nv)
        idx_q, idx_v = idx_q + nq, idx_v + nv
    return {joint.name: found[joint.name] for joint in mechanism.joints if joint.name in found} if led.late else found
