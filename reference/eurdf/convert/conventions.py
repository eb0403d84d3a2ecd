"""What exports have alike: gains of position actuators, points on hinges, openings, and bodies that do not collide."""

from __future__ import annotations

from itertools import combinations, product

import numpy as np

from eurdf.array import Matrix
from eurdf.closures.kind import ClosureKind, PoseArrays
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Vector3
from eurdf.mechanism.spanning_tree import rigid_roots

#: Error at which a position actuator reaches the effort limit, rad or m; and its gain without such a limit.
FULL_EFFORT_AT, GAIN = 0.1, 100.0

#: kg and kg·m² that a link without inertia gets where the program that reads the file needs some: far below any of a
#: robot, and ten times the larger of MuJoCo's bounds; in single precision, far above 0.
LEAST, LIGHT = 1e-13, 1e-9

#: Distance of the points that hold a hinge, or a frame, where a format has constraints of points alone, m.
WIDTH = 0.1


def position_gain(effort: float) -> float:
    """Of a joint with an effort limit, N·m/rad or N/m; 0 and infinity are no limit."""
    return effort / FULL_EFFORT_AT if 0.0 < effort < float("inf") else GAIN


def point_on(unit: Vector3) -> Vector3:
    """The point at `WIDTH` on an axis."""
    return WIDTH * unit[0], WIDTH * unit[1], WIDTH * unit[2]


def opening_of(closure: Closure, a: Matrix, b: Matrix) -> tuple[float, float]:
    """How far a closure is open, m and rad, with its frames at poses (4, 4) in one frame."""
    assert isinstance(closure, ClosureKind)
    relative = np.linalg.inv(a) @ b
    poses = PoseArrays(relative[None, None, :3, :3], relative[None, None, :3, 3])
    distance, angle = closure.opening(poses, closure.prepare([closure]))
    return float(distance[0, 0]), float(angle[0, 0])


def neighbours(mechanism: Mechanism, least: float) -> list[tuple[str, str]]:
    """Pairs of bodies with collision shapes on either side of a joint or a closure, with all that is fixed to them.

    The joints on both sides of bodies without mass are one joint of several axes: what is beyond is a neighbour too.

    Args:
        mechanism: The robot.
        least: Largest mass that counts as none, kg.
    """
    root = mechanism.bodies[0].name
    rigid = rigid_roots(root, mechanism.joints)
    groups: dict[str, list[str]] = {name: [] for name in rigid.values()}
    for body in mechanism.bodies:
        if body.collisions:
            groups[rigid[body.name]].append(body.name)
    massless = {rigid[body.name] for body in mechanism.bodies} - {
        rigid[body.name] for body in mechanism.bodies if body.inertia is not None and body.inertia.mass > least
    }
    beside: dict[str, set[str]] = {}
    joined = [(joint.parent, joint.child) for joint in mechanism.joints]
    joined += [(closure.a.body, closure.b.body) for closure in mechanism.closures]
    for a, b in joined:
        one, other = rigid[a], rigid[b]
        if one != other:
            beside.setdefault(one, set()).add(other)
            beside.setdefault(other, set()).add(one)
    pairs = {frozenset((one, other)) for one in beside for other in beside[one]}
    for group in massless - {root}:
        pairs |= {frozenset(pair) for pair in combinations(beside.get(group, ()), 2)}
    order = {name: index for index, name in enumerate(groups)}
    names = list(groups)
    ranked = sorted(sorted(order[group] for group in pair) for pair in pairs)
    return [pair for first, second in ranked for pair in product(groups[names[first]], groups[names[second]])]
