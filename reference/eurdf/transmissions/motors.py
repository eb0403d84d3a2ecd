"""The motors that joints depend on."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices, Mask
from eurdf.kinematics.assembly import assembled, close, start
from eurdf.kinematics.derived import borrowed, derived
from eurdf.kinematics.loop import independent_groups, moving_velocities
from eurdf.kinematics.problem import Problem, for_many
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import MOVES, SOLVED
from eurdf.transmissions.maps import Task, maps_at, pseudoinverse
from eurdf.transmissions.selection import Selection, selection

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Number of configurations near the assembled one at which dependence is tested, and how far (rad, or characteristic
# lengths) random motions lead to them. A derivative that is zero at a dead point is not zero at all of them.
_TESTS = 3
_FAR = 0.02


def motors_of(robot: Robot, joints: Selection) -> Selection:
    """The actuated joints that move the given joints, in the order of the actuation.

    An actuated joint that is among the joints is its own motor. Others are moved by the actuators of their loops,
    except those that do not move them anywhere near the `assembled` configuration.

    Args:
        robot: The robot.
        joints: The joints.

    Raises:
        ValueError: No actuator moves the joints.
    """
    found: dict[tuple[str, ...], Selection] = derived(robot, _found)
    if joints.joints not in found:
        found[joints.joints] = _motors_of(robot, joints)
    return found[joints.joints]


def _found(robot: Robot) -> dict[tuple[str, ...], Selection]:
    """The motors by the names of joints, as far as they were looked for."""
    return {}


def _motors_of(robot: Robot, joints: Selection) -> Selection:
    actuated = robot.actuation.idx_v
    by = np.isin(actuated, joints.velocities)
    others = np.setdiff1d(joints.velocities, actuated)
    candidates = _in_loops_of(robot, others) & ~by
    if candidates.any():
        by |= candidates & _moved(robot, others)
    owner = {slot.idx_v + k: name for name, slot in robot.slots.items() for k in range(slot.nv)}
    names = dict.fromkeys(owner[velocity] for velocity in actuated[by].tolist())
    if not names:
        listed = ", ".join(f"'{name}'" for name in joints.joints)
        raise ValueError(f"no actuator moves {listed}; `eurdf.analyze(robot).motions` lists uncontrolled motions")
    return selection(robot, names, "motors")


def springs_of(robot: Robot) -> Indices:
    """Indices in v of the joints with springs."""
    return np.unique(robot.tree.springs.idx_v)


def passive_joints_of(robot: Robot, motors: Selection) -> tuple[str, ...]:
    """The joints, not actuated, in loops that these motors move."""
    found: set[int] = set()
    for own, by in driven_loops(robot):
        if by & set(motors.velocities.tolist()):
            found |= own
    return tuple(name for name, slot in robot.slots.items() if slot.idx_v in found)


def _in_loops_of(robot: Robot, velocities: Indices) -> Mask:
    """Which actuated velocities (nu,) move loops that these velocities close while the actuators are held."""
    wanted = set(velocities.tolist())
    found = {velocity for own, by in driven_loops(robot) if own & wanted for velocity in by}
    return np.isin(robot.actuation.idx_v, sorted(found))


def driven_loops(robot: Robot) -> list[tuple[set[int], set[int]]]:
    """Groups of loops while the actuators are held: the velocities that close each, and the actuated ones in it."""
    actuated = set(robot.actuation.idx_v.tolist())
    return [
        (set(group.velocities.tolist()), moving_velocities(robot, group.closures) & actuated)
        for group in independent_groups(robot, actuated)
    ]


def _moved(robot: Robot, velocities: Indices) -> Mask:
    """Which actuated velocities (nu,) move these velocities at some configurations; all if the loops do not close."""
    actuated, scale = robot.actuation.idx_v, derived(robot, TangentSpaces).scale
    task = Task(for_many(robot), actuated, velocities, actuated, springs_of(robot))
    random = np.random.default_rng(0)
    found = np.zeros(len(actuated), dtype=bool)
    with borrowed(robot, Problem) as problem:
        assembly = assembled(problem, start(robot), SOLVED)
        if not assembly.closes:
            return ~found
        q = assembly.q
        if maps_at(robot, task, q)[0].blocked[0]:
            task = replace(task, springs=np.empty(0, np.intp))
        for _ in range(_TESTS):
            _, Q = maps_at(robot, task, q)
            step = Q @ random.uniform(-1.0, 1.0, Q.shape[1])
            step *= _FAR / max(np.abs(step).max(initial=0.0), _FAR)
            near = close(problem, robot.tree.integrate(q, scale * step)[None])
            _, Q = maps_at(robot, task, near.q[0] if near.closes[0] else q)
            inverse, _ = pseudoinverse(Q[None, actuated])
            found |= (np.abs(Q[velocities] @ inverse[0]) > MOVES).any(axis=0)
    return found
