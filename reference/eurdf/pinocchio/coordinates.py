"""Indices of the coordinates and velocities of each joint in a model's vectors."""

from __future__ import annotations

from typing import NamedTuple

import pinocchio as pin

from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_type import COORDINATES, JointType
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


def slots(mechanism: Mechanism, model: pin.Model) -> dict[str, Slot]:
    """The slots of all joints except fixed joints and mimic joints.

    Args:
        mechanism: The mechanism.
        model: The result of `build_model`.
    """
    led = following(mechanism)
    idx_qs, idx_vs = model.idx_qs.tolist(), model.idx_vs.tolist()
    joint_id = 1 + (mechanism.root == "floating") + len(led.late)
    mimics, unwrapped = led.mimics, led.unwrapped
    found = {}
    for joint in mechanism.joints:
        kind, name = joint.type, joint.name
        if kind is JointType.FIXED:
            continue
        if name not in mimics:
            coordinates = COORDINATES[kind]
            nq = len(coordinates.names)
            if kind is JointType.PLANAR or (kind is JointType.CONTINUOUS and name not in unwrapped):
                nq += 1  # Pinocchio has their angle as (cos, sin)
            found[name] = Slot(joint, idx_qs[joint_id], nq, idx_vs[joint_id], coordinates.nv)
        joint_id += 1
    return found
