"""The springs of a robot's joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from eurdf.array import Indices, Vector
from eurdf.mechanism.joint import Mimic
from eurdf.mechanism.mechanism import Mechanism
from eurdf.pinocchio.configuration import Slot
from eurdf.pinocchio.mimic import following


@dataclass(frozen=True, eq=False)
class Springs:
    """The springs of a robot, each on one coordinate: n of them.

    The deflection of a spring is ``ratio * q[idx_q] + shift``. For the spring of a mimic joint, the coordinate is that
    of its leader, and ratio and shift include multiplier and offset.

    Attributes:
        idx_q: Index (n,) in q of the coordinate of each spring, an angle (rad) or a length (m).
        idx_v: Index (n,) in v of its rate.
        stiffness: k (n,), N·m/rad or N/m.
        ratio: Multiplier of the coordinate (n,).
        shift: What is added to it (n,), rad or m; -rest for a joint that mimics no other.
    """

    idx_q: Indices
    idx_v: Indices
    stiffness: Vector
    ratio: Vector
    shift: Vector

    def __len__(self) -> int:
        return len(self.stiffness)

    def deflection(self, q: Vector) -> Vector:
        """Distance (n,) of each spring from rest at q (nq,), rad or m."""
        return np.asarray(self.ratio * q[self.idx_q] + self.shift)

    def force(self, q: Vector, nv: int) -> Vector:
        """Generalized force (nv,) of the springs at q (nq,), N·m or N."""
        idx_q, idx_v, slope, at_zero = self._on_coordinates
        force = np.zeros(nv)
        force[idx_v] = slope * q[idx_q] + at_zero
        return force

    @cached_property
    def _on_coordinates(self) -> tuple[Indices, Indices, Vector, Vector]:
        """Where coordinates with springs are in q and v, and the slope and the value at zero of the force on each."""
        idx_v, first, which = np.unique(self.idx_v, return_index=True, return_inverse=True)
        k = -self.stiffness * self.ratio
        slope, at_zero = (np.bincount(which, k * of, len(idx_v)).astype(float) for of in (self.ratio, self.shift))
        return self.idx_q[first], idx_v, slope, at_zero

    def energy(self, q: Vector) -> float:
        """Energy that the springs store at q (nq,), J."""
        deflection = self.deflection(q)
        return 0.5 * float(self.stiffness @ (deflection * deflection))


#: Of a robot without springs.
NO_SPRINGS = Springs(np.empty(0, np.intp), np.empty(0, np.intp), np.empty(0), np.empty(0), np.empty(0))


def build_springs(mechanism: Mechanism, at: Mapping[str, Slot]) -> Springs:
    """EU-JNT-031: the springs of a mechanism, whose `slots` are given; a stiffness of 0 is no spring."""
    sprung = [joint for joint in mechanism.joints if any(joint.properties.stiffness)]
    if not sprung:
        return NO_SPRINGS
    mimics = following(mechanism).mimics
    rows = []
    for joint in sprung:
        mimic = mimics.get(joint.name, Mimic(joint.name))
        slot, properties = at[mimic.joint], joint.properties
        for k, (stiffness, rest) in enumerate(zip(properties.stiffness, properties.rest, strict=True)):
            if stiffness:
                rows.append((slot.idx_q + k, slot.idx_v + k, stiffness, mimic.multiplier, mimic.offset - rest))
    idx_q, idx_v, *numbers = zip(*rows, strict=True)
    return Springs(np.array(idx_q), np.array(idx_v), *map(np.array, numbers))
