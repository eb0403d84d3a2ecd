"""The closed pose at positions of some joints of the loops, near another pose, and the derivative of the others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from eurdf.kinematics.array import Indices, Matrix, Vector
from eurdf.kinematics.assembly import Assembler, start
from eurdf.kinematics.derived import borrowed, derived
from eurdf.kinematics.evaluation import Evaluation
from eurdf.kinematics.exceptions import NotClosable
from eurdf.kinematics.forward_kinematics import forward_kinematics
from eurdf.kinematics.least_solution import least_solution
from eurdf.kinematics.loop import LoopGroup, find_loops, independent_groups, joints_of_loops, merged
from eurdf.kinematics.rank import numerical_rank
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.pinocchio.arguments import checked_array
from eurdf.transmissions.exceptions import NoTransmission
from eurdf.transmissions.joint_coordinates import JointCoordinates, coordinates_of
from eurdf.transmissions.selection import selection
from eurdf.transmissions.transmission import Transmission, at_one

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Bound of each row of the residual before the last correction, which leaves rounding, m or rad.
CLOSED = 1e-13

# As in `eurdf.kinematics.forward_kinematics`: a solution is on the branch of the pose before if it is nearer to the
# tangent there than this fraction of the motion, or this near (rad, or characteristic lengths).
MOST_CORRECTION = 0.25
LEAST_CORRECTION = 1e-6
#: Bound of the motion of each joint in one step (rad, or characteristic lengths); beyond it the path is divided.
LONGEST_MOTION = 0.5

_MOST_STEPS = 8

# A velocity is determined by the given ones if its entry in each unit vector of the motions that remain is below this,
# and given velocities are independent if no combination of them opens the loops by more.
_DETERMINED = 1e-6


class Drive:
    """Moves some joints, those given, and follows others, those asked for.

    Attributes:
        given: The given joints.
        asked: The joints asked for.
        closures: Indices of the constraints that relate them.
        own: Indices (k,) in v of the joints that follow.
        rank: Rank of K_x, the columns of these joints, at the first pose.
    """

    def __init__(self, at: Transmission, given: JointCoordinates, asked: JointCoordinates) -> None:
        """Prepare the loops between given joints and those asked for.

        Args:
            at: The transmission at a pose.
            given: Its joints, or its motors.
            asked: The others.

        Raises:
            NoTransmission: The given joints do not determine the others at that pose, or depend on each other.
        """
        self.given, self.asked, self._by_joints = given, asked, given.of.names == at.joints
        robot = self._robot = at.robot
        self._tree = robot.tree
        self._held = _held(robot, at.held)
        spaces = derived(robot, TangentSpaces)
        self.closures: tuple[int, ...] = ()
        self.own: Indices = np.zeros(0, np.intp)
        self._evaluation: Evaluation | None = None
        groups = _moved_groups(robot, given.of.velocities.tolist(), at.held_index.tolist())
        if groups:
            group = merged(groups)
            self.closures, self.own = group.closures, group.velocities
            columns = group._replace(velocities=np.concatenate((group.velocities, given.of.velocities)))
            self._evaluation = Evaluation(robot, columns, spaces.row_scale, spaces.scale)
        self._unit, self._given_unit = spaces.scale[self.own], spaces.scale[given.of.velocities]
        every = np.concatenate((self.own, given.of.velocities)).tolist()
        place = {velocity: index for index, velocity in enumerate(every)}
        if not set(asked.of.velocities.tolist()) <= set(place):
            raise self._refusal(at.q)
        #: Of each velocity asked for its place among those that follow and those given.
        self._asked = np.array([place[velocity] for velocity in asked.of.velocities.tolist()], np.intp)
        self._asked_unit = spaces.scale[asked.of.velocities]
        # The pose at which the derivative (k, n), dimensionless, was computed last.
        self._tangent: tuple[Vector, Matrix] | None = None
        self.rank = 0
        self.rank = self._decomposed(at.q)[1]

    def move(self, q: Vector, positions: Vector) -> tuple[Vector, Matrix]:
        """Move the given joints from a closed pose.

        Args:
            q: The pose (nq,).
            positions: Where to move the given joints (n,), rad or m.

        Returns:
            The closed pose (nq,) there, and the derivative (m, n) of the joints asked for by the given ones.

        Raises:
            NotClosable: The given joints cannot reach the positions on the straight path.
            NoTransmission: The given joints do not determine the others there.
            ValueError: ``positions`` does not fit.
        """
        positions = checked_array("positions", positions, (len(self.given),))
        there, D = self._newton(q, positions) or self._followed(q, positions)
        self._tangent = there, D
        every = np.concatenate((D, np.eye(len(self.given))))
        return there, self._asked_unit[:, None] * every[self._asked] / self._given_unit

    def _newton(self, q: Vector, positions: Vector) -> tuple[Vector, Matrix] | None:
        """The pose and the derivative (k, n), dimensionless; None where the path has to be divided."""
        before = self.given.read(q)
        step = (self.given.nearest(positions, before) - before) / self._given_unit
        if np.abs(step).max() > LONGEST_MOTION:
            return None
        if self._evaluation is None:
            return self._moved(q, np.zeros(0), positions), np.zeros((0, len(step)))
        tangent = self._tangent_at(q)
        if tangent is None:
            return None
        motion = tangent @ step
        if np.abs(motion).max(initial=0.0) > LONGEST_MOTION:
            return None
        there, correction = self._moved(q, motion, positions), np.zeros(len(motion))
        for _ in range(_MOST_STEPS):
            r = self._evaluation.residual(there)
            solution = self._solved(r)
            if solution is None:
                return None
            correction += solution[:, 0]
            there = self._moved(there, solution[:, 0], positions)
            if np.abs(r).max() <= CLOSED:
                length = math.hypot(*motion.tolist(), *step.tolist())
                allowed = max(MOST_CORRECTION * length, LEAST_CORRECTION)
                return (there, solution[:, 1:]) if math.hypot(*correction.tolist()) <= allowed else None
        return None

    def _tangent_at(self, q: Vector) -> Matrix | None:
        """The derivative (k, n) at a pose, dimensionless; None if in doubt."""
        if self._tangent is not None and self._tangent[0] is q:
            return self._tangent[1]
        assert self._evaluation is not None
        solution = self._solved(self._evaluation.residual(q))
        return None if solution is None else solution[:, 1:]

    def _solved(self, r: Vector) -> Matrix | None:
        """K_x⁺ (-r, -K_g), dimensionless (k, 1 + n), where the residual is r; None if the rank is in doubt."""
        assert self._evaluation is not None
        A, count = self._evaluation.jacobian(), len(self.own)
        right = np.empty((len(r), 1 + len(self.given)))
        right[:, 0] = self._evaluation.row_scale * r
        right[:, 1:] = A[:, count:]
        return least_solution(A[:, :count], -right, math.sqrt(float(np.vdot(A, A))))

    def _moved(self, q: Vector, motion: Vector, positions: Vector) -> Vector:
        """The pose (nq,) after a motion (k,), dimensionless, with the given joints at their positions."""
        v = np.zeros(self._tree.nv)
        v[self.own] = self._unit * motion
        moved = self._tree.normalized(self._tree.integrate(q, v))
        self.given.write(positions, moved)
        return moved

    def _followed(self, q: Vector, positions: Vector) -> tuple[Vector, Matrix]:
        """As `_newton`, along the path and at any pose."""
        held = self._held
        by_name = self.given.by_joint(positions)
        if held is not None:
            by_name |= held.by_joint(held.read(q))
        there = forward_kinematics(self._robot, by_name, q, tolerance=CLOSED)
        return there, self._decomposed(there)[0]

    def _decomposed(self, q: Vector) -> tuple[Matrix, int]:
        """The derivative (k, n), dimensionless, and the rank of K_x at a pose.

        Raises:
            NoTransmission: The given joints do not determine the others, or depend on each other.
        """
        if self._evaluation is None:
            return np.zeros((0, len(self.given))), 0
        self._evaluation.residual(q)
        A, count = self._evaluation.jacobian(), len(self.own)
        left, values, right = np.linalg.svd(A[:, :count])
        rank = numerical_rank(values, float(np.linalg.norm(A, 2)))
        opening = np.abs(left[:, rank:].T @ A[:, count:]).max(initial=0.0)
        remaining = np.concatenate((right[rank:].T, np.zeros((len(self.given), count - rank))))[self._asked]
        if rank < self.rank or max(opening, np.abs(remaining).max(initial=0.0)) > _DETERMINED:
            raise self._refusal(q)
        return right[:rank].T @ ((left[:, :rank].T @ -A[:, count:]) / values[:rank, None]), rank

    def _refusal(self, q: Vector) -> NoTransmission:
        """Why the given joints do not determine the others at a pose."""
        given, asked = self.given.of, self.asked.of
        if self._by_joints:
            reason = at_one(self._robot, given, q, asked).reason
        else:
            reason = at_one(self._robot, asked, q, given).inverse_reason
        named = ", ".join(f"'{name}'" for name in given.joints)
        return NoTransmission("G" if self._by_joints else "B_J", reason or f"{named} cannot move independently")


def _held(robot: Robot, names: Sequence[str]) -> JointCoordinates | None:
    """The joints that their springs hold; None if there are none."""
    return coordinates_of(robot, selection(robot, dict.fromkeys(names))) if names else None


def _moved_groups(robot: Robot, driven: Sequence[int], held: Sequence[int]) -> list[LoopGroup]:
    """The groups of loops that driven velocities move, while others are held."""
    tree, loops, found = robot.tree, find_loops(robot), []
    for group in independent_groups(robot, {*driven, *held}):
        joints = joints_of_loops(robot, [loops[index] for index in group.closures])
        if not set(driven).isdisjoint(velocity for joint in joints for velocity in tree.moving_velocities[joint]):
            found.append(group)
    return found


def closed_pose(robot: Robot, q: Vector | None) -> Vector:
    """A configuration, with its loops closed.

    Raises:
        NotClosable: They cannot be closed there.
        ValueError: It is not a configuration.
    """
    first = start(robot, q, "q")
    with borrowed(robot, Assembler) as assembler:
        assembler.tolerance, assembler.limits = CLOSED, None
        closed = assembler.closed(first)
        if closed is not None:
            return closed
        assembly = assembler.assemble(first)
    if not assembly.closes:
        raise NotClosable("no closed configuration was found near q", assembly.open, assembly.q)
    return assembly.q
