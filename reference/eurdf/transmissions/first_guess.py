"""Poses of the workspace that Newton's method starts from, so that no call depends on the one before.

For one or two given joints, polynomials predict the motion of every joint of the loops from a reference pose. For more
joints, poses are stored, and a path leads from the nearest one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from eurdf.array import Indices, Matrix, Vector
from eurdf.kinematics.evaluate import evaluator, many_tree
from eurdf.kinematics.tangent_space import TangentSpaces
from eurdf.kinematics.tolerances import SAME
from eurdf.mechanism.joint import Joint
from eurdf.pinocchio.robot import build_robot
from eurdf.transmissions.drive import Drive
from eurdf.transmissions.polynomial_map import design, scaled
from eurdf.transmissions.reachable_set import Workspace, points_along, workspace
from eurdf.transmissions.selection import Selection
from eurdf.transmissions.serial_mechanism import with_properties

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

#: Smallest and largest positions of joints, by name, rad or m.
Ranges = Mapping[str, Sequence[float]]

# Polynomials are of so many positions at most, and workspaces are searched for poses if they have so many joints.
_MOST_PREDICTED, _MOST_SEARCHED = 2, 5
# Position limits are widened by this part of each range: polynomials are worst at the ends of what they are fitted to.
_MARGIN = 0.08
# Number of points of the grid, about, and along one joint, at most.
_POINTS, _MOST_ALONG = 343, 17
# The lowest degree in each position whose error, dimensionless, is good is taken: two Newton steps bring it to 1e-9.
# From one that is too large, they could lead to another branch.
_HIGHEST_DEGREE = 8
_GOOD, _TOO_LARGE = 1e-3, 0.05
#: Points for each coefficient, and how much larger than at the points the error may be between them.
_POINTS_EACH, LARGER = 2, 4.0
# Number of poses that are stored.
_STORED = 64
# Bound of the steps to the pose nearest to the reference.
_MOST_NEARER = 50


@dataclass(frozen=True, slots=True, eq=False)
class Prediction:
    """The motion of the joints of the loops from a reference pose, as Chebyshev polynomials of the given positions.

    With xⱼ the given position j scaled from its range to -1…1, the motion is Σ c[:, a, b, …] T_a(x₁) T_b(x₂) …: the
    change of an angle or a length, or the three components of the rotation vector of a ball, in its child's axes.

    Attributes:
        reference: The pose (nq,), closed.
        velocities: Indices (k,) in v of the joints that follow.
        lower: Smallest given positions (n,), rad or m.
        upper: Largest given positions (n,).
        coefficients: c (k, degree + 1, …), n times degree + 1; rad or m.
        error: Bound of the error of each motion in the workspace, dimensionless.
        sign: Sign of the determinant of G, or of its inverse, in the workspace; 0 if it is not square.
    """

    reference: Vector
    velocities: Indices
    lower: Vector
    upper: Vector
    coefficients: Matrix
    error: float
    sign: float

    @property
    def degree(self) -> int:
        """Degree in each given position."""
        return int(self.coefficients.shape[-1]) - 1

    def motion(self, positions: Vector) -> Vector | None:
        """The motion (k,) at given positions (n,), rad or m; None outside of their range."""
        x = scaled(positions, self.lower, self.upper)
        if not (np.abs(x) <= 1.0).all():
            return None
        basis = design(x[None], self.degree)[0]
        return np.asarray(self.coefficients.reshape(-1, len(basis)) @ basis)


class WorkspacePoses:
    """Closed poses of the workspace around a reference pose, and a little beyond; found when first asked for."""

    def __init__(
        self, robot: Robot, joints: Selection, motors: Selection, reference: Vector, ranges: Ranges | None
    ) -> None:
        """Take a closed pose (nq,), and ranges of joints as `eurdf.transmissions.workspace` does."""
        self._robot, self._joints, self._motors = robot, joints, motors
        self._reference, self._ranges = reference, ranges
        self._reaches: dict[Selection, float] = {}

    def around(self, reference: Vector) -> WorkspacePoses:
        """The same around another closed pose (nq,)."""
        return WorkspacePoses(self._robot, self._joints, self._motors, reference, self._ranges)

    @cached_property
    def _found(self) -> tuple[Matrix, str]:
        """The poses (N, nq), on the branch of the reference; if there are none, why."""
        count, none = len(self._joints), np.zeros((0, len(self._reference)))
        if count > _MOST_SEARCHED:
            return none, f"there are more than {_MOST_SEARCHED} joints"
        try:
            return self._searched(_widened(self._robot)).q, ""
        except ValueError as error:  # there is no workspace around the reference
            return none, str(error)

    @cached_property
    def within(self) -> Workspace:
        """The workspace within the position limits; the errors are those of `workspace`."""
        return self._searched(self._robot)

    def _searched(self, robot: Robot) -> Workspace:
        grid = max(3, points_along(len(self._joints), _POINTS, _MOST_ALONG))
        joints, motors = self._joints.joints, self._motors.joints
        return workspace(robot, joints, self._reference, motors=motors, grid=grid, ranges=self._ranges)

    @cached_property
    def _chosen(self) -> list[int]:
        """Which poses are stored: each is as far as possible from those before it in the positions of the joints."""
        x = self._scaled(self._joints, self._found[0])
        chosen, distance = [0] if len(x) else [], np.full(len(x), math.inf)
        while 0 < len(chosen) < min(_STORED, len(x)):
            distance = np.minimum(distance, ((x - x[chosen[-1]]) ** 2).sum(axis=1))
            chosen.append(int(distance.argmax()))
        return chosen

    @property
    def stored(self) -> Matrix:
        """The poses (N, nq) that are stored."""
        return self._found[0][self._chosen]

    def reach(self, given: Selection) -> float:
        """Bound of the squared distance of positions in the workspace from a stored pose, dimensionless."""
        if given not in self._reaches:
            self._reaches[given] = self._reach(self._scaled(given, self._found[0]))
        return self._reaches[given]

    def _reach(self, x: Matrix) -> float:
        """As `reach`, of the positions (N, n) of all poses."""
        if not len(x):
            return 0.0
        squares = np.sort(((x[:, None] - x) ** 2).sum(axis=2))
        to_stored = ((x[:, None] - x[self._chosen]) ** 2).sum(axis=2).min(axis=1).max()
        n = x.shape[1]  # a point of the grid has 2n neighbours; of a cell, no point is farther than half a diagonal
        half_diagonal = 0.5 * math.sqrt(n * np.median(squares[:, min(2 * n, len(x) - 1)]))
        return float((math.sqrt(to_stored) + half_diagonal) ** 2)

    def nearest(self, given: Selection, positions: Vector) -> Vector | None:
        """The stored pose (nq,) with given joints nearest to positions (n,); None if they are out of its reach."""
        unit = self._robot.cached(TangentSpaces).scale[given.velocities]
        apart = (given.nearest(given.read(self.stored), positions) - positions) / unit
        squares = (apart * apart).sum(axis=1)
        return np.array(self.stored[squares.argmin()]) if (squares <= self.reach(given)).any() else None

    def _scaled(self, chosen: Selection, q: Matrix) -> Matrix:
        """The positions (N, n) of some joints at poses (N, nq), dimensionless."""
        at = chosen.nearest(chosen.read(q), chosen.read(self._reference))
        return np.asarray(at / self._robot.cached(TangentSpaces).scale[chosen.velocities])

    def prediction(self, drive: Drive) -> tuple[Prediction | None, str]:
        """The polynomials of the positions that a drive is given; if there are none, why."""
        n = len(drive.given)
        if n > _MOST_PREDICTED:
            return None, f"polynomials are of at most {_MOST_PREDICTED} positions"
        samples, missing = self.samples(drive)
        if samples is None:
            return None, missing
        c, error = fitted(samples, samples.motions)
        degree = round(len(c) ** (1.0 / n)) - 1
        if not error <= _TOO_LARGE:
            return None, f"polynomials of degree {degree} would err by {error:.2g}"
        coefficients = (c * drive.unit).T.reshape(len(drive.own), *(degree + 1,) * n)
        bound, sign = LARGER * error + SAME, sign_of(drive.derivative(self._reference))
        return Prediction(self._reference, drive.own, samples.lower, samples.upper, coefficients, bound, sign), ""

    def samples(self, drive: Drive) -> tuple[Samples | None, str]:
        """The poses of the workspace by the positions that a drive is given; if they are too few, why."""
        n, own = len(drive.given), [slot.joint for slot in self._robot.slots.values() if slot.idx_v in drive.own]
        poses, missing = self._found
        odd = [f"joint '{joint.name}' is {joint.type.value}" for joint in own if _is_odd(joint)]
        if missing or odd:
            return None, missing or odd[0]
        q, motions = nearest_poses(drive, self._reference, poses)
        x = drive.given.nearest(drive.given.read(q), drive.given.read(self._reference))
        beyond = 0.5 * _MARGIN * np.ptp(x, axis=0)  # the workspace ends between points
        if not (beyond > 0.0).all() or len(q) < _POINTS_EACH * 2**n:
            return None, f"only {len(q)} points of a grid are in the workspace"
        return Samples(self._reference, q, x, motions, x.min(axis=0) - beyond, x.max(axis=0) + beyond), ""


class Samples(NamedTuple):
    """Poses of the workspace.

    Attributes:
        reference: The pose (nq,) that motions start from.
        q: The poses (N, nq).
        positions: Given positions (N, n) there, rad or m.
        motions: Motions (N, k) to them of the joints that follow, dimensionless, as in `Prediction`.
        lower: Smallest given positions (n,), and a little less.
        upper: Largest given positions (n,), and a little more.
    """

    reference: Vector
    q: Matrix
    positions: Matrix
    motions: Matrix
    lower: Vector
    upper: Vector


def fitted(samples: Samples, values: Matrix) -> tuple[Matrix, float]:
    """Coefficients (c, k) of polynomials of the positions through values (N, k), and the largest error."""
    n, count = samples.positions.shape[1], len(samples.q)
    x = scaled(samples.positions, samples.lower, samples.upper)
    error, degree, c = math.inf, 0, np.zeros((1, values.shape[1]))
    while error > _GOOD and degree < _HIGHEST_DEGREE and _POINTS_EACH * (degree + 2) ** n <= count:
        degree += 1
        basis = design(x, degree)
        c = np.asarray(np.linalg.lstsq(basis, values, rcond=None)[0], np.float64)
        error = float(np.abs(basis @ c - values).max(initial=0.0))
    return c, error


def sign_of(D: Matrix) -> float:
    """The sign of the determinant of a derivative (m, n), which changes at dead points; 0 if it is not square."""
    return float(np.sign(np.linalg.det(D))) if D.shape[0] == D.shape[1] else 0.0


def nearest_poses(drive: Drive, reference: Vector, q: Matrix) -> tuple[Matrix, Matrix]:
    """The poses on which rods that can spin are turned as little as possible from a reference pose.

    Newton steps close the loops, and in the motions that the given joints do not determine, the gradient of the squared
    distance leads to the nearest pose. The nearest poses depend smoothly on the given positions.

    Args:
        drive: What is given, and what follows.
        reference: The pose (nq,).
        q: Closed poses (N, nq).

    Returns:
        The poses (N, nq), and the motions (N, k) from the reference to them, dimensionless.
    """
    tree, k, rank = many_tree(drive.robot), len(drive.own), drive.rank
    motions, step = np.zeros((len(q), k)), np.full(1, math.inf)
    if not k:
        return q, motions
    many = evaluator(drive.robot, drive.closures, drive.own, few=False)
    for _ in range(_MOST_NEARER):
        motions = tree.difference(np.tile(reference, (len(q), 1)), q)[:, drive.own] / drive.unit
        if np.abs(step).max() <= SAME * SAME:
            break
        at = many.at(q)
        left, values, right = np.linalg.svd(many.jacobian(at) * drive.factors[:, :k])
        r = (many.residual(at) * drive.rows)[:, None] @ left[:, :, :rank] / values[:, None, :rank]
        along, free = right[:, :rank], right[:, rank:]
        step = -(r @ along + motions[:, None] @ free.swapaxes(1, 2) @ free)[:, 0]
        v = np.zeros((len(q), drive.robot.tree.nv))
        v[:, drive.own] = step * drive.unit
        q = tree.integrate(q, v)
    return q, motions


def _is_odd(joint: Joint) -> bool:
    """Whether the velocities of a joint are neither the rates of its coordinates nor those of a ball."""
    return joint.type.moving_frame and joint.type.quaternion != 0


def _widened(robot: Robot) -> Robot:
    """The robot with wider position limits."""
    wider = {}
    for slot in robot.slots.values():
        joint = slot.joint
        margins = [_MARGIN * (upper - lower) if upper - lower < math.inf else 0.0 for lower, upper in joint.ranges]
        if any(margins):
            ends = [(lower - by, upper + by) for (lower, upper), by in zip(joint.ranges, margins, strict=True)]
            lower, upper = zip(*ends, strict=True)
            wider[joint.name] = replace(joint.properties, lower=lower, upper=upper)
    return build_robot(with_properties(robot.mechanism, wider), geometry=False)
