"""Parsers with other residuals and constraint Jacobians, of closures and couplings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from eurdf_conformance.oracle import configuration, coupling, distance, hinge, jacobian, robot, version2
from eurdf_conformance.oracle.description import Coupling
from eurdf_conformance.oracle.logarithm import log6
from eurdf_conformance.oracle.spatial import inverse, skew
from mutants.mutant import Deviation, instead, means


def _residual(kind: str, change: Callable[[Any], Any]) -> Deviation:
    """The residual of a type of closure is another function of aMb."""

    def changed(right: Any, at: Any, of: str, a: Any, b: Any) -> Any:
        return change(inverse(at.pose(a)) @ at.pose(b)) if of == kind else right(at, of, a, b)

    return instead(robot, "residual", changed)


wrong = means("EU-CLO-008")
wrong("The rows of a 6d closure are angular, then linear.", lambda: _residual("6d", lambda aMb: np.roll(log6(aMb), 3)))
wrong(
    "The residual of a 6d closure is that of the pose of A in B.",
    lambda: _residual("6d", lambda aMb: log6(inverse(aMb))),
)
wrong(
    "The linear rows of a 6d closure are the position of B in A, not those of log6.",
    lambda: _residual("6d", lambda aMb: np.concatenate([aMb[:3, 3], log6(aMb)[3:]])),
)


@means("EU-CLO-008")
def residual_6d_of_sines() -> Deviation:
    """The angular rows of a 6d closure are those of the skew part of the rotation, as for small angles."""

    def sines(aMb: Any) -> Any:
        skew_part = (aMb[:3, :3] - aMb[:3, :3].T) / 2
        return np.concatenate([log6(aMb)[:3], skew_part[[2, 0, 1], [1, 2, 0]]])

    return _residual("6d", sines)


wrong = means("EU-CLO-008")
wrong("A 6d closure holds the positions of its frames alone.", lambda: _residual("6d", lambda aMb: aMb[:3, 3]))

wrong = means("EU-CLO-009")
wrong("A 3d closure holds orientations too.", lambda: _residual("3d", log6))
wrong("The residual of a 3d closure is the origin of A in B.", lambda: _residual("3d", lambda aMb: inverse(aMb)[:3, 3]))
wrong("The residual of a 3d closure has the opposite sign.", lambda: _residual("3d", lambda aMb: -aMb[:3, 3]))


@means("EU-CLO-009")
def residual_3d_along_the_world() -> Deviation:
    """The residual of a 3d closure is along the axes of the world."""

    def changed(right: Any, at: Any, of: str, a: Any, b: Any) -> Any:
        found = right(at, of, a, b)
        return (at.root @ at.pose(a))[:3, :3] @ found if of == "3d" else found

    return instead(robot, "residual", changed)


def _hinge(change: Callable[[Any, Any], Any]) -> Deviation:
    """The residual of a hinge is another: change(aMb, axes)."""

    def changed(right: Any, at: Any, a: Any, b: Any, axes: Any) -> Any:
        return change(inverse(at.pose(a)) @ at.pose(b), axes)

    return instead(hinge, "residual", changed)


def _rows_of_hinge(aMb: Any, angular: Any) -> Any:
    return np.concatenate([aMb[:3, 3], angular])


wrong = means("EU-CLO-014")
wrong(
    "The angular rows of a hinge are components of a cross product, zero at opposite axes too.",
    lambda: _hinge(lambda M, axes: _rows_of_hinge(M, hinge.plane(axes[0]).T @ np.cross(axes[0], M[:3, :3] @ axes[1]))),
)


@means("EU-CLO-014")
def hinges_are_6d_without_a_row() -> Deviation:
    """The rows of a hinge are those of log6, without the rotation about the axis."""

    def rows(aMb: Any, axes: Any) -> Any:
        r = log6(aMb)
        return np.concatenate([r[:3], hinge.plane(axes[0]).T @ r[3:]])

    return _hinge(rows)


@means("EU-CLO-014")
def hinges_turn_the_other_way() -> Deviation:
    """The angular rows of a hinge are those of the rotation from the axis in B to that in A."""

    def changed(right: Any, at: Any, a: Any, b: Any, axes: Any) -> Any:
        return right(at, a, b, axes) * [1, 1, 1, -1, -1]

    return instead(hinge, "residual", changed)


wrong = means("EU-CLO-014")
wrong(
    "The angular rows of a hinge are along x and y of A, whatever its axis.",
    lambda: instead(hinge, "plane", lambda right, a: np.eye(3)[:, :2]),
)
wrong(
    "The angular rows of a hinge whose axis is nearly -z are not along those of the half turn about x.",
    lambda: instead(
        hinge, "plane", lambda right, a: right(a) * [-1, -1] if np.hypot(a[0], a[1]) < 1e-9 > a[2] else right(a)
    ),
)
wrong(
    "The first axis of a hinge is in B, the second one in A.",
    lambda: instead(version2, "hinge_axes", lambda right, members: right(members)[::-1]),
)
wrong(
    "A hinge that states no axis turns about x.",
    lambda: instead(version2, "hinge_axes", lambda right, members: right({"axis": [1, 0, 0]} | members)),
)


def _distance(change: Callable[[float, float], float]) -> Deviation:
    """The residual of a distance is another: change(|p|, length)."""

    def changed(right: Any, at: Any, a: Any, b: Any, length: float) -> Any:
        return np.array([change(float(right(at, a, b, length)[0]) + length, length)])

    return instead(distance, "residual", changed)


wrong = means("EU-CLO-015")
wrong(
    "The residual of a distance is a difference of squares.",
    lambda: _distance(lambda apart, length: apart**2 - length**2),
)
wrong(
    "The residual of a distance is positive where the origins are too near, too.",
    lambda: _distance(lambda apart, length: abs(apart - length)),
)
wrong(
    "The residual of a distance is the length minus the distance of the origins.",
    lambda: _distance(lambda apart, length: length - apart),
)
wrong(
    "The residual of a distance is relative to its length.",
    lambda: _distance(lambda apart, length: apart / length - 1.0),
)
wrong("Every distance is 1 m.", lambda: instead(version2, "distance_length", lambda right, members: 1.0))

wrong = means("EU-CLO-010", versions=("2.1",))
wrong(
    "K of a distance is the derivative of half the square of the distance of the origins.",
    lambda: instead(distance, "derivative", lambda right, aMb: right(aMb) * np.linalg.norm(aMb[:3, 3])),
)

wrong = means("EU-CLO-010")
wrong(
    "K of a 6d closure is the twist of B relative to A, as if the closure were closed.",
    lambda: instead(jacobian, "log6_derivative", lambda right, r: np.eye(6)),
)
wrong(
    "K of a 6d closure has the derivative of the exponential for that of the logarithm.",
    lambda: instead(jacobian, "log6_derivative", lambda right, r: np.linalg.inv(right(r))),
)
wrong(
    "K of a 3d closure leaves out that A turns, as if the closure were closed.",
    lambda: instead(jacobian, "skew", lambda right, p: 0 * skew(p)),
)


def _k(change: Callable[[Any, Any, Any, Any], Any]) -> Deviation:
    """K is another: change(rows, kinematics, A, B)."""

    def changed(right: Any, at: Any, sharing: Any, kind: str, a: Any, b: Any) -> Any:
        return change(right(at, sharing, kind, a, b), at, a, b)

    return instead(robot, "jacobian", changed)


wrong = means("EU-CLO-010")
wrong(
    "The rows of K are along the axes of the world, Pinocchio's LOCAL_WORLD_ALIGNED.",
    lambda: _k(lambda K, at, a, b: np.kron(np.eye(len(K) // 3), (at.root @ at.pose(a))[:3, :3]) @ K),
)
wrong(
    "The rows of K are along the axes of B.",
    lambda: _k(lambda K, at, a, b: np.kron(np.eye(len(K) // 3), (inverse(at.pose(b)) @ at.pose(a))[:3, :3]) @ K),
)
wrong("K is the derivative of the negative residual.", lambda: _k(lambda K, at, a, b: -K))
wrong(
    "K lacks its rows of zeros, as those by which a planar loop closed in 6d is redundant.",
    lambda: _k(lambda K, at, a, b: K[np.any(np.abs(K) > 1e-12, axis=1)]),
)


@means("EU-CLO-010")
def k_forgets_the_branch_of_a() -> Deviation:
    """K leaves out the joints that move A."""

    def changed(right: Any, at: Any, sharing: Any, kind: str, a: Any, b: Any) -> Any:
        moves = at.moves.copy()
        moves[a.body] = False
        return right(replace(at, moves=moves), sharing, kind, a, b)

    return instead(robot, "jacobian", changed)


@means("EU-CLO-010", versions=("2",))  # in version 1 no joint mimics
def k_forgets_mimic_joints() -> Deviation:
    """K leaves out the velocities of joints that mimic."""

    def sharing(right: Any, of: Any) -> Any:
        columns = [not joint.mimic for joint in of.joints for _ in range(joint.kind.nv)]
        return right(of) * np.array(columns)[:, None]

    return instead(configuration, "sharing", sharing)


def _reads(change: Callable[[Coupling], Coupling]) -> Deviation:
    """A coupling is read as another one."""
    return instead(version2, "coupling", lambda right, value: change(right(value)))


wrong = means("EU-CPL-005")
wrong("The offset of a coupling is added to the sum.", lambda: _reads(lambda read: replace(read, offset=-read.offset)))
wrong("The offset of a coupling is left out.", lambda: _reads(lambda read: replace(read, offset=0.0)))
wrong(
    "A coupling ends with its second joint.",
    lambda: _reads(lambda read: replace(read, coefficients=dict(list(read.coefficients.items())[:2]))),
)
wrong(
    "The coefficient of the first joint of a coupling is taken as 1.",
    lambda: _reads(lambda read: replace(read, coefficients=read.coefficients | {next(iter(read.coefficients)): 1.0})),
)


@means("EU-CPL-005")
def couplings_are_relative() -> Deviation:
    """The residual of a coupling is divided by its largest coefficient."""

    def residual(right: Any, tree: Any, q: Any, of: Coupling) -> Any:
        return right(tree, q, of) / max(map(abs, of.coefficients.values()))

    return instead(coupling, "residual", residual)


@means("EU-CPL-006")
def couplings_forget_turns() -> Deviation:
    """A coupled continuous joint is at an angle of at most half a turn."""

    def residual(right: Any, tree: Any, q: Any, of: Coupling) -> Any:
        continuous = {joint.name for joint in tree.joints if joint.type == "continuous"}
        wrapped = {name: [float(np.arctan2(np.sin(at), np.cos(at))) for at in values] for name, values in q.items()}
        return right(tree, {name: wrapped[name] if name in continuous else q[name] for name in q}, of)

    return instead(coupling, "residual", residual)


wrong = means("EU-CLO-010", versions=("2.1",))
wrong(
    "K of a coupling has 1 and -1 for its coefficients.",
    lambda: instead(coupling, "jacobian", lambda right, velocities, of: np.sign(right(velocities, of))),
)
