"""Parsers with other residuals and constraint Jacobians, of closures and couplings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from eurdf_conformance.oracle import configuration, coupling, distance, hinge, jacobian, robot, version2
from eurdf_conformance.oracle.description import Coupling
from eurdf_conformance.oracle.logarithm import log6
from eurdf_conformance.oracle.spatial import inverse, skew
from mutants.mutant import Deviation, instead


def _residual(kind: str, change: Callable[[Any], Any]) -> Deviation:
    """The residual of a type of closure is another function of aMb."""

    def changed(right: Any, at: Any, of: str, a: Any, b: Any) -> Any:
        return change(inverse(at.pose(a)) @ at.pose(b)) if of == kind else right(at, of, a, b)

    return instead(robot, "residual", changed)


def _sines(aMb: Any) -> Any:
    skew_part = (aMb[:3, :3] - aMb[:3, :3].T) / 2
    return np.concatenate([log6(aMb)[:3], skew_part[[2, 0, 1], [1, 2, 0]]])


def _along_the_world(right: Any, at: Any, of: str, a: Any, b: Any) -> Any:
    found = right(at, of, a, b)
    return (at.root @ at.pose(a))[:3, :3] @ found if of == "3d" else found


def _hinge(rows: Callable[[Any, Any, Any], Any]) -> Deviation:
    """The rows of a hinge are others: rows(aMb, axis in A, axis in B), the angular ones or all."""

    def changed(right: Any, at: Any, a: Any, b: Any, axes: Any) -> Any:
        aMb = inverse(at.pose(a)) @ at.pose(b)
        found = rows(aMb, *axes)
        return found if len(found) == 5 else np.concatenate([aMb[:3, 3], found])

    return instead(hinge, "residual", changed)


def _of_log6(aMb: Any, a: Any, b: Any) -> Any:
    r = log6(aMb)
    return np.concatenate([r[:3], hinge.plane(a).T @ r[3:]])


def _distance(change: Callable[[float, float], float]) -> Deviation:
    """The residual of a distance is another: change(|p|, length)."""

    def changed(right: Any, at: Any, a: Any, b: Any, length: float) -> Any:
        return np.array([change(float(right(at, a, b, length)[0]) + length, length)])

    return instead(distance, "residual", changed)


def _k(change: Callable[[Any, Any, Any, Any], Any]) -> Deviation:
    """K is another: change(rows, kinematics, A, B)."""

    def changed(right: Any, at: Any, sharing: Any, kind: str, a: Any, b: Any) -> Any:
        return change(right(at, sharing, kind, a, b), at, a, b)

    return instead(robot, "jacobian", changed)


def _turned(K: Any, M: Any) -> Any:
    return np.kron(np.eye(len(K) // 3), M[:3, :3]) @ K


def _without_the_branch_of_a(right: Any, at: Any, sharing: Any, kind: str, a: Any, b: Any) -> Any:
    moves = at.moves.copy()
    moves[a.body] = False
    return right(replace(at, moves=moves), sharing, kind, a, b)


def _without_mimic_joints(right: Any, of: Any) -> Any:
    columns = [not joint.mimic for joint in of.joints for _ in range(joint.kind.nv)]
    return right(of) * np.array(columns)[:, None]


def _coupling(change: Callable[[Coupling, dict[str, float]], dict[str, Any]]) -> Deviation:
    """A coupling is read as another one: change(coupling, coefficients) -> what differs."""

    def changed(right: Any, value: Any) -> Any:
        read = right(value)
        return replace(read, **change(read, dict(read.coefficients)))

    return instead(version2, "coupling", changed)


def _within_half_a_turn(right: Any, tree: Any, q: Any, of: Coupling) -> Any:
    continuous = {joint.name for joint in tree.joints if joint.type == "continuous"}
    wrapped = {name: [float(np.arctan2(np.sin(at), np.cos(at))) for at in values] for name, values in q.items()}
    return right(tree, {name: wrapped[name] if name in continuous else q[name] for name in q}, of)


_plane = partial(instead, hinge, "plane")

MEANS = {
    "EU-CLO-008": {
        "The rows of a 6d closure are angular, then linear.": _residual("6d", lambda aMb: np.roll(log6(aMb), 3)),
        "The residual of a 6d closure is that of the pose of A in B.": _residual("6d", lambda aMb: log6(inverse(aMb))),
        "The linear rows of a 6d closure are the position of B in A, not those of log6.": _residual(
            "6d", lambda aMb: np.concatenate([aMb[:3, 3], log6(aMb)[3:]])
        ),
        "The angular rows of a 6d closure are those of the skew part of the rotation, as for small angles.": _residual(
            "6d", _sines
        ),
        "A 6d closure holds the positions of its frames alone.": _residual("6d", lambda aMb: aMb[:3, 3]),
    },
    "EU-CLO-009": {
        "A 3d closure holds orientations too.": _residual("3d", log6),
        "The residual of a 3d closure is the origin of A in B.": _residual("3d", lambda aMb: inverse(aMb)[:3, 3]),
        "The residual of a 3d closure has the opposite sign.": _residual("3d", lambda aMb: -aMb[:3, 3]),
        "The residual of a 3d closure is along the axes of the world.": instead(robot, "residual", _along_the_world),
    },
    "EU-CLO-014": {
        "The angular rows of a hinge are components of a cross product, zero at opposite axes too.": _hinge(
            lambda aMb, a, b: hinge.plane(a).T @ np.cross(a, aMb[:3, :3] @ b)
        ),
        "The rows of a hinge are those of log6, without the rotation about the axis.": _hinge(_of_log6),
        "The angular rows of a hinge are those of the rotation from the axis in B to that in A.": instead(
            hinge, "residual", lambda right, at, a, b, axes: right(at, a, b, axes) * [1, 1, 1, -1, -1]
        ),
        "The angular rows of a hinge are along x and y of A, whatever its axis.": _plane(
            lambda right, a: np.eye(3)[:, :2]
        ),
        "The angular rows of a hinge whose axis is nearly -z are not along those of the half turn about x.": _plane(
            lambda right, a: right(a) * [-1, -1] if np.hypot(a[0], a[1]) < 1e-9 > a[2] else right(a)
        ),
        "The first axis of a hinge is in B, the second one in A.": instead(
            version2, "hinge_axes", lambda right, members: right(members)[::-1]
        ),
        "A hinge that states no axis turns about x.": instead(
            version2, "hinge_axes", lambda right, members: right({"axis": [1, 0, 0]} | members)
        ),
    },
    "EU-CLO-015": {
        "The residual of a distance is a difference of squares.": _distance(lambda apart, length: apart**2 - length**2),
        "The residual of a distance is positive where the origins are too near, too.": _distance(
            lambda apart, length: abs(apart - length)
        ),
        "The residual of a distance is the length minus the distance of the origins.": _distance(
            lambda apart, length: length - apart
        ),
        "The residual of a distance is relative to its length.": _distance(lambda apart, length: apart / length - 1.0),
        "Every distance is 1 m.": instead(version2, "distance_length", lambda right, members: 1.0),
    },
    ("EU-CLO-010", "2.1"): {
        "K of a distance is the derivative of half the square of the distance of the origins.": instead(
            distance, "derivative", lambda right, aMb: right(aMb) * np.linalg.norm(aMb[:3, 3])
        ),
        "K of a coupling has 1 and -1 for its coefficients.": instead(
            coupling, "jacobian", lambda right, velocities, of: np.sign(right(velocities, of))
        ),
    },
    "EU-CLO-010": {
        "K of a 6d closure is the twist of B relative to A, as if the closure were closed.": instead(
            jacobian, "log6_derivative", lambda right, r: np.eye(6)
        ),
        "K of a 6d closure has the derivative of the exponential for that of the logarithm.": instead(
            jacobian, "log6_derivative", lambda right, r: np.linalg.inv(right(r))
        ),
        "K of a 3d closure leaves out that A turns, as if the closure were closed.": instead(
            jacobian, "skew", lambda right, p: 0 * skew(p)
        ),
        "The rows of K are along the axes of the world, Pinocchio's LOCAL_WORLD_ALIGNED.": _k(
            lambda K, at, a, b: _turned(K, at.root @ at.pose(a))
        ),
        "The rows of K are along the axes of B.": _k(lambda K, at, a, b: _turned(K, inverse(at.pose(b)) @ at.pose(a))),
        "K is the derivative of the negative residual.": _k(lambda K, at, a, b: -K),
        "K lacks its rows of zeros, as those by which a planar loop closed in 6d is redundant.": _k(
            lambda K, at, a, b: K[np.any(np.abs(K) > 1e-12, axis=1)]
        ),
        "K leaves out the joints that move A.": instead(robot, "jacobian", _without_the_branch_of_a),
    },
    ("EU-CLO-010", "2"): {  # in version 1 no joint mimics
        "K leaves out the velocities of joints that mimic.": instead(configuration, "sharing", _without_mimic_joints),
    },
    "EU-CPL-005": {
        "The offset of a coupling is added to the sum.": _coupling(lambda read, of: {"offset": -read.offset}),
        "The offset of a coupling is left out.": _coupling(lambda read, of: {"offset": 0.0}),
        "A coupling ends with its second joint.": _coupling(
            lambda read, of: {"coefficients": dict(list(of.items())[:2])}
        ),
        "The coefficient of the first joint of a coupling is taken as 1.": _coupling(
            lambda read, of: {"coefficients": of | {next(iter(of)): 1.0}}
        ),
        "The residual of a coupling is divided by its largest coefficient.": instead(
            coupling,
            "residual",
            lambda right, tree, q, of: right(tree, q, of) / max(map(abs, of.coefficients.values())),
        ),
    },
    "EU-CPL-006": {
        "A coupled continuous joint is at an angle of at most half a turn.": instead(
            coupling, "residual", _within_half_a_turn
        ),
    },
}
