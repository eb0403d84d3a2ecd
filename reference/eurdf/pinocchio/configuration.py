"""Configurations: from the coordinates of files and answers to Pinocchio's q and back."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from eurdf.mechanism.joint_type import COORDINATES, Coordinates, JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.coordinates import slots
from eurdf.pinocchio.mimic import NONE, following
from eurdf.pinocchio.model import ROOT_JOINT

Vector = npt.NDArray[np.float64]


def configuration_vector(
    mechanism: Mechanism, model: pin.Model, coordinates: Mapping[str, Sequence[float]]
) -> Vector:
    """The configuration q in which joints have the given coordinates.

    Args:
        mechanism: The mechanism.
        model: What `build_model` made of it.
        coordinates: For each joint its coordinates as files have them (`eurdf.mechanism.joint_type.COORDINATES`), for a
            floating root those of a floating joint under ``root_joint``. A joint left out stands at its neutral.
            Quaternions are brought to unit length. What is said of a joint that follows another is not looked at.

    Returns:
        q, of shape (nq,).

    Raises:
        ValueError: A name is no joint with coordinates, or a joint is given too few or too many of them, or a
            quaternion of length 0.
    """
    q: Vector = pin.neutral(model)
    at = slots(mechanism, model)
    for name, given in coordinates.items():
        values = [float(value) for value in given]
        if name == ROOT_JOINT and mechanism.root == "floating":
            q[:7] = _checked(name, values, COORDINATES[JointType.FLOATING])
            continue
        slot = at.get(name)
        if slot is None:
            if any(joint.name == name and joint.mimic is not None for joint in mechanism.joints):
                continue
            raise ValueError(f"'{name}' is no joint with coordinates")
        values = _checked(name, values, slot.joint.coordinates)
        if slot.nq > len(values):  # the last of them is an angle, which Pinocchio has as (cos, sin)
            values[-1:] = math.cos(values[-1]), math.sin(values[-1])
        q[slot.idx_q : slot.idx_q + slot.nq] = values
    return q


def joint_coordinates(mechanism: Mechanism, model: pin.Model, q: Vector) -> dict[str, tuple[float, ...]]:
    """The coordinates, as files have them, of every joint that is not fixed, by its name.

    Args:
        mechanism: The mechanism.
        model: What `build_model` made of it.
        q: Configuration, of shape (nq,).

    Returns:
        In the order of the mechanism's joints, ``root_joint`` first where the root floats. An angle that Pinocchio has
        as (cos, sin) is from -pi to pi. A joint that follows another has the coordinate that follows.
    """
    found: dict[str, tuple[float, ...]] = {}
    values = np.asarray(q, dtype=float).tolist()
    if mechanism.root == "floating":
        found[ROOT_JOINT] = tuple(values[:7])
    at = slots(mechanism, model)
    for name, slot in at.items():
        own = values[slot.idx_q : slot.idx_q + slot.nq]
        if slot.nq > len(slot.joint.coordinates.names):
            own[-2:] = [math.atan2(own[-1], own[-2])]
        found[name] = tuple(own)
    laws = following(mechanism).laws if len(model.mimicking_joints) else NONE.laws
    for name, law in laws.items():
        found[name] = (law.multiplier * found[law.joint][0] + law.offset,)
    if laws:
        order = {joint.name: index for index, joint in enumerate(mechanism.joints)}
        found = dict(sorted(found.items(), key=lambda item: order.get(item[0], -1)))
    return found


def _checked(name: str, values: list[float], coordinates: Coordinates) -> list[float]:
    if len(values) != len(coordinates.names):
        raise ValueError(
            f"joint '{name}' is given {len(values)} coordinates; it has {len(coordinates.names)}: "
            + ", ".join(coordinates.names)
        )
    start = coordinates.quaternion
    if start is not None:
        norm = math.hypot(*values[start : start + 4])
        if norm == 0.0:
            raise ValueError(f"the quaternion of joint '{name}' has length 0")
        values[start : start + 4] = [value / norm for value in values[start : start + 4]]
    return values
