"""Joints that a solver does not move: which, where, and of ball joints about which axes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from eurdf.array import Vector
from eurdf.closures.turn import HeldTurn
from eurdf.kinematics.closing import start
from eurdf.kinematics.named import Named, configuration_of
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.joint import Joint
from eurdf.pinocchio.arguments import are_by_name
from eurdf.pinocchio.robot import Robot

#: Names of joints, or one; of a ball joint also its name and the axes about which it does not turn: ``("hip", "z")``.
Hold = str | Iterable[str | tuple[str, str]]


class Holding(NamedTuple):
    """A robot with held joints.

    Attributes:
        robot: The robot, which has a constraint more for each held axis of a ball joint.
        joints: Names of the joints that do not move at all.
        q: Where it starts (nq,): these joints are where they are held.
    """

    robot: Robot
    joints: tuple[str, ...]
    q: Vector


def held_in_turn(robot: Robot, stated: Iterable[str]) -> Iterator[tuple[str, ...]]:
    """What to hold, in turn, to keep of a configuration what it states: all its joints, the motors of them, nothing."""
    names = tuple(name for name in stated if name in robot.slots)
    motors = tuple(name for name in names if name in robot.actuation.joints)
    yield from dict.fromkeys((names, motors, ()))


def holding(robot: Robot, q: Vector, hold: Hold, hold_at: Named | None) -> Holding:
    """Hold joints of a robot that starts at q (nq,).

    Args:
        robot: The robot.
        q: Where it starts.
        hold: What does not move.
        hold_at: Where that is, if it is not at q; of joints by name, those that are not named are at q.

    Raises:
        ValueError: There is no such joint, it has no such axes, or ``hold_at`` is no configuration.
    """
    if hold_at is not None and are_by_name(hold_at):
        hold_at = configuration_of(robot, {**robot.joint_positions(q), **hold_at}, "hold_at")
    at = q if hold_at is None else start(robot, hold_at, "hold_at")
    turns: list[HeldTurn] = []
    joints: list[str] = []
    for given in [hold] if isinstance(hold, str) else hold:
        name, axes = (given, "xyz") if isinstance(given, str) else given
        robot.tree.velocities_of(name)  # refuses a name that no joint has
        if axes == "xyz":
            joints.append(name)
        else:
            turns += _turns(robot, name, axes, at)
    if hold_at is not None:
        if not (joints or turns):
            raise ValueError("hold_at is given, but hold names no joint")
        held = {velocity for name in joints for velocity in robot.tree.velocities_of(name)}
        q = np.array(q)
        for velocities, coordinates in zip(robot.tree.own_velocities, robot.tree.own_coordinates, strict=True):
            if held & set(velocities):
                q[list(coordinates)] = at[list(coordinates)]
    if turns:
        closures = (*robot.mechanism.closures, *turns)
        robot = Robot(replace(robot.mechanism, closures=closures), robot.model)  # a model that was changed stays so
    return Holding(robot, tuple(joints), q)


def _turns(robot: Robot, name: str, axes: str, at: Vector) -> list[HeldTurn]:
    """The constraints of a ball joint that does not turn about axes of its own, from where it is at a configuration."""
    joint: Joint | None = robot.slots[name].joint if name in robot.slots else None
    if joint is None or not joint.type.is_ball:
        raise ValueError(
            f"hold: '{name}' is no spherical joint, and only such a joint is held about axes; give its name"
        )
    if not axes or set(axes) - set("xyz") or len(set(axes)) < len(axes):
        raise ValueError(f"hold: the axes of '{name}' are {axes!r}; expected one or two of x, y and z, such as 'z'")
    slot = robot.slots[name]
    there = joint.transform(at[slot.idx_q : slot.idx_q + slot.nq].tolist())
    a, b = Anchor(joint.parent, joint.placement * there), Anchor(joint.child, joint.offset.inverse())
    return [HeldTurn(f"{name} about {axis}", a, b, axis="xyz".index(axis)) for axis in axes]
