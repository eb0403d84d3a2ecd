"""The loops that the closures make with the spanning tree, and which of them can move without the others."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.kinematics.ancestry import Ancestry
from eurdf.kinematics.array import Indices, Vector
from eurdf.kinematics.derived import derived

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class Path(NamedTuple):
    """The joints of a loop, and where their columns and velocities are.

    Attributes:
        joints: Joints of the path, both sides, without the common ancestor, in ascending order.
        columns: Columns (n,) of the path's joints in Pinocchio's world Jacobian ``data.J``, in which a joint that
            mimics another has columns of its own.
        velocities: Index (n,) in v of each of these columns; one index stands twice where a joint mimics another
            of the path.
        signs: +1 for the columns (n,) that move B, -1 for those that move A.
        mimics: Whether an index stands twice in ``velocities``.
    """

    joints: tuple[int, ...]
    columns: Indices
    velocities: Indices
    signs: Vector
    mimics: bool


class _Tree(NamedTuple):
    """Of each joint of a model: its parent, and where its columns and velocities begin, and how many there are."""

    parents: list[int]
    first_column: list[int]
    width: list[int]
    first_velocity: list[int]


@dataclass(frozen=True, eq=False)
class Loop:
    """One closure's loop: the path through the tree from frame A to frame B.

    Attributes:
        rows: Rows of the closure in the stacked residual.
        spatial: True for a 6d closure, False for a 3d one.
        joint_a: Joint of the model that carries frame A; 0 is the universe.
        joint_b: Joint that carries frame B.
        common: The lowest joint that is an ancestor of both, or one of the two.
    """

    rows: slice
    spatial: bool
    joint_a: int
    joint_b: int
    common: int
    _tree: _Tree

    @cached_property
    def path(self) -> Path:
        """The path, found when first asked for: thousands of loops of thousands of joints take gigabytes."""
        parents, first_column, width, first_velocity = self._tree
        signs = {}
        for joint, sign in ((self.joint_a, -1.0), (self.joint_b, 1.0)):
            while joint != self.common:
                signs[joint] = sign
                joint = parents[joint]
        joints = tuple(sorted(signs))
        velocities = [first_velocity[j] + k for j in joints for k in range(width[j])]
        return Path(
            joints,
            np.array([first_column[j] + k for j in joints for k in range(width[j])], dtype=np.intp),
            np.array(velocities, dtype=np.intp),
            np.array([signs[j] for j in joints for _ in range(width[j])]),
            mimics=len(set(velocities)) < len(velocities),
        )


def find_loops(robot: Robot) -> tuple[Loop, ...]:
    """Loops of the robot's closures, in their order."""
    return derived(robot, _trace)


def _trace(robot: Robot) -> tuple[Loop, ...]:
    model = robot.model
    ends = [(found.joint1_id, found.joint2_id, found.residualSize()) for found in robot.constraint_models]
    tree = _Tree(list(model.parents), list(model.idx_vExtendeds), list(model.nvExtendeds), list(model.idx_vs))
    ancestry = Ancestry(tree.parents)
    loops, row = [], 0
    for joint_a, joint_b, size in ends:
        rows = slice(row, row + size)
        loops.append(Loop(rows, size == 6, joint_a, joint_b, ancestry.common(joint_a, joint_b), tree))
        row += size
    return tuple(loops)


def joints_of_loops(loops: Iterable[Loop], parents: Sequence[int]) -> list[int]:
    """The joints of the loops' paths, in ascending order; ``parents`` has the parent of each joint.

    The time is linear in the number of loops and of joints, however many loops share a joint.
    """
    # For each joint found, one farther up: those in between are found too.
    beyond: dict[int, int] = {}
    for loop in loops:
        for joint in (loop.joint_a, loop.joint_b):
            passed = []
            while joint > loop.common:  # a parent has a lower index than its child
                passed.append(joint)
                joint = beyond.get(joint, parents[joint])
            for found in passed:
                beyond[found] = joint
    return sorted(beyond)


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
    first_velocity, first_coordinate = list(model.idx_vs), list(model.idx_qs)
    nv, nq = list(model.nvs), list(model.nqs)
    owner = {  # the joint of each velocity: one that mimics another has none of its own
        velocity: joint
        for joint, (first, width) in enumerate(zip(first_velocity, nv, strict=True))
        for velocity in range(first, first + width)
        if velocity not in still
    }
    movers = [
        next((owner[velocity] for velocity in range(first, first + width) if velocity in owner), 0)
        for first, width in zip(first_velocity, model.nvExtendeds, strict=True)
    ]
    groups = []
    for members, joints in _connected(loops, list(model.parents), movers):
        groups.append(
            LoopGroup(
                closures=tuple(members),
                rows=_indices((loops[index].rows.start, loops[index].rows.stop) for index in members),
                velocities=_indices((first_velocity[j], first_velocity[j] + nv[j]) for j in joints),
                coordinates=_indices((first_coordinate[j], first_coordinate[j] + nq[j]) for j in joints),
            )
        )
    return tuple(groups)


def _indices(ranges: Iterable[tuple[int, int]]) -> Indices:
    return np.array([index for start, stop in ranges for index in range(start, stop)], dtype=np.intp)


def _connected(
    loops: Sequence[Loop], parents: Sequence[int], movers: Sequence[int]
) -> list[tuple[list[int], list[int]]]:
    """Indices of the loops, grouped so that no two groups have a mover in common, and the movers of each group.

    The time is nearly linear in the number of loops and of joints, however many loops share a joint.

    Args:
        loops: The loops.
        parents: The parent of each joint.
        movers: For each joint, the joint whose velocities move it; 0 where it is held.
    """
    # The nearest joint on the way to the root, itself included, that moves; 0 where none does.
    nearest: list[int] = []
    for joint, parent in enumerate(parents):
        nearest.append(joint if movers[joint] else nearest[parent] if joint else 0)
    above = [nearest[parent] for parent in parents]  # the next of them: later one beyond others of the same group
    leader = list(range(len(parents)))  # by mover: a union-find forest

    def find(mover: int) -> int:
        while leader[mover] != mover:
            leader[mover] = leader[leader[mover]]
            mover = leader[mover]
        return mover

    found: dict[int, None] = {}  # movers of all loops
    first: list[int] = []  # of each loop one mover; 0 where all of its joints are held
    for loop in loops:
        one = 0
        for end in (loop.joint_a, loop.joint_b):
            joint, passed = nearest[end], []
            while joint > loop.common:  # a parent has a lower index than its child
                passed.append(joint)
                joint = above[joint]
            for each in passed:
                above[each] = joint
                mover = movers[each]
                found[mover] = None
                one = one or mover
                leader[find(mover)] = find(one)
        first.append(one)

    members: dict[int, list[int]] = {}
    for index, mover in enumerate(first):
        # A loop none of whose joints moves is a group of its own.
        members.setdefault(find(mover) if mover else -1 - index, []).append(index)
    joints: dict[int, list[int]] = {key: [] for key in members}
    for mover in sorted(found):
        joints[find(mover)].append(mover)
    return [(indices, joints[key]) for key, indices in members.items()]
