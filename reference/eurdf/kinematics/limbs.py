"""How the constraints of a large robot divide it into limbs, which share a trunk alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from eurdf.kinematics.loop import Loop, find_loops
from eurdf.pinocchio.ancestry import DisjointSets
from eurdf.pinocchio.tree_few import BUNDLED

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Up to so many velocities, all at once takes less time than limb by limb.
MOST_VELOCITIES_OF_A_LIMB = 64
# Each velocity of the trunk is a column to solve for.
_LARGEST_TRUNK = 12


class LimbJoints(NamedTuple):
    """A limb.

    Attributes:
        joints: Its joints, ascending, with all that carry them.
        constraints: Indices of its constraints.
    """

    joints: tuple[int, ...]
    constraints: tuple[int, ...]


def find_limbs(robot: Robot) -> tuple[LimbJoints, ...]:
    """The limbs of a robot; none if it is small, or has no trunk of few velocities."""
    tree, trunk = robot.tree, set[int]()
    if tree.nv <= MOST_VELOCITIES_OF_A_LIMB or any(not own for own in tree.own_velocities[1:]):
        return ()
    if not all(_moving(loop) for loop in find_loops(robot)):
        return ()
    while True:
        parts = _parts(robot, trunk)
        largest = max(parts, key=lambda part: _size(robot, part.joints))
        roots = [joint for joint in largest.joints if tree.parents[joint] in trunk or not tree.parents[joint]]
        if _size(robot, largest.joints) <= MOST_VELOCITIES_OF_A_LIMB:
            break
        if len(roots) > 1 or _size(robot, [*trunk, *roots]) > _LARGEST_TRUNK:
            return ()
        trunk.update(roots)
    bundles: list[LimbJoints] = []
    size = 0
    for part in parts:
        size += _size(robot, part.joints)
        if bundles and size <= BUNDLED:
            bundles[-1] = LimbJoints(bundles[-1].joints + part.joints, bundles[-1].constraints + part.constraints)
        else:
            bundles.append(part)
            size = _size(robot, part.joints)
    return tuple(_with_trunk(robot, part) for part in bundles) if len(bundles) > 1 else ()


def _size(robot: Robot, joints: tuple[int, ...] | list[int]) -> int:
    return sum(len(robot.tree.own_velocities[joint]) for joint in joints)


def _moving(loop: Loop) -> list[int]:
    """The lowest joints that a constraint depends on."""
    return [chain.joint for chain in loop.chains if chain.joint > chain.above]


def _with_trunk(robot: Robot, part: LimbJoints) -> LimbJoints:
    """The same with the joints that carry it."""
    joints = set(part.joints)
    for joint in part.joints:
        above = robot.tree.parents[joint]
        while above and above not in joints:
            joints.add(above)
            above = robot.tree.parents[above]
    return LimbJoints(tuple(sorted(joints)), tuple(sorted(part.constraints)))


def _parts(robot: Robot, trunk: set[int]) -> list[LimbJoints]:
    """The joints outside of the trunk, in parts that neither a joint nor a constraint connects."""
    tree = robot.tree
    sets = DisjointSets(len(tree.parents))  # of joints
    for joint, parent in enumerate(tree.parents):
        if parent and joint not in trunk and parent not in trunk:
            sets.join(joint, parent)
    lowest: list[int] = []
    for loop in find_loops(robot):
        first, *others = _moving(loop)
        lowest.append(first)
        for joint in others:
            sets.join(joint, first)
    joints: dict[int, list[int]] = {}
    for joint in range(1, len(tree.parents)):
        if joint not in trunk:
            joints.setdefault(sets.find(joint), []).append(joint)
    constraints: dict[int, list[int]] = {}
    for index, joint in enumerate(lowest):
        constraints.setdefault(sets.find(joint), []).append(index)
    return [LimbJoints(tuple(own), tuple(constraints.get(key, ()))) for key, own in joints.items()]
