"""Closed-loop forward kinematics: coordinates of some joints are given, those of the others are computed."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices, Vector
from eurdf.kinematics.assembly import Assembler, start
from eurdf.kinematics.derived import borrowed, derived
from eurdf.kinematics.driven_motion import DrivenMotion
from eurdf.kinematics.exceptions import NotClosable, TooFar
from eurdf.kinematics.residual import all_openings, residual_and_jacobian
from eurdf.kinematics.spring_equilibrium import joints_at_rest, spring_equilibrium
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.arguments import checked_array, checked_tolerance

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: A step along the path is accepted if closing the loops after it moves the joints by this fraction of it at most,
MOST_CORRECTION = 0.25
#: or by this much (rad, or characteristic lengths).
LEAST_CORRECTION = 1e-6
#: If not, the step is halved, down to this fraction of the path.
SHORTEST_STEP = 2.0**-10
# The same where the springs are kept at rest: if that takes many steps, they are brought into equilibrium afterwards.
SHORTEST_STEP_AT_REST = 2.0**-3
#: Bound of the motion of each joint in one step (rad, or characteristic lengths).
LONGEST_MOTION = 0.5
# A direction counts as blocked if the other joints would have to move this many times faster than the given ones.
_FASTEST = 1e6


def forward_kinematics(
    robot: Robot,
    actuated: Vector | Mapping[str, float | Sequence[float]],
    q0: Vector | None = None,
    *,
    tolerance: float = 1e-10,
) -> Vector:
    """The closed configuration at which the actuated joints have the given coordinates.

    It solves r(q) = 0 with the given coordinates held, on the branch of q0. The given joints move from q0 to their
    coordinates along a straight (shortest) path. The other joints follow with v = Z (S_hᵀ Z)⁺ v_h, where K Z = 0, in
    steps that are short enough to stay on the branch; `assemble` closes the loops after each step. Motions that the
    given joints do not control are minimal in each step and depend on the path. To find a closed configuration on any
    branch, call `assemble` with ``hold``.

    If the joints have springs, they decide the motions that they act on and the given joints do not control: in the
    result, their energy is at a local minimum. Gravity and other forces are left out. So each spring is at rest where
    the loops allow it, and the result does not depend on the stiffness there.

    Source: `closedLoopForwardKinematics` of the toolbox of Batto, De Matteïs and Mansard, 2025.

    Args:
        robot: The robot.
        actuated: The actuated coordinates, as `split_configuration` returns them. Or a mapping from the names of any
            joints, actuated or not, to their coordinates as in files: one number, or a sequence of several. Joints that
            are not named follow.
        q0: Where to start (nq,). It determines the branch and the coordinates of the joints that nothing moves. The
            loops are closed first if they are open. The default is the `assembled` configuration, or the neutral one if
            there is none.
        tolerance: Bound of each row of the residual for closed loops, m or rad.

    Returns:
        q (nq,), in which the given joints have exactly the given coordinates.

    Raises:
        NotClosable: The loops cannot be closed at q0, or at the given coordinates.
        TooFar: They can, but not everywhere on the straight path from q0 to the given coordinates. Call the function
            for intermediate configurations one after the other.
        ValueError: ``actuated`` or ``q0`` does not fit this robot.
    """
    tolerance = checked_tolerance(tolerance)
    with borrowed(robot, Assembler) as assembler:
        first = _closed(assembler, start(robot, q0), tolerance)
    given = _given(robot, actuated)
    goal = np.array(first)
    goal[given.coordinates] = given.values
    goal = start(robot, goal, "actuated")
    given = replace(given, values=goal[given.coordinates])
    if (resting := _with_springs_at_rest(robot, given, first, tolerance)) is not None:
        return resting
    velocities = tuple(given.velocities.tolist())
    with borrowed(robot, Assembler, tuple(given.joints)) as assembler, borrowed(robot, DrivenMotion, velocities) as by:
        assembler.tolerance, assembler.limits = tolerance, None
        q, part = _follow(robot, given, first, goal, assembler, by, SHORTEST_STEP)
        if part < 1.0:
            raise _stopped(robot, assembler, q, goal, given.coordinates)
        return _in_equilibrium(robot, q, given, assembler)


def farthest(
    robot: Robot, values: Mapping[str, float | Sequence[float]], first: Vector, shortest: float = SHORTEST_STEP
) -> tuple[Vector, float]:
    """As `forward_kinematics`, but it returns how far the straight path leads if it ends early.

    Args:
        robot: The robot.
        values: By joint, its coordinates as in files.
        first: A closed configuration (nq,), to start from.
        shortest: Smallest step, as a part of the path.

    Returns:
        The configuration (nq,), and the part of the path that leads there; 1 if it leads to the given coordinates.

    Raises:
        ValueError: ``values`` does not fit this robot.
    """
    given = _given_by_name(robot, values)
    if (resting := _with_springs_at_rest(robot, given, first, 1e-10)) is not None:
        return resting, 1.0
    goal = np.array(first)
    goal[given.coordinates] = given.values
    velocities = tuple(given.velocities.tolist())
    with borrowed(robot, Assembler, tuple(given.joints)) as assembler, borrowed(robot, DrivenMotion, velocities) as by:
        assembler.tolerance, assembler.limits = 1e-10, None
        q, part = _follow(robot, given, first, goal, assembler, by, shortest)
        return _in_equilibrium(robot, q, given, assembler), part


def _with_springs_at_rest(robot: Robot, given: _Given, first: Vector, tolerance: float) -> Vector | None:
    """The result if every spring can be at rest on the way: a configuration (nq,) of no energy, of which none is less.

    The joints with springs are then given, too. None if the loops may not let them rest.
    """
    resting = joints_at_rest(robot, given.velocities)
    if resting is None:
        return None
    both = _Given(
        (*given.joints, *resting.joints),
        np.concatenate((given.coordinates, resting.coordinates)),
        np.concatenate((given.velocities, resting.velocities)),
        np.concatenate((given.values, resting.values)),
    )
    goal = np.array(first)
    goal[both.coordinates] = both.values
    velocities = tuple(both.velocities.tolist())
    with borrowed(robot, DrivenMotion, velocities) as by, borrowed(robot, Assembler, both.joints) as assembler:
        assembler.tolerance, assembler.limits = tolerance, None
        q, part = _follow(robot, both, first, goal, assembler, by, SHORTEST_STEP_AT_REST, sure=True)
    return q if part == 1.0 else None


def _in_equilibrium(robot: Robot, q: Vector, given: _Given, assembler: Assembler) -> Vector:
    if not len(robot.tree.springs):
        return q
    return spring_equilibrium(robot, q, given.velocities, given.coordinates, assembler)


def _closed(assembler: Assembler, q: Vector, tolerance: float) -> Vector:
    """The start, closed.

    Raises:
        NotClosable: The loops cannot be closed there.
    """
    assembler.tolerance, assembler.limits = tolerance, None
    closed = assembler.closed(q)
    if closed is not None:
        return closed
    first = assembler.assemble(q)
    if not first.closes:
        raise NotClosable("no closed configuration was found near the start", first.open, first.q)
    return first.q


def _follow(
    robot: Robot,
    given: _Given,
    first: Vector,
    goal: Vector,
    assembler: Assembler,
    driven: DrivenMotion,
    shortest: float,
    sure: bool = False,
) -> tuple[Vector, float]:
    """Move the given joints from the first configuration toward the goal; where they get, and the part of the path.

    If it is to be sure, they stop where the loops may block them.
    """
    tree, scale = robot.tree, derived(robot, TangentSpaces).scale
    path = tree.difference(first, goal)  # zero except for the given joints
    q, done, step = first, 0.0, 1.0
    while done < 1.0:
        step = min(step, 1.0 - done)
        v = driven.velocity(q, step * path[given.velocities])
        if v is None:
            if sure:
                return q, done
            v = _blocked_velocity(robot, q, given, step * path[given.velocities])
        motion = v / scale
        if np.abs(motion).max(initial=0.0) > LONGEST_MOTION and step > shortest:
            step *= 0.5
            continue
        at = goal if done + step >= 1.0 else tree.integrate(first, (done + step) * path)
        expected = tree.integrate(q, v)
        expected[given.coordinates] = at[given.coordinates]
        closed = assembler.closed(expected)
        if closed is None:
            assembly = assembler.assemble(expected, restarts=0)
            closed = assembly.q if assembly.closes else None
        if closed is not None:
            corrected = float(np.linalg.norm(tree.difference(expected, closed) / scale))
            if corrected <= max(MOST_CORRECTION * float(np.linalg.norm(motion)), LEAST_CORRECTION):
                q, done, step = closed, done + step, 2.0 * step
                continue
        step *= 0.5
        if step < shortest:
            return q, done
    return q, 1.0


def _blocked_velocity(robot: Robot, q: Vector, given: _Given, driven: Vector) -> Vector:
    """The velocity (nv,) whose driven velocities are nearest to these, where loops may block them."""
    _, K = residual_and_jacobian(robot, q)
    Z = derived(robot, TangentSpaces).at(K).basis
    return np.asarray(Z @ (np.linalg.pinv(Z[given.velocities], rcond=1.0 / _FASTEST) @ driven))


@dataclass(frozen=True, slots=True, eq=False)
class _Given:
    """The joints whose coordinates are given.

    Attributes:
        joints: Their names.
        coordinates: Indices in q of all their coordinates.
        velocities: Indices in v of all their velocities.
        values: The given coordinates.
    """

    joints: Sequence[str]
    coordinates: Indices
    velocities: Indices
    values: Vector


def _given(robot: Robot, values: Vector | Mapping[str, float | Sequence[float]]) -> _Given:
    if isinstance(values, Mapping):
        return _given_by_name(robot, values)
    actuation = robot.actuation
    values = checked_array("actuated", values, (len(actuation.idx_q),))
    return _Given(actuation.joints, actuation.idx_q, actuation.idx_v, values)


def _given_by_name(robot: Robot, by_name: Mapping[str, float | Sequence[float]]) -> _Given:
    mechanism = robot.mechanism
    # For each joint: index of its first coordinate, their number, index of its first velocity, their number, and the
    # number of its coordinates in files.
    at = {
        name: (slot.idx_q, slot.nq, slot.idx_v, slot.nv, len(slot.joint.type.coordinates))
        for name, slot in robot.slots.items()
    }
    if mechanism.root == "floating":
        at[ROOT_JOINT] = (0, 7, 0, 6, 7)
    coordinates: list[int] = []
    velocities: list[int] = []
    as_in_files: dict[str, list[float]] = {}
    for name, values in by_name.items():
        if name not in at:
            if any(joint.name == name and joint.mimic is not None for joint in mechanism.joints):
                raise ValueError(f"joint '{name}' is a mimic joint; give the coordinate of its leader instead")
            near = difflib.get_close_matches(name, at, n=1)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            raise ValueError(f"the robot has no moving joint '{name}'{hint}")
        first_q, nq, first_v, nv, count = at[name]
        shapes = [(1,), ()] if count == 1 else [(count,)]
        as_in_files[name] = np.atleast_1d(checked_array(f"actuated['{name}']", values, *shapes)).tolist()
        coordinates += range(first_q, first_q + nq)
        velocities += range(first_v, first_v + nv)
    q = robot.configuration(as_in_files)
    indices = np.array(coordinates, dtype=np.intp)
    return _Given(tuple(by_name), indices, np.array(velocities, dtype=np.intp), q[indices])


def _stopped(robot: Robot, assembler: Assembler, q: Vector, goal: Vector, coordinates: Indices) -> NotClosable:
    """Why the given joints cannot move farther than q."""
    there = np.array(q)
    there[coordinates] = goal[coordinates]
    anywhere = assembler.assemble(there)
    if not anywhere.closes:
        reason = "the loops cannot be closed at the given coordinates"
        return NotClosable(reason, anywhere.open, anywhere.q)
    reason = (
        "the loops can be closed at the given coordinates, but not on a straight path to them; "
        "give intermediate configurations, or call assemble with hold"
    )
    return TooFar(reason, all_openings(robot, there), there)
