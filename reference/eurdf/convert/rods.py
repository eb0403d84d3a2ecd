"""Robots without the ball joints of their rods, for programs that have none.

A ball joint and a 6d closure become a 3d closure, as in `eurdf.simplify`: the motion stays the same. The ball joint at
the other end of a rod becomes a universal joint. The motion of all other links stays the same, but the rod no longer
turns about its own line.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from eurdf.closures.point import PointClosure
from eurdf.convert.losses import Losses
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import AXES, Pose, Vector3, X, turn_from_x
from eurdf.pinocchio.robot import Robot, build_robot
from eurdf.writing.rewriting import MechanismTree, Positions
from eurdf.writing.simplification import simplified

_UNIVERSAL = JointType("universal")

#: Largest distance of the centre of mass from the line of a rod, relative to its length: gravity turns others.
_STRAIGHT = 0.01

_Configurations = dict[str, Mapping[str, tuple[float, ...]]]


def without_balls_of_rods(
    robot: Robot, configurations: _Configurations, losses: Losses
) -> tuple[Robot, _Configurations]:
    """The robot with 3d closures and universal joints in place of the passive ball joints of its rods.

    The angles of a universal joint are 0 at the first configuration, and ±π/2 where the rod is along one of its axes.

    Args:
        robot: The robot.
        configurations: Its configurations by name, as files have them; the first is the one to start from.
        losses: Gets what became of each of these ball joints.

    Returns:
        The robot and its configurations; what was given if there are no such joints.
    """
    closed = simplified(robot.mechanism, only="closures")
    tree = MechanismTree(closed.mechanism)
    found = {name: closed.converted(positions) for name, positions in configurations.items()}
    for joint in robot.mechanism.joints:
        if joint.type != tree.joints[joint.name].type:
            losses.add("export-rod-closure", joint.name)
    joints = []
    for ball in tree.mechanism.joints:
        line = _line(tree, ball)
        if line is not None:
            losses.add("export-rod-universal", ball.name)
            turn = Pose(quaternion=turn_from_x(line))
            zero = ball.transform(next(iter(found.values()), {}).get(ball.name, ball.type.neutral))
            joints.append(_universal(ball, zero, turn))
            found = {name: _with_angles(ball, zero, turn, positions) for name, positions in found.items()}
    if not joints and closed.mechanism is robot.mechanism:
        return robot, configurations
    numbers: _Configurations = {name: {key: tuple(c) for key, c in each.items()} for name, each in found.items()}
    stated = {name: numbers[name] for name in robot.mechanism.configurations}
    return build_robot(tree.rebuilt(joints, configurations=stated), geometry=False), numbers


def _line(tree: MechanismTree, ball: Joint) -> Vector3 | None:
    """From the centre of a ball joint to the other end of the rod that it carries, m, in the joint's moving frame.

    A rod is a rigid body that one 3d closure holds, and nothing else; its centre of mass is on the line of its ends.
    """
    links = tree.below(ball.child)
    ends = [(closure, end) for closure in tree.mechanism.closures for end in closure.anchors if end.body in links]
    if not ball.type.is_ball or ball.name in tree.why_not or not tree.is_rigid(links) or len(ends) != 1:
        return None
    ((closure, end),) = ends
    line = (ball.offset * tree.rigid[end.body][1] * end.pose).xyz
    length = math.hypot(*line)
    if type(closure) is not PointClosure or not length:
        return None
    moment = [0.0, 0.0]  # of the masses, across the line, kg·m
    for inertia, at in ((tree.links[name].inertia, ball.offset * tree.rigid[name][1]) for name in links):
        if inertia is not None:
            _, *across = Pose(quaternion=turn_from_x(line)).inverse().rotate((at * inertia.pose).xyz)
            moment = [sum_ + inertia.mass * value for sum_, value in zip(moment, across, strict=True)]
    return line if math.hypot(*moment) <= _STRAIGHT * length * tree.mass(*links) else None


def _universal(ball: Joint, zero: Pose, turn: Pose) -> Joint:
    """The universal joint about two axes across the rod, which ``turn`` has turned from x to its line."""
    return replace(
        ball,
        type=_UNIVERSAL,
        placement=ball.placement * zero,
        axes=tuple(map(turn.rotate, AXES[1:])),
        properties=JointProperties.unlimited(_UNIVERSAL),
    )


def _with_angles(ball: Joint, zero: Pose, turn: Pose, positions: Positions) -> Positions:
    """Positions with the angles of `_universal`, rad, in place of the quaternion of the ball."""
    now = ball.transform(positions.get(ball.name, ball.type.neutral))
    along, first, second = (turn.inverse() * zero.inverse() * now * turn).rotate(X)
    return {**positions, ball.name: (math.atan2(-second, along), math.atan2(first, math.hypot(along, second)))}
