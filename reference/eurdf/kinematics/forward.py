"""Closed-loop forward kinematics: coordinates of some joints are given, those of the others are computed."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, TypeVar

import numpy as np

from eurdf.array import Indices, Mask, Matrix, Vector
from eurdf.errors import NotClosable, NumericalOverflow, TooFar
from eurdf.kinematics.assembly import assembled, closed_start
from eurdf.kinematics.blocks import checked_rows
from eurdf.kinematics.closing import close, is_closed, start
from eurdf.kinematics.named import ByJoint, Named, NamedRows, configurations_of, unknown_joint
from eurdf.kinematics.path import follow_given
from eurdf.kinematics.problem import Problem, for_many
from eurdf.kinematics.residual import all_openings
from eurdf.kinematics.springs import Resting, joints_at_rest, spring_equilibrium
from eurdf.kinematics.tolerances import RESTARTS, SHORTEST_STEP, SOLVED
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.arguments import are_by_name, checked_array, checked_tolerance
from eurdf.pinocchio.memory import working_memory

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

_T = TypeVar("_T")

# Smallest step where the springs are kept at rest, as a part of the path: if that takes many steps, they are brought
# into equilibrium afterwards.
_SHORTEST_STEP_AT_REST = 2.0**-3


def forward_kinematics(
    robot: Robot,
    actuated: Named,
    q0: Named | None = None,
    *,
    tolerance: float = SOLVED,
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
    tolerance, given = checked_tolerance(tolerance), _given(robot, actuated)

    def there(driving: Driving) -> Vector:
        first = _closed_start(driving, start(robot, q0))
        goal = np.array(first)
        goal[given.coordinates] = given.values
        goal = start(robot, goal, "actuated")
        q, part = _moved(robot, driving, first, goal)
        if part < 1.0:
            raise _stopped(robot, driving, q, goal)
        return q

    return _with_driving(robot, given, tolerance, there)


def _closed_start(driving: Driving, q: Vector) -> Vector:
    """A configuration (nq,), with its loops closed; itself if they are."""
    # What moves the given joints goes on at the same configuration, which costs no evaluation again.
    if is_closed(driving.driven, q[None], driving.tolerance)[0]:
        return q
    return closed_start(driving.free, q, driving.tolerance)


def farthest(robot: Robot, values: ByJoint, first: Vector, shortest: float = SHORTEST_STEP) -> tuple[Vector, float]:
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
    goal = np.array(first)
    goal[given.coordinates] = given.values
    return _with_driving(robot, given, SOLVED, lambda driving: _moved(robot, driving, first, goal, shortest))


class Driving(NamedTuple):
    """A robot some joints of which are given.

    Attributes:
        free: The robot with no joint held.
        driven: The robot with the given joints.
        coordinates: Indices in q of the given coordinates.
        resting: The joints with springs, if these may be at rest.
        at_rest: The same robot with these joints given, too.
        tolerance: Bound of each row of the residual for closed loops, m or rad.
    """

    free: Problem
    driven: Problem
    coordinates: Indices
    resting: Resting | None
    at_rest: Problem | None
    tolerance: float

    def moved(self, first: Matrix, goal: Matrix, shortest: float = SHORTEST_STEP) -> tuple[Matrix, Vector, Mask, Mask]:
        """Move the given joints along straight paths; with their springs at rest, if these can be so on the way.

        Args:
            first: Closed configurations (B, nq) to start from.
            goal: The configurations (B, nq) with the coordinates to move to.
            shortest: Smallest step, as a part of the path.

        Returns:
            Where the joints get (B, nq), what part (B,) of their paths that is, whether the springs are at rest there
            (B,), and where numbers overflow (B,).
        """
        none = np.zeros(len(first), dtype=bool)
        if self.resting is None or self.at_rest is None:
            q, part, overflows = self._freely(first, goal, shortest)
            return q, part, none, overflows
        at_rest = np.array(goal)
        at_rest[:, self.resting.coordinates] = self.resting.values
        coordinates = np.concatenate((self.coordinates, self.resting.coordinates))
        q, part, _ = follow_given(self.at_rest, first, at_rest, coordinates, self.tolerance, _SHORTEST_STEP_AT_REST)
        rests, overflows = part == 1.0, none
        on = np.flatnonzero(~rests)
        if len(on):
            q[on], part[on], overflows[on] = self._freely(first[on], goal[on], shortest)
        return q, part, rests, overflows

    def _freely(self, first: Matrix, goal: Matrix, shortest: float) -> tuple[Matrix, Vector, Mask]:
        """As `moved`, whatever the springs do."""
        return follow_given(self.driven, first, goal, self.coordinates, self.tolerance, shortest, free=self.free)


def _with_driving(robot: Robot, given: Given, tolerance: float, use: Callable[[Driving], _T]) -> _T:
    """What a function makes of a robot with given joints, for one element."""
    velocities = tuple(given.velocities.tolist())
    resting = joints_at_rest(robot, given.velocities) if len(robot.tree.springs.idx_v) else None
    with working_memory(robot, Problem) as free, working_memory(robot, Problem, velocities) as driven:
        if resting is None:
            return use(Driving(free, driven, given.coordinates, None, None, tolerance))
        with working_memory(robot, Problem, (*velocities, *resting.velocities.tolist())) as at_rest:
            return use(Driving(free, driven, given.coordinates, resting, at_rest, tolerance))


def _moved(
    robot: Robot, driving: Driving, first: Vector, goal: Vector, shortest: float = SHORTEST_STEP
) -> tuple[Vector, float]:
    """Where the given joints get (nq,), with the springs in equilibrium, and the part of the path.

    Raises:
        NumericalOverflow: The derivative of the residual is not finite on the way.
    """
    q, part, rests, overflows = driving.moved(first[None], goal[None], shortest)
    if overflows[0]:
        raise NumericalOverflow("the residual and its derivative")
    there = q[0] if rests[0] else in_equilibrium(robot, q[0], driving)
    return there, float(part[0])


def in_equilibrium(robot: Robot, q: Vector, driving: Driving) -> Vector:
    """The configuration (nq,) near a closed one at which the springs are in equilibrium."""
    if not len(robot.tree.springs.idx_v):
        return q
    return spring_equilibrium(robot, q, driving.coordinates, driving.driven, driving.tolerance)


def driving_many(robot: Robot, given: Given, tolerance: float) -> Driving:
    """A robot some joints of which are given, for many elements."""
    velocities, resting, at_rest = given.velocities.tolist(), joints_at_rest(robot, given.velocities), None
    if resting is not None:
        at_rest = for_many(robot, (*velocities, *resting.velocities.tolist()))
    return Driving(for_many(robot), for_many(robot, velocities), given.coordinates, resting, at_rest, tolerance)


def goals(driving: Driving, q: Matrix, values: Matrix) -> Matrix:
    """The configurations (B, nq) with the given values.

    Raises:
        ValueError: They contain a quaternion, or a cosine and a sine, of length zero.
    """
    goal = np.array(q)
    goal[:, driving.coordinates] = values
    with np.errstate(all="ignore"):
        goal = driving.driven.tree.normalized(goal)
    wrong = np.flatnonzero(~np.isfinite(goal[:, driving.coordinates]).all(axis=1))
    if len(wrong):
        raise ValueError(
            f"values[{wrong[0]}] has a quaternion, or a (cos, sin) pair, whose length is zero or overflows"
        )
    return goal


def moved_many(
    driving: Driving, q: Matrix, goal: Matrix, closed: Mask | None = None
) -> tuple[Matrix, Vector, Indices, Mask]:
    """Where the given joints get (B, nq), the norms (B,) of the residual, the reasons, and if springs are at rest."""
    if closed is None:
        first = close(driving.free, q, driving.tolerance, RESTARTS)
        values, q, closed = goal[:, driving.coordinates], first.q, first.closes
        goal = goals(driving, q, values)
    found, code, rests = np.array(q), np.where(closed, 0, 1), np.zeros(len(q), dtype=bool)
    on = np.flatnonzero(closed)
    there, part, rests[on], _ = driving.moved(q[on], goal[on])
    stopped = part < 1.0
    if stopped.any():
        beyond = there[stopped]
        beyond[:, driving.coordinates] = goal[on[stopped]][:, driving.coordinates]
        anywhere = close(driving.driven, beyond, driving.tolerance)
        there[stopped], code[on[stopped]] = anywhere.q, np.where(anywhere.closes, 3, 2)
    found[on] = there
    return found, np.linalg.norm(driving.free.residual(found), axis=1), code, rests


@dataclass(frozen=True, slots=True, eq=False)
class Given:
    """The joints whose coordinates are given.

    Attributes:
        joints: Their names.
        coordinates: Indices in q of all their coordinates.
        velocities: Indices in v of all their velocities.
        values: The given coordinates (n,), or (B, n).
    """

    joints: Sequence[str]
    coordinates: Indices
    velocities: Indices
    values: Vector


def _given(robot: Robot, values: Named) -> Given:
    if are_by_name(values):
        return _given_by_name(robot, values)
    actuation = robot.actuation
    values = checked_array("actuated", values, (len(actuation.idx_q),))
    return Given(actuation.joints, actuation.idx_q, actuation.idx_v, values)


def _given_by_name(robot: Robot, by_name: ByJoint) -> Given:
    coordinates, velocities, counts = _places(robot, by_name)
    as_in_files: dict[str, list[float]] = {}
    for (name, values), count in zip(by_name.items(), counts, strict=True):
        shapes = [(1,), ()] if count == 1 else [(count,)]
        as_in_files[name] = np.atleast_1d(checked_array(f"actuated['{name}']", values, *shapes)).tolist()
    return Given(tuple(by_name), coordinates, velocities, robot.configuration(as_in_files)[coordinates])


def given_many(robot: Robot, values: NamedRows) -> Given:
    """The joints whose coordinates are given for many elements: those of the actuators (B, nu), or of joints by name.

    Raises:
        ValueError: They do not fit the robot.
    """
    if are_by_name(values):
        coordinates, velocities, _ = _places(robot, values)
        rows = configurations_of(robot, values, "values")[:, coordinates]
        return Given(tuple(values), coordinates, velocities, rows)
    actuation = robot.actuation
    rows = checked_rows("values", values, len(actuation.idx_q))
    return Given(actuation.joints, actuation.idx_q, actuation.idx_v, rows)


def _places(robot: Robot, names: Iterable[str]) -> tuple[Indices, Indices, list[int]]:
    """Indices in q of the coordinates of joints, in v of their velocities, and how many coordinates files have of each.

    Raises:
        ValueError: A name is not that of a joint with coordinates of its own.
    """
    at = {
        name: (slot.idx_q, slot.nq, slot.idx_v, slot.nv, len(slot.joint.type.coordinates))
        for name, slot in robot.slots.items()
    }
    if robot.mechanism.root == "floating":
        at[ROOT_JOINT] = (0, 7, 0, 6, 7)
    coordinates: list[int] = []
    velocities: list[int] = []
    counts = []
    for name in names:
        if name not in at:
            raise unknown_joint(robot, name)
        first_q, nq, first_v, nv, count = at[name]
        coordinates += range(first_q, first_q + nq)
        velocities += range(first_v, first_v + nv)
        counts.append(count)
    return np.array(coordinates, dtype=np.intp), np.array(velocities, dtype=np.intp), counts


def _stopped(robot: Robot, driving: Driving, q: Vector, goal: Vector) -> NotClosable:
    """Why the given joints cannot move farther than q."""
    there = np.array(q)
    there[driving.coordinates] = goal[driving.coordinates]
    anywhere = assembled(driving.driven, there, driving.tolerance)
    if not anywhere.closes:
        reason = "the loops cannot be closed at the given coordinates"
        return NotClosable(reason, anywhere.open, anywhere.q)
    reason = (
        "the loops can be closed at the given coordinates, but not on a straight path to them; "
        "give intermediate configurations, or call assemble with hold"
    )
    return TooFar(reason, all_openings(robot, there), there)
