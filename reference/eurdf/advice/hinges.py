"""Whether a closure is rather a hinge: found by trial, about the axes that its frames and its neighbours have."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from eurdf.array import Vector
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
    mechanism = robot.mechanism
    group = [closure for closure in mechanism.closures if closure.name in loop.closures]
    coupled = tuple(coupling for coupling in mechanism.couplings if coupling.name in loop.closures)
    tried = 0
    for closure in group:
        if type(closure) not in (PointClosure, FrameClosure):
            continue
        for axes in _axes(robot, q, closure):
            if tried == _MOST_TRIED:
                return None
            tried += 1
            hinge = HingeClosure(closure.name, closure.a, closure.b, axes=axes)
            closures = tuple(hinge if each is closure else each for each in group)
            trial = build_robot(replace(mechanism, closures=closures, couplings=coupled), geometry=False)
            # The trial has the couplings of the group alone, and a continuous joint has other coordinates if coupled.
            at = trial.configuration(robot.joint_positions(q))
            found = next((each for each in analyze(trial, at).loops if each.closures == loop.closures), None)
            if found is not None and found.finite_mobility == found.mobility and is_better(trial, found):
                return LikelyHinge(closure.name, axes)
    return None


def _axes(robot: Robot, q: Vector, closure: Closure) -> Iterator[tuple[Vector3, Vector3]]:
    """Directions, in A and in B: of the axes of both frames, and of the joints that carry them."""
    model = robot.model
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    sites = [robot.tree.site(anchor) for anchor in closure.anchors]
    frames = [data.oMi[joint].rotation @ placement.rotation for joint, placement in sites]
    directions = [frame[:, index] for frame in frames for index in (2, 0, 1)]
    directions += [axis for joint, _ in sites for axis in _joint_axis(robot, data, joint, q)]
    seen: list[Vector] = []
    for direction in directions:
        if all(min(np.linalg.norm(direction - other), np.linalg.norm(direction + other)) > _ALIKE for other in seen):
            seen.append(direction)
            yield _in_frame(frames[0], direction), _in_frame(frames[1], direction)


def _joint_axis(robot: Robot, data: pin.Data, joint: int, q: Vector) -> Sequence[Vector]:
    """The axis of a joint that turns about one, in the world."""
    model = robot.model
    if model.nvs[joint] != 1 or joint in robot.tree.in_series.values():
        return ()
    own = model.joints[joint].createData()
    model.joints[joint].calc(own, q)
    slides, turns = np.split(own.S.reshape(6), 2)
    return () if slides.any() else (data.oMi[joint].rotation @ turns,)


def _in_frame(rotation: Vector, direction: Vector) -> Vector3:
    x, y, z = (rotation.T @ direction).tolist()
    return x, y, z


def _shown(axis: Sequence[float]) -> str:
    return f"[{', '.join(f'{number:g}' for number in axis)}]"
