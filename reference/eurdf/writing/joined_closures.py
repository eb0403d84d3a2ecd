"""Several 3d closures of two bodies as the one closure that they are: a hinge, or 6d if the points are on no line."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from eurdf.array import Matrix
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.diagnostics import enumerated
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import RIGID, Closure
from eurdf.mechanism.pose import Pose, Vector3, direction

#: Distances in the two bodies that differ by no more are equal, m: files state positions with six digits.
_ROUNDING = 1e-5

#: The same, as a part of the distance of the points.
_RELATIVE = 1e-4

#: Points nearer to each other than this are one point, m.
_SHORTEST = 1e-6

#: A unit vector that is nearer than this to an axis of its frame is that axis: the rest is rounding.
_ON_AXIS = 1e-12


@dataclass(frozen=True, slots=True)
class Joined:
    """A closure that takes the place of several.

    Attributes:
        closure: A hinge, or a 6d closure; its name and its origins are those of the first point.
        points: Names of the 3d closures.
    """

    closure: Closure
    points: tuple[str, ...]

    def __str__(self) -> str:
        kind = "hinge" if isinstance(self.closure, HingeClosure) else "6d closure"
        return f"{enumerated(self.points)} are one {kind}: their points are as far apart in both bodies"


@dataclass(frozen=True, slots=True)
class Apart:
    """Two 3d closures of the same two bodies that cannot both be closed, and the distances of their points there, m."""

    names: tuple[str, str]
    distances: tuple[float, float]

    def __str__(self) -> str:
        (one, other), (a, b) = self.names, self.distances
        return f"'{one}' and '{other}' join the same bodies, but are {a:g} m apart in one and {b:g} m in the other"


@dataclass(frozen=True, slots=True)
class JoinedClosures:
    """The closures of a mechanism, those of points joined.

    Attributes:
        closures: In the order of the first of each.
        joined: Those that take the place of several.
        apart: 3d closures that cannot be joined.
    """

    closures: tuple[Closure, ...]
    joined: tuple[Joined, ...]
    apart: tuple[Apart, ...]


@dataclass(frozen=True, slots=True)
class _Point:
    """A 3d closure of two rigid bodies, each of one or several links that are fixed to each other.

    Attributes:
        index: Of the closure.
        closure: The closure, with frame A in the first body.
        poses: Poses of its frames in the two bodies.
    """

    index: int
    closure: PointClosure
    poses: tuple[Pose, Pose]


def join_points(closures: Sequence[Closure], poses: Mapping[str, tuple[str, Pose]]) -> JoinedClosures:
    """Join the 3d closures of the same two bodies whose points are as far apart in both.

    Two such points, and more on a line, hold a hinge; others fix one body to the other. As 3d closures, they have
    redundant rows.
    """
    groups: dict[tuple[str, str], list[list[_Point]]] = {}
    for index, closure in enumerate(closures):
        if type(closure) is not PointClosure or closure.compliance != RIGID:
            continue
        (one, at), (other, beyond) = (poses[end.body] for end in closure.anchors)
        if one == other:
            continue
        pair = (one, other)
        if (other, one) in groups:
            pair = (other, one)
            closure = PointClosure(closure.name, closure.b, closure.a)
            at, beyond = beyond, at
        point = _Point(index, closure, (at * closure.a.pose, beyond * closure.b.pose))
        found = groups.setdefault(pair, [])
        together = next((group for group in found if _fits([*group, point])), None)
        if together is None:
            found.append([point])
        else:
            together.append(point)
    kept = dict(enumerate(closures))
    joined = []
    for group in itertools.chain.from_iterable(groups.values()):
        if len(group) > 1:
            whole = _joined(group)
            joined.append(Joined(whole, tuple(point.closure.name for point in group)))
            kept[group[0].index] = whole
            for point in group[1:]:
                del kept[point.index]
    apart = tuple(itertools.chain.from_iterable(map(_apart, groups.values())))
    return JoinedClosures(tuple(kept.values()), tuple(joined), apart)


def _apart(groups: Sequence[Sequence[_Point]]) -> Iterable[Apart]:
    """The first points of groups that cannot both be closed; two at the same place are redundant, but can."""
    for one, other in itertools.combinations((group[0] for group in groups), 2):
        a, b = _distances(one, other)
        if abs(a - b) > _tolerance(a, b):
            yield Apart((one.closure.name, other.closure.name), (a, b))


def _distances(one: _Point, other: _Point) -> tuple[float, float]:
    a, b = (math.dist(one.poses[side].xyz, other.poses[side].xyz) for side in (0, 1))
    return a, b


def _tolerance(*distances: float) -> float:
    return max(_SHORTEST, min(_ROUNDING, _RELATIVE * max(distances)))


def _fits(group: Sequence[_Point]) -> bool:
    """Whether the last point of a group is apart from the others, and a motion of the body takes all points there."""
    *others, last = group
    for point in others:
        a, b = _distances(point, last)
        if min(a, b) <= _SHORTEST or not abs(a - b) <= _tolerance(a, b):  # also where they overflow
            return False
    if len(group) == 2:
        return True
    P, Q, size = _shape(group)
    turned = [_rotation(P, Q).rotate((x, y, z)) for x, y, z in (Q - Q.mean(axis=0)).tolist()]
    error = float(np.linalg.norm(P - P.mean(axis=0) - turned, axis=1).max())
    return error * size <= _tolerance(size)


def _shape(group: Sequence[_Point]) -> tuple[Matrix, Matrix, float]:
    """The points (n, 3) from the first one, in the two bodies, in units of the largest distance; and that, m."""
    first = group[0]
    size = max(_distances(first, point)[0] for point in group)
    P, Q = (np.array([np.subtract(point.poses[side].xyz, first.poses[side].xyz) for point in group]) for side in (0, 1))
    return P / size, Q / size, size


def _rotation(P: Matrix, Q: Matrix) -> Pose:
    """The rotation that brings points Q (n, 3) nearest to points P, as Horn (1987) finds it: never a reflection."""
    S = (Q - Q.mean(axis=0)).T @ (P - P.mean(axis=0))
    N = np.empty((4, 4))
    N[0, 0] = np.trace(S)
    N[0, 1:] = N[1:, 0] = (S[1, 2] - S[2, 1], S[2, 0] - S[0, 2], S[0, 1] - S[1, 0])
    N[1:, 1:] = S + S.T - np.trace(S) * np.eye(3)
    w, x, y, z = map(float, np.linalg.eigh(N)[1][:, -1])
    return Pose(quaternion=(x, y, z, w))


def _joined(group: Sequence[_Point]) -> Closure:
    first = group[0]
    P, Q, size = _shape(group)
    far = int(np.linalg.norm(P, axis=1).argmax())
    name, a, b = first.closure.name, first.closure.a, first.closure.b
    at, beyond = first.poses
    off_line = float(np.linalg.norm(np.cross(P[far], P), axis=1).max())
    if off_line * size <= _tolerance(size):
        one, other = (_axis(first.poses[side], group[far].poses[side].xyz) for side in (0, 1))
        return HingeClosure(name, a, b, (one, other))
    # Frame B turns to where A is when the points meet.
    turn = beyond.inverse() * _rotation(P, Q).inverse() * at
    return FrameClosure(name, a, Anchor(b.body, b.pose * Pose(quaternion=turn.quaternion)))


def _axis(frame: Pose, end: Vector3) -> Vector3:
    """The unit vector in a frame from its origin to a point that is given where the frame is."""
    x, y, z = direction(frame.inverse().act(end))
    nearest: Vector3 = (float(round(x)), float(round(y)), float(round(z)))
    return nearest if math.dist((x, y, z), nearest) < _ON_AXIS else (x, y, z)
