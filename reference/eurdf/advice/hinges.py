"""Whether a closure is rather a hinge: found by trial, about the axes that its frames and its neighbours have."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.kinematics.analysis import analyze
from eurdf.kinematics.loop_analysis import LoopAnalysis
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.pose import Vector3
from eurdf.pinocchio.robot import Robot, build_robot

#: So many robots are built and analysed at most.
_MOST_TRIED = 24

#: Unit vectors that differ by less are one direction.
_ALIKE = 1e-6

# Frames whose axes differ by less have one orientation: numbers in files are rounded.
_ALIGNED = 1e-5


class LikelyHinge(NamedTuple):
    """A closure that as a hinge leaves the motions that the actuators control, and fewer others.

    Attributes:
        closure: Name of the closure.
        axes: Unit vectors of the axis, in A and in B.
    """

    closure: str
    axes: tuple[Vector3, Vector3]

    def __str__(self) -> str:
        a, b = ([round(number, 6) + 0.0 for number in axis] for axis in self.axes)
        shown = f"axis: {_shown(a)}" if a == b else f"axes: [{_shown(a)}, {_shown(b)}]"
        return f"type hinge with {shown} (version 2.1)"


def likely_hinge(
    robot: Robot, q: Vector, loop: LoopAnalysis, is_better: Callable[[Robot, LoopAnalysis], bool]
) -> LikelyHinge | None:
    """The first 3d or 6d closure of a group of loops that is better as a hinge, about the first axis that is.

    The configuration (nq,) is closed. Whether the group ``is_better`` in a robot with the hinge is asked only if the
    loops can move as far as their rank says.
    """
    tried = 0
    for closure in closures_of(robot, loop):
        if type(closure) not in (PointClosure, FrameClosure, HingeClosure):
            continue
        for axes in _axes(robot, q, closure):
            if tried == _MOST_TRIED:
                return None
            tried += 1
            trial, found = with_closures(robot, q, loop, [HingeClosure(closure.name, closure.a, closure.b, axes=axes)])
            if found is not None and found.finite_mobility == found.mobility and is_better(trial, found):
                return LikelyHinge(closure.name, axes)
    return None


def closures_of(robot: Robot, loop: LoopAnalysis) -> list[Closure]:
    """The closures of a group of loops."""
    return [closure for closure in robot.mechanism.closures if closure.name in loop.closures]


def with_closures(
    robot: Robot, q: Vector, loop: LoopAnalysis, others: Sequence[Closure]
) -> tuple[Robot, LoopAnalysis | None]:
    """The robot with a group of loops alone, with other closures in the place of those of their names, and the group.

    The analysis starts at q (nq,); it is None if the group does not close, or falls apart.
    """
    mechanism, other = robot.mechanism, {closure.name: closure for closure in others}
    closures = tuple(other.get(each.name, each) for each in closures_of(robot, loop))
    coupled = tuple(coupling for coupling in mechanism.couplings if coupling.name in loop.closures)
    trial = build_robot(replace(mechanism, closures=closures, couplings=coupled), geometry=False)
    # The trial has the couplings of the group alone, and a continuous joint has other coordinates if coupled.
    at = trial.configuration(robot.joint_positions(q))
    return trial, next((each for each in analyze(trial, at).loops if each.closures == loop.closures), None)


def _axes(robot: Robot, q: Vector, closure: Closure) -> Iterator[tuple[Vector3, Vector3]]:
    """Directions, in A and in B: of the axes of both frames, and of the joints that carry them."""
    model = robot.model
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    sites = [robot.tree.site(anchor) for anchor in closure.anchors]
    frames = _orientations(data, sites)
    directions = [frame[:, index] for frame in frames for index in (2, 0, 1)]
    directions += [axis for joint, _ in sites if (axis := axis_of(robot, data, joint, q)) is not None]
    seen: list[Vector] = []
    for direction in directions:
        if all(min(np.linalg.norm(direction - other), np.linalg.norm(direction + other)) > _ALIKE for other in seen):
            seen.append(direction)
            yield _in_frame(frames[0], direction), _in_frame(frames[1], direction)


def are_aligned(robot: Robot, q: Vector, closures: Sequence[Closure]) -> list[bool]:
    """Whether frames A and B of each closure have one orientation at q (nq,)."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    turns = (_orientations(data, map(robot.tree.site, closure.anchors)) for closure in closures)
    return [bool(np.abs(a - b).max() <= _ALIGNED) for a, b in turns]


def _orientations(data: pin.Data, sites: Iterable[tuple[int, pin.SE3]]) -> list[Matrix]:
    return [data.oMi[joint].rotation @ placement.rotation for joint, placement in sites]


def axis_of(robot: Robot, data: pin.Data, joint: int, q: Vector, *, slides: bool = False) -> Vector | None:
    """The axis, a unit vector in the world, that a joint only turns about, or only slides along; None if it does not.

    The data has the poses of the joints at q (nq,).
    """
    model = robot.model
    if model.nvs[joint] != 1 or joint in robot.tree.in_series.values():
        return None
    own = model.joints[joint].createData()
    model.joints[joint].calc(own, q)
    linear, angular = np.split(own.S.reshape(6), 2)
    axis, other = (linear, angular) if slides else (angular, linear)
    return None if other.any() else data.oMi[joint].rotation @ axis


def _in_frame(rotation: Vector, direction: Vector) -> Vector3:
    x, y, z = (rotation.T @ direction).tolist()
    return x, y, z


def _shown(axis: Sequence[float]) -> str:
    return f"[{', '.join(f'{number:g}' for number in axis)}]"
