"""The loops that the closures make with the spanning tree, and which of them can move without the others."""

from __future__ import annotations

import weakref
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from eurdf.kinematics.array import Indices, Vector

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """One closure's loop: the path through the tree from frame A to frame B.

    Attributes:
        rows: Rows of the closure in the stacked residual.
        spatial: True for a 6d closure, False for a 3d one.
        joint_a: Joint of the model that carries frame A; 0 is the universe.
        joint_b: Joint that carries frame B.
        joints: Joints of the path, both sides, without the common ancestor, in ascending order.
        columns: Columns (n,) of the path's joints in Pinocchio's world Jacobian ``data.J``, in which a joint that
            mimics another has columns of its own.
        velocities: Index (n,) in v of each of these columns; one index stands twice where a joint mimics another
            of the path.
        signs: +1 for the columns (n,) that move B, -1 for those that move A.
        mimics: Whether an index stands twice in ``velocities``.
    """

    rows: slice
    spatial: bool
    joint_a: int
    joint_b: int
    joints: tuple[int, ...]
    columns: Indices
    velocities: Indices
    signs: Vector
    mimics: bool


# The loops depend only on the tree and on the joints that carry the frames: they are kept until one of these changes.
_LOOPS: weakref.WeakKeyDictionary[Any, tuple[Any, list[tuple[int, int, int]], tuple[Loop, ...]]]
_LOOPS = weakref.WeakKeyDictionary()


def find_loops(robot: Robot) -> tuple[Loop, ...]:
    """Loops of the robot's closures, in their order."""
    model = robot.model
    ends = [(found.joint1_id, found.joint2_id, found.residualSize()) for found in robot.constraint_models]
    known = _LOOPS.get(robot)
    if known is not None and known[0] is model and known[1] == ends:
        return known[2]
    loops = _trace(model, ends)
    _LOOPS[robot] = model, ends, loops
    return loops


def _trace(model: Any, ends: Sequence[tuple[int, int, int]]) -> tuple[Loop, ...]:
    parents = list(model.parents)
    first_column, widths, first_velocity = list(model.idx_vExtendeds), list(model.nvExtendeds), list(model.idx_vs)
    loops, row = [], 0
    for joint_a, joint_b, size in ends:
        signs = {}
        a, b = joint_a, joint_b
        while a != b:  # a parent has a lower index than its child: the higher of the two cannot be the common ancestor
            if a > b:
                signs[a], a = -1.0, parents[a]
            else:
                signs[b], b = 1.0, parents[b]
        joints = tuple(sorted(signs))
        columns = [first_column[j] + k for j in joints for k in range(widths[j])]
        velocities = [first_velocity[j] + k for j in joints for k in range(widths[j])]
        loops.append(
            Loop(
                rows=slice(row, row + size),
                spatial=size == 6,
                joint_a=joint_a,
                joint_b=joint_b,
                joints=joints,
                columns=np.array(columns, dtype=np.intp),
                velocities=np.array(velocities, dtype=np.intp),
                signs=np.array([signs[j] for j in joints for _ in range(widths[j])]),
                mimics=len(set(velocities)) < len(velocities),
            )
        )
        row += size
    return tuple(loops)


@dataclass(frozen=True, slots=True, eq=False)
class LoopGroup:
    """Loops that share joints, so that only together they can be closed.

    Attributes:
        closures: Indices of their closures, ascending.
        rows: Their rows in the stacked residual.
        velocities: Indices in v of their joints, without those held.
        coordinates: Indices in q of the same joints.
    """

    closures: tuple[int, ...]
    rows: Indices
    velocities: Indices
    coordinates: Indices


def independent_groups(robot: Robot, held: Iterable[int] = ()) -> tuple[LoopGroup, ...]:
    """The robot's loops, grouped so that no two groups have a joint in common.

    K is block diagonal in these groups: each can be solved, and its rank found, on its own.

    Args:
        robot: The robot.
        held: Indices in v that do not move, and so couple nothing.
    """
    model, loops, still = robot.model, find_loops(robot), set(held)
    owner = {  # the joint of each velocity: one that mimics another has none of its own
        velocity: joint
        for joint, (first, width) in enumerate(zip(model.idx_vs, model.nvs, strict=True))
        for velocity in range(first, first + width)
        if velocity not in still
    }
    moving = [{owner[velocity] for velocity in loop.velocities.tolist() if velocity in owner} for loop in loops]
    groups = []
    for members in _connected(moving):
        joints = sorted({joint for index in members for joint in moving[index]})
        groups.append(
            LoopGroup(
                closures=tuple(members),
                rows=_indices((loops[index].rows.start, loops[index].rows.stop) for index in members),
                velocities=_indices((model.idx_vs[j], model.idx_vs[j] + model.nvs[j]) for j in joints),
                coordinates=_indices((model.idx_qs[j], model.idx_qs[j] + model.nqs[j]) for j in joints),
            )
        )
    return tuple(groups)


def _indices(ranges: Iterable[tuple[int, int]]) -> Indices:
    return np.array([index for start, stop in ranges for index in range(start, stop)], dtype=np.intp)


def _connected(sets: Sequence[set[int]]) -> list[list[int]]:
    """Indices of the sets, grouped so that sets of two groups have nothing in common."""
    holders: dict[int, list[int]] = {}
    for index, elements in enumerate(sets):
        for element in elements:
            holders.setdefault(element, []).append(index)
    groups, seen = [], set()
    for index in range(len(sets)):
        if index in seen:
            continue
        seen.add(index)
        group = [index]
        for member in group:  # grows while it is walked
            for element in sets[member]:
                found = [other for other in holders.pop(element, ()) if other not in seen]
                seen.update(found)
                group += found
        groups.append(sorted(group))
    return groups
