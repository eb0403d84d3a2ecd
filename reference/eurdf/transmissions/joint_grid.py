"""Closed configurations at a grid of joint positions."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Mask, Matrix, Vector
from eurdf.kinematics.assembly import assemble, start
from eurdf.kinematics.exceptions import NotClosable
from eurdf.kinematics.forward_kinematics import farthest
from eurdf.transmissions.selection import Selection, selection

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A step from one node to the next is halved down to this part of it.
_SHORTEST = 2.0**-4


@dataclass(frozen=True, slots=True, eq=False)
class JointGrid:
    """Positions of joints on a grid over their position limits, and closed configurations there.

    Attributes:
        joints: Names of the joints, nJ.
        values: Their positions (N, nJ), rad or m, the last joint first to change.
        q: Closed configurations (N, nq); NaN where the joints cannot be reached.
        reached: Whether the joints reach these positions (N,).
    """

    joints: tuple[str, ...]
    values: Matrix
    q: Matrix
    reached: Mask


def joint_grid(
    robot: Robot, joints: Sequence[str], motors: Selection, count: int, q0: Vector | None = None
) -> JointGrid:
    """Move joints over a grid of positions, from each node to its neighbours, on the branch of q0.

    Actuators that are not among the motors stay where they are. Position limits of other joints are left out.

    Args:
        robot: The robot.
        joints: Names of joints with one coordinate and position limits.
        motors: The motors that move them.
        count: Number of positions of each joint, at least 2.
        q0: Where to start (nq,). The default is the `assembled` configuration, or the neutral one if there is none.

    Raises:
        NotClosable: The loops cannot be closed at q0.
        ValueError: A joint has several coordinates or no position limits.
    """
    names = selection(robot, joints).joints
    axes = [_axis(robot, name, count) for name in names]
    closed = assemble(robot, start(robot, q0))
    if not closed.closes:
        raise NotClosable("no closed configuration was found near the start", closed.open, closed.q)
    at = robot.coordinates(closed.q)
    kept = {*names, *motors.joints}
    still = {name: at[name] for name in robot.actuation.joints if name not in kept}
    nodes = list(product(range(count), repeat=len(names)))
    values = {node: [float(axis[i]) for axis, i in zip(axes, node, strict=True)] for node in nodes}

    def moved(q: Vector, node: tuple[int, ...], shortest: float) -> Vector | None:
        wanted = {**still, **{name: (value,) for name, value in zip(names, values[node], strict=True)}}
        found, part = farthest(robot, wanted, q, shortest)
        return found if part == 1.0 else None

    found: dict[tuple[int, ...], Vector] = {}
    nearest = sorted(nodes, key=lambda node: _distance(values[node], [at[name][0] for name in names], axes))
    for first in nearest:  # the nearest node may be out of reach
        q = moved(closed.q, first, 2.0**-8)
        if q is not None:
            found[first] = q
            break
    waiting = deque(found)
    while waiting:
        node = waiting.popleft()
        for neighbour in _neighbours(node, count):
            if neighbour not in found:
                q = moved(found[node], neighbour, _SHORTEST)
                if q is not None:
                    found[neighbour] = q
                    waiting.append(neighbour)
    nowhere = np.full(robot.tree.nq, np.nan)
    return JointGrid(
        names,
        np.array([values[node] for node in nodes]),
        np.array([found.get(node, nowhere) for node in nodes]),
        np.array([node in found for node in nodes], dtype=bool),
    )


def _axis(robot: Robot, name: str, count: int) -> Vector:
    """Positions of a joint from its lower to its upper limit."""
    slot = robot.slots[name]
    if slot.nv > 1:
        raise ValueError(f"joint '{name}' has {slot.nv} coordinates; a grid is over joints with one")
    properties = slot.joint.properties
    lower, upper = (properties.lower or (-np.inf,))[0], (properties.upper or (np.inf,))[0]
    if not (np.isfinite(lower) and np.isfinite(upper) and lower < upper):
        raise ValueError(f"joint '{name}' has no range of position limits; state one in the description")
    return np.linspace(lower, upper, count)


def _distance(one: Sequence[float], other: Sequence[float], axes: Sequence[Vector]) -> float:
    return sum(float((a - b) / (axis[-1] - axis[0])) ** 2 for a, b, axis in zip(one, other, axes, strict=True))


def _neighbours(node: tuple[int, ...], count: int) -> list[tuple[int, ...]]:
    return [
        (*node[:axis], node[axis] + step, *node[axis + 1 :])
        for axis in range(len(node))
        for step in (-1, 1)
        if 0 <= node[axis] + step < count
    ]
