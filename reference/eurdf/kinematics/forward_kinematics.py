"""Closed-loop forward kinematics: some joints are given, the others follow."""

from __future__ import annotations

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Indices, Vector
from eurdf.kinematics.assembly import Assembler, assemble, start
from eurdf.kinematics.exceptions import NotClosable
from eurdf.kinematics.residual import closure_openings, residual_and_jacobian
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.configuration import configuration_vector
from eurdf.pinocchio.coordinates import slots

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A step along the way is taken if closing the loops after it moves the joints by no more than this part of it, ...
_MOST_CORRECTION = 0.25
# ... or by this (rad, or characteristic lengths), and is halved if not, down to this part of the way.
_LEAST_CORRECTION = 1e-6
_SHORTEST_STEP = 2.0**-10
# No joint goes farther in one step (rad, or characteristic lengths).
_LONGEST_MOTION = 0.5
# Directions in which the others can follow the given joints only by turning this much faster count as blocked.
_FASTEST = 1e6


def forward_kinematics(
    robot: Robot,
    actuated: Vector | Mapping[str, float | Sequence[float]],
    q0: Vector | None = None,
    *,
    tolerance: float = 1e-10,
) -> Vector:
    """The closed configuration in which the actuated joints stand where they are told.

    It solves r(q) = 0 with the given coordinates held, and stays on the branch of q0: the given joints go there on the
    straight (shortest) way, in steps as long as the others follow continuously, v = Z (S_hᵀ Z)⁺ v_h with K Z = 0, each
    closed again by `assemble`. Motion that the given joints do not control stays as little as it can, and depends on
    the way. To find any closed configuration, whichever its branch, call `assemble` with ``hold``.

    Source: `closedLoopForwardKinematics` of the toolbox of Batto, De Matteïs and Mansard, 2025.

    Args:
        robot: The robot.
        actuated: The actuated coordinates, as `split_configuration` gives them; or, for any joints, actuated or not,
            the coordinates as files have them, by name: a number where there is one, else several. Joints left out
            follow.
        q0: Where to start (nq,): it says which branch, and where the joints are that nothing moves. It is closed first
            if it is not. The `assembled` configuration by default, or else the neutral one.
        tolerance: What each row of the residual may be, m or rad, where the loops are closed.

    Returns:
        q (nq,), with the given joints exactly where they are told.

    Raises:
        NotClosable: The loops cannot be closed at q0, or with the given joints where they are told, or not on the way
            there; the way may lead around through other configurations given one after the other.
        ValueError: The coordinates given, or ``q0``, are not those of this robot.
    """
    model = robot.model
    first = assemble(robot, q0, tolerance=tolerance)
    if not first.closes:
        raise NotClosable("there is no closed configuration near the start", first.open, first.q)
    told = _told(robot, actuated)
    goal = np.array(first.q)
    goal[told.coordinates] = told.values
    goal = start(robot, goal)
    way = np.asarray(pin.difference(model, first.q, goal))  # zero but for the given joints
    assembler, spaces = Assembler(robot, told.joints, tolerance=tolerance), TangentSpaces(robot)
    data = model.createData()

    q, done, step = first.q, 0.0, 1.0
    while done < 1.0:
        step = min(step, 1.0 - done)
        _, K = residual_and_jacobian(robot, q, data)
        Z = spaces.at(K).basis
        v = Z @ (np.linalg.pinv(Z[told.velocities], rcond=1.0 / _FASTEST) @ (step * way[told.velocities]))
        motion = v / spaces.scale
        if np.abs(motion).max(initial=0.0) > _LONGEST_MOTION and step > _SHORTEST_STEP:
            step *= 0.5
            continue
        at = goal if done + step >= 1.0 else np.asarray(pin.integrate(model, first.q, (done + step) * way))
        expected = np.asarray(pin.integrate(model, q, v))
        expected[told.coordinates] = at[told.coordinates]
        closed = assembler.assemble(expected, restarts=0)
        corrected = float(np.linalg.norm(np.asarray(pin.difference(model, expected, closed.q)) / spaces.scale))
        allowed = max(_MOST_CORRECTION * float(np.linalg.norm(motion)), _LEAST_CORRECTION)
        if closed.closes and corrected <= allowed:
            q, done, step = closed.q, done + step, 2.0 * step
            continue
        step *= 0.5
        if step < _SHORTEST_STEP:
            raise _stopped(robot, assembler, q, goal, told.coordinates)
    return q


@dataclass(frozen=True, slots=True, eq=False)
class _Told:
    """Joints that are told where to stand.

    Attributes:
        joints: Their names.
        coordinates: Indices in q of all their coordinates, ...
        velocities: ... and in v of all their velocities.
        values: The coordinates.
    """

    joints: Sequence[str]
    coordinates: Indices
    velocities: Indices
    values: Vector


def _told(robot: Robot, given: Vector | Mapping[str, float | Sequence[float]]) -> _Told:
    if isinstance(given, Mapping):
        return _told_by_name(robot, given)
    actuation, values = robot.actuation, np.asarray(given, dtype=np.float64)
    count = len(actuation.idx_q)
    if values.shape != (count,):
        raise ValueError(f"the actuated coordinates of this robot have the shape ({count},), not {values.shape}")
    return _Told(actuation.joints, actuation.idx_q, actuation.idx_v, values)


def _told_by_name(robot: Robot, given: Mapping[str, float | Sequence[float]]) -> _Told:
    mechanism, model = robot.mechanism, robot.model
    # Where the coordinates of each joint start, and how many there are; the same of its velocities.
    at = {name: (slot.idx_q, slot.nq, slot.idx_v, slot.nv) for name, slot in slots(mechanism, model).items()}
    if mechanism.root == "floating":
        at[ROOT_JOINT] = (0, 7, 0, 6)
    coordinates: list[int] = []
    velocities: list[int] = []
    for name in given:
        if name not in at:
            if any(joint.name == name and joint.mimic is not None for joint in mechanism.joints):
                raise ValueError(f"joint '{name}' mimics another: give the coordinate of that one")
            near = difflib.get_close_matches(name, at, n=1)
            hint = f"; did you mean '{near[0]}'?" if near else ""
            raise ValueError(f"the robot has no joint '{name}' that moves{hint}")
        first_q, nq, first_v, nv = at[name]
        coordinates += range(first_q, first_q + nq)
        velocities += range(first_v, first_v + nv)
    as_in_files = {name: np.atleast_1d(np.asarray(values, dtype=np.float64)).tolist() for name, values in given.items()}
    q = configuration_vector(mechanism, model, as_in_files)
    indices = np.array(coordinates, dtype=np.intp)
    return _Told(tuple(given), indices, np.array(velocities, dtype=np.intp), q[indices])


def _stopped(robot: Robot, assembler: Assembler, q: Vector, goal: Vector, coordinates: Indices) -> NotClosable:
    """Why the given joints come no farther than q."""
    there = np.array(q)
    there[coordinates] = goal[coordinates]
    anywhere = assembler.assemble(there)
    if not anywhere.closes:
        reason = "with the given joints where they are told, the loops cannot be closed"
        return NotClosable(reason, anywhere.open, anywhere.q)
    reason = "the straight way of the given joints does not lead to where they are told, though the loops can be closed"
    return NotClosable(f"{reason} there", closure_openings(robot, there), there)
