"""How far constraints are open at one configuration, also after a small change of the mechanism."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from eurdf.array import Mask, Matrix, Vector
from eurdf.closures.kind import ClosureKind, PoseArrays
from eurdf.closures.se3 import rotation_of
from eurdf.mechanism.body import WORLD, Anchor
from eurdf.mechanism.constraint import Constraint
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3

#: A side of a closure: its number among the constraints, and 0 for frame A, 1 for frame B.
Side = tuple[int, int]

# Axes that differ by less, in rad, are parallel.
_PARALLEL = 1e-9


@dataclass(frozen=True, slots=True)
class Change:
    """What is otherwise in a changed mechanism: frames of closures, joints by name, constraints by number.

    The coordinates of joints are those of files; a joint that mimics a changed one is to be in it, too.
    """

    anchors: Mapping[Side, Anchor] = field(default_factory=dict)
    placements: Mapping[str, Pose] = field(default_factory=dict)
    parents: Mapping[str, str] = field(default_factory=dict)
    coordinates: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    constraints: Mapping[int, Constraint] = field(default_factory=dict)

    @property
    def joints(self) -> set[str]:
        """The joints that are otherwise."""
        return {*self.placements, *self.parents, *self.coordinates}


class StatedPose:
    """A mechanism at one configuration, whose tree is walked once.

    Attributes:
        mechanism: The mechanism.
        coordinates: Those of each joint that moves, also of one that mimics another, as files have them.
        above: For each body but the root, the joint that carries it.
        joints: The joints by name.
        poses: Of each body, in the root.
        of_joint: For each joint, the numbers of the constraints that it changes.
    """

    def __init__(self, mechanism: Mechanism, coordinates: Mapping[str, Sequence[float]]) -> None:
        self.mechanism, self.coordinates = mechanism, coordinates
        self.constraints = mechanism.constraints
        self.above = {joint.child: joint for joint in mechanism.joints}
        self.joints = {joint.name: joint for joint in mechanism.joints}
        self._moved = {joint.name: self._motion(joint.name, joint) for joint in mechanism.joints}
        self.poses = {WORLD: IDENTITY, mechanism.bodies[0].name: IDENTITY}
        for joint in mechanism.joints:  # parents come first
            self.poses[joint.child] = self.poses[joint.parent] * joint.placement * self._moved[joint.name]
        self._turned: dict[str, Matrix] | None = None
        self._chains: dict[str, tuple[str, ...]] = {}
        self._base = [self._opening(index, None) for index in range(len(self.constraints))]
        self.of_joint: dict[str, list[int]] = {}
        for index, constraint in enumerate(self.constraints):
            of_frames = (name for names in self.between(index) for name in names) if constraint.anchors else ()
            for name in (*of_frames, *constraint.joints):
                self.of_joint.setdefault(name, []).append(index)

    def _motion(self, name: str, joint: Any, coordinates: Sequence[float] | None = None) -> Pose:
        found = self.coordinates.get(name) if coordinates is None else coordinates
        moved: Pose = joint.offset if found is None else joint.transform(found) * joint.offset
        return moved

    def opening(self, index: int) -> float:
        """How far a constraint is open, m or rad."""
        return self._base[index]

    def chain(self, body: str) -> tuple[str, ...]:
        """The joints from a body up to the root."""
        if body not in self._chains:
            names, at = [], body
            while (joint := self.above.get(at)) is not None:
                names.append(joint.name)
                at = joint.parent
            self._chains[body] = tuple(names)
        return self._chains[body]

    def between(self, index: int) -> tuple[list[str], list[str]]:
        """For each frame of a closure, the joints up to where both meet."""
        a, b = (self.chain(anchor.body) for anchor in self.constraints[index].anchors)
        shared = set(a) & set(b)
        return [name for name in a if name not in shared], [name for name in b if name not in shared]

    def frame(self, side: Side, change: Change | None = None) -> Pose:
        """Pose of a frame of a closure in the root."""
        index, of = side
        anchor = self.constraints[index].anchors[of]
        if change is None:
            return self.poses[anchor.body] * anchor.pose
        anchor = change.anchors.get(side, anchor)
        return self._pose(anchor.body, change) * anchor.pose

    def _pose(self, body: str, change: Change) -> Pose:
        """Pose of a body, walked up to where nothing is otherwise."""
        changed, last = change.joints, 0
        path, at = [], body
        while (joint := self.above.get(at)) is not None:
            path.append(joint)
            at = change.parents.get(joint.name, joint.parent)
            if joint.name in changed:
                last = len(path)
        if not last:
            return self.poses[body]
        top = path[last - 1]
        pose = self.poses[change.parents.get(top.name, top.parent)]
        for joint in reversed(path[:last]):
            moved = self._moved[joint.name]
            if joint.name in change.coordinates:
                moved = self._motion(joint.name, joint, change.coordinates[joint.name])
            pose = pose * change.placements.get(joint.name, joint.placement) * moved
        return pose

    def _opening(self, index: int, change: Change | None, enough: float = math.inf) -> float:
        """How far a constraint is open; infinite if it is open by more than enough, or no joint moves its frames."""
        constraint = self.constraints[index]
        if change is not None:
            constraint = change.constraints.get(index, constraint)
        if not isinstance(constraint, ClosureKind):
            coefficients = dict(getattr(constraint, "coefficients", ()))
            stated = {**self.coordinates, **(change.coordinates if change else {})}
            value = sum(c * stated[name][0] for name, c in coefficients.items()) - getattr(constraint, "offset", 0.0)
            return float(abs(value) / max(map(abs, coefficients.values())))
        a, b = (self.frame((index, side), change) for side in (0, 1))
        if change is not None and self._is_rigid(index, change):
            return math.inf
        if meets(constraint) and math.dist(a.xyz, b.xyz) > enough:
            return math.inf
        found = constraint.opening(relative(a, b), constraint.prepare([constraint]))
        return max(float(each[0, 0]) for each in found)

    def _is_rigid(self, index: int, change: Change) -> bool:
        """Whether no joint moves the frames of a closure against each other."""
        roots = []
        for side in (0, 1):
            at = change.anchors.get((index, side), self.constraints[index].anchors[side]).body
            while (joint := self.above.get(at)) is not None and joint.type.is_fixed:
                at = change.parents.get(joint.name, joint.parent)
            roots.append(at)
        return roots[0] == roots[1]

    def closed_by(self, change: Change, tolerance: float, closed: float) -> int:
        """How many constraints a change closes, to a tolerance, m or rad; 0 if it opens another one.

        Those count as open that are by more than ``closed``.
        """
        count = 0
        affected = {index for index, _ in change.anchors} | set(change.constraints)
        for index in affected.union(*(self.of_joint.get(name, ()) for name in change.joints)):
            is_closed = self._opening(index, change, tolerance) <= tolerance
            was_closed = self._base[index] <= closed
            if was_closed and not is_closed:
                return 0
            count += is_closed and not was_closed
        return count

    def points(self, bodies: Sequence[str], local: Vector3) -> Matrix:
        """A point that each of some bodies carries at the same place in its frame, in the root: (n, 3), m."""
        if self._turned is None:
            R = rotation_of(np.array([pose.quaternion for pose in self.poses.values()]))
            self._turned = dict(zip(self.poses, R, strict=True))
        R = np.array([self._turned[body] for body in bodies])
        return np.asarray(R @ np.array(local) + np.array([self.poses[body].xyz for body in bodies]))

    def reached(self, index: int, points: Matrix, other: Vector3, tolerance: float) -> Mask:
        """Which points (n, 3), in the root, m, the origin of a frame of a closure can be at, by that of the other."""
        constraint, p = self.constraints[index], points.reshape(-1, 3) - np.array(other)
        if meets(constraint):
            return np.asarray(np.linalg.norm(p, axis=1) <= tolerance)
        assert isinstance(constraint, ClosureKind)
        with np.errstate(invalid="ignore"):  # where both are at one place
            found = constraint.of_distance(p, np.zeros_like(p), constraint.prepare([constraint]))
        return np.ones(len(p), bool) if found is None else np.abs(found[0]) <= tolerance

    def unmoved(self, index: int) -> Vector | None:
        """The part (3,), m, in the root, of the gap of a closure that no joint changes at any configuration; or None.

        That is along the axis of the joints of its loop if all turn about parallel axes, and slide across them; or if
        all slide, across them.
        """
        constraint = self.constraints[index]
        if not constraint.anchors or not meets(constraint):
            return None
        turns, slides = [], []
        for name in (name for names in self.between(index) for name in names):
            joint = self.joints[name]
            to_root = self.poses[joint.parent] * joint.placement
            for motion in joint.motions:
                if motion.axis is None:
                    return None
                axis = np.array(to_root.rotate(motion.axis))
                if motion.turns:
                    turns.append(axis)
                if motion.advance:
                    slides.append(axis)
        a, b = (np.array(self.frame((index, side)).xyz) for side in (0, 1))
        gap = b - a
        if turns:
            axis = turns[0]
            parallel = all(np.linalg.norm(np.cross(axis, each)) <= _PARALLEL for each in turns)
            across = all(abs(float(axis @ each)) <= _PARALLEL for each in slides)
            return np.asarray(axis * (axis @ gap)) if parallel and across else None
        if not slides:
            return np.asarray(gap)
        basis, values, _ = np.linalg.svd(np.array(slides).T, full_matrices=False)
        basis = basis[:, values > _PARALLEL]
        return np.asarray(gap - basis @ (basis.T @ gap))


def meets(constraint: Constraint) -> bool:
    """Whether a constraint holds the origins of its frames together."""
    return constraint.units[:3] == ("m", "m", "m")


def relative(a: Pose, b: Pose) -> PoseArrays:
    """ᴬM_B of one pair of frames at one configuration."""
    found = a.inverse() * b
    return PoseArrays(rotation_of(np.array([[found.quaternion]])), np.array([[found.xyz]]))
