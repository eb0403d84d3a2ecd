"""Limits of joints that follow from those of their motors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from eurdf.array import Indices, Matrix, Vector, numbers
from eurdf.errors import NoTransmission
from eurdf.kinematics.named import Named, vector_of
from eurdf.loading import of_any_robot
from eurdf.transmissions.motors import finite_ranges, sides
from eurdf.transmissions.polytope import Polytope, box_along, image_of_box, largest_box, preimage_of_box
from eurdf.transmissions.reachable_set import Workspace
from eurdf.transmissions.selection import Selection, selection
from eurdf.transmissions.transmission import Transmission, Transmissions, at_many, at_one, configurations, require

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# A configuration bounds a box if the box uses more than this part of one of its half-spaces.
_BOUNDS = 1.0 - 1e-9
# Searches for poses of a workspace that exceed a box, each with steps of half the size, around so many of the worst.
_SEARCHES = 6
_WORST = 8


@dataclass(frozen=True, eq=False, repr=False)
class SerialLimits:
    """The limits of joints at one configuration, as `serial_limits` returns them.

    Torques are in N·m or N, velocities in rad/s or m/s. A box is symmetric: |xⱼ| ≤ boxⱼ for all joints at once.

    Attributes:
        joints: Names of the joints, nJ.
        motors: Names of the motors.
        torque: The torques that the motors can produce at the joints.
        velocity: The joint velocities at which no motor exceeds its limit.
    """

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    torque: Polytope
    velocity: Polytope
    _torque_ratio: Vector | None
    _velocity_ratio: Vector | None

    @cached_property
    def torque_box(self) -> Vector:
        """Half sides (nJ,) of the largest box of torques."""
        return _box(self.torque.A, self.torque.b, self._torque_ratio)

    @cached_property
    def velocity_box(self) -> Vector:
        """Half sides (nJ,) of the largest box of velocities."""
        return _box(self.velocity.A, self.velocity.b, self._velocity_ratio)

    @property
    def torque_axes(self) -> Matrix:
        """Smallest and largest torque (nJ, 2) of each joint while the others have none: not a box."""
        return self.torque.axes

    @property
    def velocity_axes(self) -> Matrix:
        """Smallest and largest velocity (nJ, 2) of each joint while the others are still: not a box."""
        return self.velocity.axes

    def __repr__(self) -> str:
        return f"<SerialLimits of {', '.join(self.joints)} by {', '.join(self.motors)}>"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CommonLimits:
    """The limits of joints at B configurations, as `serial_limits` returns them.

    Between configurations that were given, the boxes may not hold; those of a workspace were searched there too.

    Attributes:
        joints: Names of the joints, nJ.
        motors: Names of the motors.
        torque_box: Half sides (nJ,) of the largest box of torques that the motors can produce at all configurations.
        velocity_box: Half sides (nJ,) of the largest box of velocities that the motors allow at all configurations.
        torque_axes: As in `SerialLimits`, (B, nJ, 2).
        velocity_axes: As in `SerialLimits`, (B, nJ, 2).
        torque_bounded_by: Indices of the configurations that bound ``torque_box``.
        velocity_bounded_by: Indices of the configurations that bound ``velocity_box``.
        each: The limits at each configuration.
        q: The configurations (B, nq): those given; of a workspace also poses of its boundary and those found to bound
            a box.
        torque_margin: For a workspace, the largest part by which a pose of the last and finest search exceeded
            ``torque_box``, which is made smaller by it; None for given configurations.
        velocity_margin: The same of ``velocity_box``.
    """

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    torque_box: Vector
    velocity_box: Vector
    torque_axes: Matrix
    velocity_axes: Matrix
    torque_bounded_by: Indices
    velocity_bounded_by: Indices
    each: tuple[SerialLimits, ...]
    q: Matrix
    torque_margin: float | None = None
    velocity_margin: float | None = None

    def __repr__(self) -> str:
        return (
            f"<CommonLimits of {', '.join(self.joints)} at {len(self.each)} configurations: "
            f"torques ±{numbers(self.torque_box)} N·m or N, velocities ±{numbers(self.velocity_box)} rad/s or m/s>"
        )


@of_any_robot
def serial_limits(
    robot: Robot,
    joints: str | Iterable[str],
    q: Named | Matrix | Workspace | None = None,
    *,
    motors: str | Iterable[str] | None = None,
    torque_ratio: Named | None = None,
    velocity_ratio: Named | None = None,
) -> SerialLimits | CommonLimits:
    """The torques and velocities of joints that the limits of their motors allow.

    The torques are the polytope {Gᵀ τ_m : τ_m within the effort limits and control ranges of the motors}, the
    velocities are {v_J : |G v_J| ≤ limits}. A serial robot has one limit for each joint, a box: the largest symmetric
    one inside has the largest product of its sides. The limits of the joints themselves play no part. Torques are
    static, without friction.

    Args:
        robot: The robot.
        joints: As in `transmission`.
        q: A closed configuration (nq,), or several (B, nq), for a box that holds at all of them. Or the `workspace` of
            the joints, for a box that holds everywhere in it: its grid and its boundary, refined around the poses that
            bound the box. The default is the `assembled` configuration, or the neutral one if there is none.
        motors: As in `transmission`; those of the workspace, if it is given.
        torque_ratio: Ratio (nJ,) of the sides of the box of torques, positive, in place of the largest product.
        velocity_ratio: Ratio (nJ,) of the sides of the box of velocities.

    Raises:
        NoTransmission: At a configuration, G or B_J does not exist, or the joints depend on each other.
        NotClosable: The loops are open at q.
        ValueError: A motor has no limit, or cannot be without torque; or an argument is wrong, as in `transmission`.
    """
    if isinstance(q, Workspace):
        if q.robot is not robot or selection(robot, joints).names != q.joints:
            raise ValueError(f"the workspace is that of another robot, or of other joints: {', '.join(q.joints)}")
        return _everywhere(q, torque_ratio, velocity_ratio)
    chosen, by = sides(robot, joints, motors)
    each, single = configurations(robot, q)
    if single:
        one = at_one(robot, chosen, each[0], by)
        return _task(robot, one, by, torque_ratio, velocity_ratio).limits(_complete(one, "q"))
    many = at_many(robot, chosen, each, by)
    task = _task(robot, many, by, torque_ratio, velocity_ratio)
    if not len(many):
        raise ValueError("q has no rows; give at least one configuration")
    return _common(task, many)


@dataclass(frozen=True, eq=False)
class _LimitsTask:
    """What is the same at all configurations: names, the ranges of the motors, and the ratios of the boxes."""

    joints: tuple[str, ...]
    motors: tuple[str, ...]
    lower: Vector
    upper: Vector
    fastest: Vector
    torque_ratio: Vector | None
    velocity_ratio: Vector | None

    def limits(self, G: Matrix) -> SerialLimits:
        """The limits for a G (nm, nJ)."""
        ratios = self.torque_ratio, self.velocity_ratio
        return SerialLimits(self.joints, self.motors, self.torque(G), self.velocity(G), *ratios)

    def torque(self, G: Matrix) -> Polytope:
        """The torques that the motors can produce."""
        return image_of_box(G, self.lower, self.upper)

    def velocity(self, G: Matrix) -> Polytope:
        """The velocities that the motors allow."""
        return preimage_of_box(G, self.fastest)


def _task(
    robot: Robot,
    at: Transmission | Transmissions,
    motors: Selection,
    torque_ratio: Named | None,
    velocity_ratio: Named | None,
) -> _LimitsTask:
    given = {"torque_ratio": torque_ratio, "velocity_ratio": velocity_ratio}
    ratios = [_checked_ratio(name, ratio, at.joints) for name, ratio in given.items()]
    _complete(at, "q") if isinstance(at, Transmission) else _all_complete(at)
    return _LimitsTask(at.joints, at.motors, *finite_ranges(robot, motors.names, motors.velocities), *ratios)


def _common(
    task: _LimitsTask, at: Transmissions, margins: tuple[float | None, float | None] = (None, None)
) -> CommonLimits:
    """The limits at several configurations; boxes are made smaller by the margins."""
    found = [task.limits(G) for G in _all_complete(at)]
    torque, torque_bounded = _common_box([each.torque for each in found], task.torque_ratio)
    velocity, velocity_bounded = _common_box([each.velocity for each in found], task.velocity_ratio)
    return CommonLimits(
        task.joints,
        task.motors,
        torque / (1.0 + (margins[0] or 0.0)),
        velocity / (1.0 + (margins[1] or 0.0)),
        np.array([each.torque_axes for each in found]),
        np.array([each.velocity_axes for each in found]),
        torque_bounded,
        velocity_bounded,
        tuple(found),
        at.q,
        *margins,
    )


def _common_box(polytopes: Sequence[Polytope], ratio: Vector | None) -> tuple[Vector, Indices]:
    """The largest box in all polytopes, and the indices of those that bound it."""
    box = _box(np.vstack([each.A for each in polytopes]), np.concatenate([each.b for each in polytopes]), ratio)
    return box, np.flatnonzero([_used(each, box) > _BOUNDS for each in polytopes])


def _used(polytope: Polytope, box: Vector) -> float:
    """The largest part of a half-space that a box uses; more than 1 if a corner is outside."""
    return float((np.abs(polytope.A) @ box / polytope.b).max())


def _everywhere(space: Workspace, torque_ratio: Named | None, velocity_ratio: Named | None) -> CommonLimits:
    """The limits in a workspace."""
    edge = [point for point in space.boundary if point.stop.kind in ("range", "joint", "motor", "passive")]
    positions = np.vstack([space.positions, *(point.position[None] for point in edge)])
    q = np.vstack([space.q, *(point.q[None] for point in edge)])
    at = space.transmissions_at(q)
    task = _task(space.robot, at, space.selections[1], torque_ratio, velocity_ratio)
    margins = []
    for polytope, ratio in ((task.torque, task.torque_ratio), (task.velocity, task.velocity_ratio)):
        positions, q, margin = _refined(space, polytope, ratio, positions, q)
        margins.append(margin)
    return _common(task, space.transmissions_at(q), (margins[0], margins[1]))


def _refined(
    space: Workspace, polytope: Callable[[Matrix], Polytope], ratio: Vector | None, positions: Matrix, q: Matrix
) -> tuple[Matrix, Matrix, float]:
    """Poses with those added, around the ones that bound the box, at which it does not hold; and the margin."""
    n = positions.shape[1]
    cell = np.array([axis[1] - axis[0] for axis in space.axes])
    around = np.array([move for move in product((-1.0, 0.0, 1.0), repeat=n) if any(move)])
    polytopes = [polytope(G) for G in space.transmissions_at(q).G]
    margin = 0.0
    for level in range(1, _SEARCHES + 1):
        box, _ = _common_box(polytopes, ratio)
        used = np.array([_used(each, box) for each in polytopes])
        worst = np.argsort(-used)[:_WORST]
        to = (positions[worst, None] + 0.5**level * around * cell).reshape(-1, n)
        near = space.moved(np.repeat(q[worst], len(around), axis=0), to)
        reached = np.isfinite(near).all(axis=1)
        at = space.transmissions_at(near[reached])
        found = [polytope(G) for G in at.G]
        exceeded = np.array([_used(each, box) for each in found]) - 1.0
        margin = float(exceeded.max(initial=0.0))
        new = np.flatnonzero(exceeded > 0.0)
        positions, q = np.vstack((positions, to[reached][new])), np.vstack((q, near[reached][new]))
        polytopes += [found[index] for index in new.tolist()]
    return positions, q, margin


def _box(A: Matrix, b: Vector, ratio: Vector | None) -> Vector:
    return largest_box(A, b) if ratio is None else box_along(A, b, ratio)


def _all_complete(at: Transmissions) -> Matrix:
    """G (B, nm, nJ), each of rank nJ."""
    complete = (at.rank_joints == at.rank_motors) & (at.rank_joints == len(at.joints))
    for index in np.flatnonzero(~(complete & np.isfinite(at.G).all(axis=(1, 2)))).tolist():
        _complete(at[index], f"q[{index}]")
    return at.G


def _complete(at: Transmission, place: str) -> Matrix:
    """G (nm, nJ), of rank nJ."""
    G, _ = require(at, "G", "B_J", place=f" at {place}")
    if at.rank_joints < len(at.joints):
        raise NoTransmission(f"a set of limits at {place}", "the joints depend on each other; leave out some of them")
    return G


def _checked_ratio(name: str, ratio: Named | None, joints: Sequence[str]) -> Vector | None:
    if ratio is None:
        return None
    given = vector_of(ratio, joints, name)
    if not (given > 0.0).all():
        raise ValueError(f"{name} is {given.tolist()}; expected positive numbers")
    return given
