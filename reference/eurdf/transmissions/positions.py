"""Positions of motors for positions of joints, and back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Vector
from eurdf.diagnostics.wording import enumerated
from eurdf.errors import NoTransmission, OutOfReach
from eurdf.kinematics.assembly import assemble, closed_start
from eurdf.kinematics.closing import start
from eurdf.kinematics.forward import farthest
from eurdf.kinematics.named import Named
from eurdf.kinematics.position_limit import position_limits
from eurdf.kinematics.problem import Problem
from eurdf.kinematics.tolerances import SOLVED
from eurdf.loading import of_any_robot
from eurdf.mechanism.joint import LIMIT_TOLERANCE
from eurdf.pinocchio.arguments import checked_array
from eurdf.pinocchio.memory import working_memory
from eurdf.transmissions.motors import motors_of, passive_joints_of
from eurdf.transmissions.selection import Selection, selection
from eurdf.transmissions.transmission import at_one, require

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot


class Positions(NamedTuple):
    """The result of `actuator_values` and `joint_values`.

    Attributes:
        values: The positions, by joint, rad or m.
        q: The closed configuration (nq,) they belong to: where to start for the next values.
        beyond: Joints whose coordinate there is beyond a position limit.
    """

    values: dict[str, float]
    q: Vector
    beyond: tuple[str, ...]

    def __repr__(self) -> str:
        values = ", ".join(f"{name} {value + 0.0:.6g}" for name, value in self.values.items())
        beyond = f"; beyond their limits: {enumerated(self.beyond)}" if self.beyond else ""
        return f"<Positions: {values} rad or m{beyond}>"


@of_any_robot
def actuator_values(robot: Robot, joints: Mapping[str, float], q0: Named | None = None) -> Positions:
    """Positions of the motors at which joints have the given positions.

    The joints move from q0 along a straight path, and the motors follow on the branch of q0; other actuators stay where
    they are. Position limits do not stop them; the result names the joints beyond theirs.

    Args:
        robot: The robot.
        joints: By joint, its position, rad or m. The joints decide the positions of the motors that move them.
        q0: Where to start (nq,). The default is the `assembled` configuration, or the neutral one if there is none.

    Returns:
        The positions of these motors, in the order of ``robot.actuation``, and the configuration.

    Raises:
        OutOfReach: The loops cannot be closed at these positions, or not on a straight path to them.
        NotClosable: The loops cannot be closed at q0.
        NoTransmission: These joints do not determine the motors; the error names joints to add.
        ValueError: A name or a value is not right.
    """
    given = _single(robot, joints, "joints")
    motors = motors_of(robot, given)
    q = _moved(robot, given, motors, joints, q0)
    at = at_one(robot, given, q, motors)
    if at.missing:
        raise NoTransmission("the motor position", at.reason or "")
    return _positions(robot, motors.joints, q)


@of_any_robot
def joint_values(
    robot: Robot, motors: Mapping[str, float], q0: Named | None = None, *, joints: str | Iterable[str] | None = None
) -> Positions:
    """Positions of joints at which the motors have the given positions; the inverse of `actuator_values`.

    The motors move from q0 along a straight path, and the joints follow on the branch of q0; other actuators stay where
    they are.

    Args:
        robot: The robot.
        motors: By actuated joint, its position, rad or m.
        q0: As in `actuator_values`.
        joints: Joints to return, each with one coordinate. By default all passive ones in the loops of these motors
            whose position the actuators decide.

    Raises:
        OutOfReach: As in `actuator_values`.
        NotClosable: As in `actuator_values`.
        NoTransmission: The actuators do not decide the position of one of ``joints``.
        ValueError: A name or a value is not right.
    """
    given = _single(robot, motors, "motors")
    passive = next((name for name in given.joints if name not in robot.actuation.joints), None)
    if passive is not None:
        actuated = ", ".join(robot.actuation.joints)
        raise ValueError(f"'{passive}' is not an actuated joint; these are: {actuated}")
    q = _moved(robot, given, given, motors, q0)
    if joints is None:
        return _positions(robot, _decided(robot, passive_joints_of(robot, given), q), q)
    names = selection(robot, joints).joints
    chosen = _single(robot, dict.fromkeys(names, 0.0), "joints")
    at = at_one(robot, chosen, q, _all_motors(robot))
    if at.undetermined:
        require(at, "B_J")
    return _positions(robot, names, q)


def _single(robot: Robot, values: Mapping[str, float], argument: str) -> Selection:
    """The joints that values are given for, each with one coordinate."""
    if not isinstance(values, Mapping):
        raise ValueError(f"{argument} has no names; it must be a mapping of names to positions")
    chosen = selection(robot, tuple(values), argument)
    several = next((name for name in chosen.joints if robot.slots[name].nv > 1), None)
    if several is not None:
        raise ValueError(f"joint '{several}' has {robot.slots[several].nv} coordinates; give joints with one")
    return chosen


def _all_motors(robot: Robot) -> Selection:
    single = [name for name in robot.actuation.joints if robot.slots[name].nv == 1]
    return selection(robot, single, "motors")


def _moved(robot: Robot, chosen: Selection, motors: Selection, values: Mapping[str, float], q0: Named | None) -> Vector:
    """The configuration (nq,) with these values, and the actuators that are not ``motors`` where they are at q0."""
    wanted = {name: checked_array(f"the value of '{name}'", values[name], (), (1,)).item() for name in chosen.joints}
    with working_memory(robot, Problem) as problem:
        first = closed_start(problem, start(robot, q0), SOLVED)
    at = robot.joint_positions(first)
    moved = {*motors.joints, *wanted}
    given: dict[str, Sequence[float]] = {name: at[name] for name in robot.actuation.joints if name not in moved}
    given |= {name: (value,) for name, value in wanted.items()}
    q, part = farthest(robot, given, first)
    if part < 1.0:
        at = robot.joint_positions(q)
        reached = {name: at[name][0] for name in wanted}
        least = assemble(robot, robot.configuration({**at, **given}), hold=wanted)
        raise OutOfReach(wanted, reached, part, least.open, least.q)
    return q


def _decided(robot: Robot, candidates: Iterable[str], q: Vector) -> tuple[str, ...]:
    """Those of the joints with one coordinate that the actuators decide."""
    names = tuple(name for name in candidates if robot.slots[name].nv == 1)
    if not names:
        return ()
    at = at_one(robot, selection(robot, names), q, _all_motors(robot))
    return tuple(name for name in names if name not in at.undetermined)


def beyond_limits(robot: Robot, q: Vector) -> tuple[str, ...]:
    """Names of the joints with a coordinate beyond a position limit at q (nq,)."""
    limits = position_limits(robot)
    outside = (limits.excess(q).reshape(2, -1) > LIMIT_TOLERANCE).any(axis=0)
    return tuple(dict.fromkeys(limits.joints[index] for index in np.flatnonzero(outside).tolist()))


def _positions(robot: Robot, names: Iterable[str], q: Vector) -> Positions:
    at = robot.joint_positions(q)
    return Positions({name: at[name][0] for name in names}, q, beyond_limits(robot, q))
