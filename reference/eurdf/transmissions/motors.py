"""The motors that joints depend on, their limits, and the bodies of the linkage between them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.kinematics.assembly import assembled
from eurdf.kinematics.closing import close, start
from eurdf.kinematics.loop import independent_groups, moving_velocities
from eurdf.kinematics.problem import Problem, for_many
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import MOVES, SOLVED
from eurdf.pinocchio.memory import working_memory
from eurdf.transmissions.maps import MapsTask, maps_at, pseudoinverse
from eurdf.transmissions.selection import Selection, listed, selection

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Number of configurations near the assembled one at which dependence is tested, and how far (rad, or characteristic
# lengths) random motions lead to them. A derivative that is zero at a dead point is not zero at all of them.
_TESTS = 3
_FAR = 0.02


def sides(
    robot: Robot, joints: str | Iterable[str], motors: str | Iterable[str] | None = None
) -> tuple[Selection, Selection]:
    """The joints of a transmission and its motors, by default the actuated joints that move the joints.

    Raises:
        ValueError: A name is not right, or no actuator moves the joints.
    """
    chosen = selection(robot, joints)
    return chosen, motors_of(robot, chosen) if motors is None else selection(robot, motors, "motors")


def motors_of(robot: Robot, joints: Selection) -> Selection:
    """The actuated joints that move the given joints, in the order of the actuation.

    An actuated joint that is among the joints is its own motor. Others are moved by the actuators of their loops,
    except those that do not move them anywhere near the `assembled` configuration. The error is that of `sides`.
    """
    return robot.cached(_motors_of, joints.joints)


def _motors_of(robot: Robot, names: tuple[str, ...]) -> Selection:
    own, actuated = selection(robot, names).velocities, robot.actuation.idx_v
    by = np.isin(actuated, own)
    others = np.setdiff1d(own, actuated)
    wanted = set(others.tolist())
    in_loops = {velocity for closing, moving in driven_loops(robot) if closing & wanted for velocity in moving}
    candidates = np.isin(actuated, sorted(in_loops)) & ~by
    if candidates.any():
        by |= candidates & _moved(robot, others)
    found = dict.fromkeys(robot.tree.velocity_names[velocity] for velocity in actuated[by].tolist())
    if not found:
        raise ValueError(
            f"no actuator moves {listed(names)}; `eurdf.analyze(robot).motions` lists uncontrolled motions"
        )
    return selection(robot, found, "motors")


def springs_of(robot: Robot) -> Indices:
    """Indices in v of the joints with springs."""
    return np.unique(robot.tree.springs.idx_v)


def driven_loops(robot: Robot) -> list[tuple[set[int], set[int]]]:
    """Groups of loops while the actuators are held: the velocities that close each, and the actuated ones in it."""
    actuated = set(robot.actuation.idx_v.tolist())
    return [
        (set(group.velocities.tolist()), moving_velocities(robot, group.closures) & actuated)
        for group in independent_groups(robot, actuated)
    ]


def passive_joints_of(robot: Robot, motors: Selection) -> tuple[str, ...]:
    """The joints, not actuated, in loops that these motors move."""
    found: set[int] = set()
    for closing, moving in driven_loops(robot):
        if moving & set(motors.velocities.tolist()):
            found |= closing
    return tuple(name for name, slot in robot.slots.items() if slot.idx_v in found)


def linkage_bodies(robot: Robot, joints: Selection, motors: Selection) -> tuple[str, ...]:
    """The bodies that motors and rods add to a serial chain, in the mechanism's order: cranks, rods, pistons.

    They hang, directly or through others, from a motor or from a passive joint in the loops of the joints, unless that
    joint is one of them or lies between one of them and the root.
    """
    mechanism, slots = robot.mechanism, robot.slots
    own, inside = set(joints.velocities.tolist()), set(motors.velocities.tolist())
    for closing, _ in driven_loops(robot):
        if closing & own:
            inside |= closing
    carrier = {joint.child: joint for joint in mechanism.joints}
    kept = set(joints.joints)
    for name in joints.joints:
        joint = slots[name].joint
        while joint.parent in carrier:
            joint = carrier[joint.parent]
            kept.add(joint.name)
    leaders, found = mechanism.leaders, set()
    for joint in mechanism.joints:  # a parent comes before its children
        leader = leaders[joint.name].joint if joint.name in leaders else joint.name
        added = leader in slots and slots[leader].idx_v in inside and joint.name not in kept
        if added or joint.parent in found:
            found.add(joint.child)
    return tuple(joint.child for joint in mechanism.joints if joint.child in found)


def _stated(robot: Robot, velocities: Indices) -> tuple[Vector, Vector, Matrix]:
    """The effort limits (n,), velocity limits (n,) and control ranges (n, 2) of velocities; infinite without one."""
    control = np.tile((-np.inf, np.inf), (robot.tree.nv, 1))
    control[robot.actuation.idx_v] = robot.actuation.control
    return robot.model.upperEffortLimit[velocities], robot.model.upperVelocityLimit[velocities], control[velocities]


def motor_ranges(robot: Robot, names: Sequence[str], velocities: Indices) -> tuple[Vector, Vector, Vector]:
    """Smallest and largest torque, and largest velocity, of each motor velocity; infinite if there is no limit.

    Args:
        robot: The robot.
        names: Names (n) of the motor velocities.
        velocities: Their indices (n,) in v.

    Raises:
        ValueError: The effort or velocity limit of a motor is not positive, or its control range is not from below to
            above zero.
    """
    efforts, fastest, control = _stated(robot, velocities)
    for k in np.argsort(velocities).tolist():
        for word, limit in (("effort", efforts[k]), ("velocity", fastest[k])):
            if not limit > 0.0:
                raise ValueError(
                    f"motor '{names[k]}' has the {word} limit {limit + 0.0:g}; state a positive one: "
                    + _where(robot, word, velocities[k])
                )
        lower, upper = control[k]
        if not lower < 0.0 < upper:
            raise ValueError(
                f"motor '{names[k]}' has the control range {lower + 0.0:g} to {upper + 0.0:g}; state one from below "
                "to above zero, so that it drives both ways: control of the actuator in the description"
            )
    return np.maximum(control[:, 0], -efforts), np.minimum(control[:, 1], efforts), np.array(fastest)


def finite_ranges(robot: Robot, names: Sequence[str], velocities: Indices) -> tuple[Vector, Vector, Vector]:
    """As `motor_ranges`, of motors that all have limits.

    Raises:
        ValueError: As in `motor_ranges`, or a motor has no limit.
    """
    lowers, uppers, fastest = motor_ranges(robot, names, velocities)
    for values, word in ((np.maximum(uppers, -lowers), "effort"), (fastest, "velocity")):
        if not np.isfinite(values).all():
            k = int(np.argmin(np.isfinite(values)))
            raise ValueError(
                f"motor '{names[k]}' has no {word} limit; state one: " + _where(robot, word, velocities[k])
            )
    return lowers, uppers, fastest


def _where(robot: Robot, word: str, velocity: int) -> str:
    """Where to state a limit of a motor."""
    return (
        f"{word} in the <limit> of joint '{robot.tree.velocity_names[velocity]}', or in its limits in the description"
    )


def unlimited_motors(robot: Robot, motors: Selection) -> tuple[str, ...]:
    """The motors without an effort limit or control range, or without a velocity limit."""
    efforts, fastest, control = _stated(robot, motors.velocities)
    stated = (np.isfinite(efforts) | np.isfinite(control).all(axis=1)) & np.isfinite(fastest)
    return tuple(dict.fromkeys(robot.tree.velocity_names[velocity] for velocity in motors.velocities[~stated].tolist()))


def _moved(robot: Robot, velocities: Indices) -> Mask:
    """Which actuated velocities (nu,) move these velocities at some configurations; all if the loops do not close."""
    actuated, scale = robot.actuation.idx_v, robot.cached(TangentSpaces).scale
    task = MapsTask(for_many(robot), actuated, velocities, actuated, springs_of(robot))
    random = np.random.default_rng(0)
    found = np.zeros(len(actuated), dtype=bool)
    with working_memory(robot, Problem) as problem:
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
