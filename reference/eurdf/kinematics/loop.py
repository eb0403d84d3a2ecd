"""The joints that each constraint depends on, and which constraints can be met without the others."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Indices
from eurdf.mechanism.constraint import Constraint
from eurdf.pinocchio.ancestry import Ancestry, DisjointSets
from eurdf.pinocchio.tree import Tree

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class Chain(NamedTuple):
    """Joints on the way from one of them up to an ancestor.

    Attributes:
        joint: The lowest joint.
        above: The ancestor, which is no part of it; ``joint`` itself where there is nothing between.
    """

    joint: int
    above: int


class Loop(NamedTuple):
    """The joints that one constraint depends on.

    Attributes:
        rows: Rows of the constraint in the stacked residual.
        chains: These joints: from frames A and B up to where they meet, or each joint that a coupling relates.
    """

    rows: slice
    chains: tuple[Chain, ...]


def find_loops(robot: Robot) -> tuple[Loop, ...]:
    """Loops of the robot's constraints, in their order."""
    return robot.cached(_trace)


def _trace(robot: Robot) -> tuple[Loop, ...]:
    tree = robot.tree
    ancestry = Ancestry(tree.parents)
    loops, row = [], 0
    for constraint in robot.constraints:
        loops.append(Loop(slice(row, row + constraint.rows), _chains(constraint, tree, ancestry)))
        row += constraint.rows
    return tuple(loops)


def _chains(constraint: Constraint, tree: Tree, ancestry: Ancestry) -> tuple[Chain, ...]:
    ends = [tree.joint_of(anchor) for anchor in constraint.anchors]
    related = [tree.coordinate(name).joint for name in constraint.joints]
    between = [Chain(joint, ancestry.common(*ends)) for joint in ends]
    return (*between, *(Chain(joint, tree.parents[joint]) for joint in related))


def joints_of_loops(robot: Robot, loops: Iterable[Loop] | None = None) -> list[int]:
    """The joints that the loops, or all of a robot, depend on, in ascending order.

    The time is linear in the number of loops and of joints, however many loops share a joint.
    """
    parents = robot.tree.parents
    # For each joint found, one farther up: those in between are found too.
    beyond: dict[int, int] = {}
    for loop in find_loops(robot) if loops is None else loops:
        for chain in loop.chains:
            joint, passed = chain.joint, []
            while joint > chain.above:  # a parent has a lower index than its child
                passed.append(joint)
                joint = beyond.get(joint, parents[joint])
            for found in passed:
                beyond[found] = joint
    return sorted(beyond)


def moving_velocities(robot: Robot, closures: Iterable[int]) -> set[int]:
    """Indices in v of the velocities that move the joints of some constraints; a mimic joint is moved by its leader."""
    loops = find_loops(robot)
    joints = joints_of_loops(robot, [loops[index] for index in closures])
    return {velocity for joint in joints for velocity in robot.tree.moving_velocities[joint]}


class LoopGroup(NamedTuple):
    """Loops that share joints, so that only together they can be closed.

    Attributes:
        closures: Indices of their constraints, ascending.
        rows: Their rows in the stacked residual.
        velocities: Indices in v of their joints, without the joints of which all velocities are held.
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
    tree, loops, still = robot.tree, find_loops(robot), set(held)
    owner = {  # the joint of each velocity: one that mimics another has none of its own
        velocity: joint
        for joint, velocities in enumerate(tree.own_velocities)
        for velocity in velocities
        if velocity not in still
    }
    movers = [
        next((owner[velocity] for velocity in velocities if velocity in owner), 0)
        for velocities in tree.moving_velocities
    ]
    return tuple(
        LoopGroup(
            closures=tuple(members),
            rows=_indices(range(loops[index].rows.start, loops[index].rows.stop) for index in members),
            velocities=_indices(tree.own_velocities[joint] for joint in joints),
            coordinates=_indices(tree.own_coordinates[joint] for joint in joints),
        )
        for members, joints in _connected(loops, tree.parents, movers)
    )


def merged(groups: Sequence[LoopGroup]) -> LoopGroup:
    """Groups as one."""
    return LoopGroup(
        closures=tuple(sorted(index for group in groups for index in group.closures)),
        rows=np.sort(_indices(group.rows for group in groups)),
        velocities=np.sort(_indices(group.velocities for group in groups)),
        coordinates=np.sort(_indices(group.coordinates for group in groups)),
    )


def _indices(ranges: Iterable[Iterable[int]]) -> Indices:
    return np.array([index for each in ranges for index in each], dtype=np.intp)


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
    groups = DisjointSets(len(parents))  # of movers
    found: dict[int, None] = {}  # movers of all loops
    first: list[int] = []  # of each loop one mover; 0 where all of its joints are held
    for loop in loops:
        one = 0
        for chain in loop.chains:
            joint, passed = nearest[chain.joint], []
            while joint > chain.above:  # a parent has a lower index than its child
                passed.append(joint)
                joint = above[joint]
            for each in passed:
                above[each] = joint
                mover = movers[each]
                found[mover] = None
                one = one or mover
                groups.join(mover, one)
        first.append(one)
    members: dict[int, list[int]] = {}
    for index, mover in enumerate(first):
        # A loop none of whose joints moves is a group of its own.
        members.setdefault(groups.find(mover) if mover else -1 - index, []).append(index)
    joints: dict[int, list[int]] = {key: [] for key in members}
    for mover in sorted(found):
        joints[groups.find(mover)].append(mover)
    return [(indices, joints[key]) for key, indices in members.items()]
