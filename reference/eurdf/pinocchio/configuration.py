"""Configurations: where each joint has its coordinates in q, from those of files and answers to q, and back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from eurdf.array import Vector
from eurdf.diagnostics.wording import meant
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism, root_joint
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.joint_model import is_circular
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
    """The slots of all joints except fixed and mimic ones, in file order, in the model that `build_model` makes."""
    led = following(mechanism)
    mimics, unwrapped = led.mimics, led.unwrapped
    idx_q, idx_v = (7, 6) if mechanism.root == "floating" else (0, 0)
    found: dict[str, Slot] = {}
    for joint in (*led.late, *mechanism.joints):
        kind, name = joint.type, joint.name
        if kind.is_fixed or name in mimics or name in found:
            continue
        nq, nv = len(kind.coordinates), kind.nv
        nq += is_circular(kind, unwrapped=name in unwrapped)
        found[name] = Slot(joint, idx_q, nq, idx_v, nv)
        idx_q, idx_v = idx_q + nq, idx_v + nv
    return {joint.name: found[joint.name] for joint in mechanism.joints if joint.name in found} if led.late else found


def configuration_vector(
    mechanism: Mechanism,
    model: pin.Model,
    coordinates: Mapping[str, float | Sequence[float]],
    at: Mapping[str, Slot] | None = None,
) -> Vector:
    """The configuration (nq,) in which joints have the given coordinates, and all others their neutral (EU-CFG-005).

    As `Robot.configuration`; quaternions are normalized. The model is that of `build_model`, and ``at`` are the `slots`
    of the mechanism, if the caller has them.
    """
    q: Vector = pin.neutral(model)
    at = slots(mechanism) if at is None else at
    mimics = {joint.name for joint in mechanism.joints if joint.mimic is not None}
    for name, given in coordinates.items():
        values = np.atleast_1d(np.asarray(given, dtype=np.float64)).tolist()
        if name == ROOT_JOINT and mechanism.root == "floating":
            q[:7] = root_joint("").normalized(values)
            continue
        slot = at.get(name)
        if slot is None:
            if name in mimics:
                continue
            raise ValueError(f"'{name}' is not a joint with coordinates{meant(name, at)}")
        values = [*slot.joint.normalized(values)]
        if slot.nq > len(values):  # the last of them is an angle, which Pinocchio has as (cos, sin)
            values[-1:] = math.cos(values[-1]), math.sin(values[-1])
        q[slot.idx_q : slot.idx_q + slot.nq] = values
    return q


def joint_coordinates(mechanism: Mechanism, model: pin.Model, q: Vector) -> dict[str, tuple[float, ...]]:
    """The coordinates of every joint that is not fixed, by name, with those of mimic joints: `Robot.joint_positions`.

    They are in the order of the mechanism's joints, ``root_joint`` first where the root floats.
    """
    numbers = checked_array("q", q, (model.nq,)).tolist()
    own: dict[str, tuple[float, ...]] = {}
    for name, slot in slots(mechanism).items():
        values = numbers[slot.idx_q : slot.idx_q + slot.nq]
        if slot.nq > len(slot.joint.type.coordinates):
            values[-2:] = [math.atan2(values[-1], values[-2])]
        own[name] = tuple(values)
    found = {ROOT_JOINT: tuple(numbers[:7])} if mechanism.root == "floating" else {}
    mimics = following(mechanism).mimics
    for joint in mechanism.joints:
        if joint.name in own:
            found[joint.name] = own[joint.name]
        elif joint.name in mimics:
            mimic = mimics[joint.name]
            found[joint.name] = (mimic.multiplier * own[mimic.joint][0] + mimic.offset,)
    return found
