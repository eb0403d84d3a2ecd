"""Which coordinates and velocities of a model are actuated."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pinocchio as pin

from eurdf.array import Indices, Matrix
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.configuration import Slot

_UNLIMITED = (-math.inf, math.inf)


@dataclass(frozen=True, eq=False)
class Actuation:
    """The actuated joints, in file order, and their indices in a model, one for each velocity (EU-ACT-007).

    Names and control ranges are those of the description (EU-ACT-010). The arrays are read-only, as the robot and its
    functions share them.

    Attributes:
        joints: Their names.
        idx_q: Indices of all their coordinates in q, joint by joint.
        idx_v: Indices of all their velocities in v, joint by joint; there are nu.
        nv: Number of velocities of the model.
        names: Names of the actuators, one for each joint.
        control: Smallest and largest torque or force (nu, 2) of each velocity, N·m or N; -inf and inf where none is
            stated.
    """

    joints: tuple[str, ...]
    idx_q: Indices
    idx_v: Indices
    nv: int
    names: tuple[str, ...]
    control: Matrix

    @cached_property
    def selection(self) -> Matrix:
        """S, of shape (nv, nu): motor torques u act on the mechanism as S u.

        Column k is the unit vector of ``idx_v[k]``. The matrix is dense; it is computed on first use.
        """
        selection = np.zeros((self.nv, len(self.idx_v)))
        selection[self.idx_v, np.arange(len(self.idx_v))] = 1.0
        selection.flags.writeable = False
        return selection

    def __post_init__(self) -> None:
        for array in (self.idx_q, self.idx_v, self.control):
            array.flags.writeable = False


def build_actuation(mechanism: Mechanism, model: pin.Model, at: Mapping[str, Slot]) -> Actuation:
    """The actuation of a mechanism, whose `build_model` and `slots` are given."""
    actuated = [at[name] for name in mechanism.actuators]
    idx_q = np.array([slot.idx_q + k for slot in actuated for k in range(slot.nq)], np.intp)
    idx_v = np.array([slot.idx_v + k for slot in actuated for k in range(slot.nv)], np.intp)
    motors = [mechanism.motor(name) for name in mechanism.actuators]
    control = [
        motor.control or _UNLIMITED for motor, slot in zip(motors, actuated, strict=True) for _ in range(slot.nv)
    ]
    names = tuple(motor.name for motor in motors)
    return Actuation(mechanism.actuators, idx_q, idx_v, model.nv, names, np.array(control).reshape(-1, 2))
