"""Motor positions near an assembled configuration, which the loops can reach."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import eurdf
from benchmarks.plain_newton import NotConverged, PlainNewton

Vector = npt.NDArray[np.float64]

_TRIES = 4
ANGLE, LENGTH = 0.05, 1e-3  # how far each motor moves, rad and m


def motors_nearby(robot: eurdf.Robot, newton: PlainNewton, count: int) -> tuple[Vector, list[Vector]]:
    """An assembled configuration (nq,), and actuated coordinates 0.05 rad or 1 mm away from it, the same every time.

    What plain Newton does not close is left out; there are fewer than asked for where it closes few.
    """
    tree, actuation = robot.tree, robot.actuation
    q, random = eurdf.assemble(robot).q, np.random.default_rng(0)
    size = np.zeros(tree.nv)
    for own in tree.own_velocities:
        size[own.start : own.stop] = ANGLE
    for joint, own in enumerate(tree.own_velocities):
        if len(own):
            size[np.array(own)[tree.translates(joint)]] = LENGTH
    found: list[Vector] = []
    for _ in range(_TRIES * count):
        if len(found) == count:
            break
        v = np.zeros(tree.nv)
        v[actuation.idx_v] = size[actuation.idx_v] * random.choice([-1.0, 1.0], len(actuation.idx_v))
        values = tree.integrate(q, v)[actuation.idx_q]
        try:
            newton.forward_kinematics(values, q)
            found.append(values)
        except NotConverged:
            continue
    return q, found
