"""Parsers that move joints differently: coordinates, axes, velocities, mimics."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from eurdf_conformance.oracle import configuration, kinematics, tree, urdf
from eurdf_conformance.oracle.spatial import pose, rotation
from mutants.mutant import Deviation, instead, means


def _coordinates(kind: str, change: Callable[[Any], Any]) -> Deviation:
    """The coordinates of a type of joint are others."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        return right(of, axes, pitch, np.array(change(q)) if of == kind else q)

    return instead(kinematics, "transform", changed)


def _pitch(change: Callable[[float], float]) -> Deviation:
    return instead(kinematics, "transform", lambda right, of, axes, pitch, q: right(of, axes, change(pitch), q))


def _w_first(q: Any) -> Any:
    return [*q[1:], q[0]]


wrong = means("EU-JNT-015")
wrong("The quaternion of a spherical joint is w, x, y, z, as in MuJoCo.", lambda: _coordinates("spherical", _w_first))
wrong(
    "The quaternion of a spherical joint is the orientation of the parent in the child.",
    lambda: _coordinates("spherical", lambda q: [*-q[:3], q[3]]),
)


@means("EU-JNT-016")
def universal_joints_turn_about_the_second_axis_first() -> Deviation:
    """A universal joint turns about its second axis first."""

    def joint(right: Any, found: Any, of: Any, change: Any) -> None:
        right(found, of, replace(change, axes=change.axes[::-1]))

    return instead(tree, "add_joint", joint)


@means("EU-JNT-016", versions=("2",))  # in version 1 it is two joints
def second_axis_of_universal_joints_is_fixed() -> Deviation:
    """The second axis of a universal joint is fixed to the parent."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        if of != "universal":
            return right(of, axes, pitch, q)
        return pose(rotation(axes[1], q[1]) @ rotation(axes[0], q[0]))

    return instead(kinematics, "transform", changed)


wrong = means("EU-JNT-017")
wrong(
    "The coordinates of a cylindrical joint are an angle, then a length.",
    lambda: _coordinates("cylindrical", lambda q: q[::-1]),
)

wrong = means("EU-JNT-018")
wrong("The pitch of a helical joint is metres per radian.", lambda: _pitch(lambda pitch: pitch * 2 * math.pi))
wrong("A helical joint of positive pitch is left-handed.", lambda: _pitch(lambda pitch: -pitch))

wrong = means("EU-JNT-025")
wrong("A revolute joint turns clockwise about its axis.", lambda: _coordinates("revolute", lambda q: -q))
wrong("The angle of a continuous joint is in degrees.", lambda: _coordinates("continuous", np.radians))
wrong("The length of a prismatic joint is in millimetres.", lambda: _coordinates("prismatic", lambda q: q / 1000))
wrong(
    "The coordinates of a planar joint are its angle, then x and y.",
    lambda: _coordinates("planar", lambda q: [q[1], q[2], q[0]]),
)
wrong(
    "The coordinates of a floating joint are its quaternion, then its position.",
    lambda: _coordinates("floating", lambda q: [*q[4:], *q[:4]]),
)
wrong(
    "The quaternion of a floating joint is w, x, y, z, as in MuJoCo.",
    lambda: _coordinates("floating", lambda q: [*q[:3], *_w_first(q[3:])]),
)


def _motion(kind: str, change: Callable[[Any, Any, Any], Any]) -> Deviation:
    """The columns of a type of joint are others: change(columns, rotation of the child in the joint's frame, q)."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        found = right(of, axes, pitch, q)
        if of != kind:
            return found
        return change(found, kinematics.transform(of, axes, pitch, q)[:3, :3], q)

    return instead(kinematics, "motion", changed)


def _both(R: Any) -> Any:
    return np.kron(np.eye(2), R)


wrong = means("EU-JNT-026")
wrong(
    "The angular velocity of a spherical joint is along the axes of its parent's side.",
    lambda: _motion("spherical", lambda columns, R, q: columns @ R.T),
)
wrong(
    "The velocities of a floating joint are along the axes of its parent's side, the world for a root.",
    lambda: _motion("floating", lambda columns, R, q: columns @ _both(R.T)),
)
wrong(
    "The linear velocity of a floating joint is along the world, the angular one along its child, as in MuJoCo.",
    lambda: _motion("floating", lambda columns, R, q: np.hstack([columns[:, :3] @ R.T, columns[:, 3:]])),
)
wrong(
    "The velocities of a floating joint are angular, then linear, as in Featherstone and Drake.",
    lambda: _motion("floating", lambda columns, R, q: np.roll(columns, 3, axis=1)),
)


@means("EU-JNT-026")
def planar_velocities_are_derivatives() -> Deviation:
    """The velocities of a planar joint are the derivatives of its coordinates."""

    def derivatives(columns: Any, R: Any, q: Any) -> Any:
        return np.hstack([columns[:, :2] @ R[:2, :2].T, columns[:, 2:]])

    return _motion("planar", derivatives)


wrong = means("EU-JNT-026", versions=("2",))
# version 1 has none
wrong(
    "The velocities of a cylindrical joint are angular, then linear.",
    lambda: _motion("cylindrical", lambda columns, R, q: columns[:, ::-1]),
)

wrong = means("EU-ONE-009")
wrong(
    "In version 1 a mimic joint depends on its leader, as in version 2.",
    lambda: instead(urdf.Urdf, "without_mimics", lambda right, of: of),
)


@means("EU-URD-035")
def axis_left_out_is_z() -> Deviation:
    """An axis that is left out is z, as in SDF and MJCF."""

    def joint(right: Any, element: Any) -> Any:
        if not element.all("axis"):
            element.children.append(urdf.Element("axis", {"xyz": "0 0 1"}, []))
        return right(element)

    return instead(urdf, "joint", joint)


wrong = means("EU-URD-035")
wrong(
    "A joint moves by the vector of its axis, whatever its length.",
    lambda: instead(urdf, "unit", lambda unit, axis: axis),
)


@means("EU-URD-035")
def axes_are_one_of_three() -> Deviation:
    """An axis is the nearest of x, y and z."""

    def nearest(unit: Any, axis: Any) -> Any:
        largest = int(np.argmax(np.abs(axis)))
        return np.eye(3)[largest] * np.sign(axis[largest])

    return instead(urdf, "unit", nearest)


@means("EU-URD-035")
def axes_in_the_parents_frame() -> Deviation:
    """An axis is a direction in the frame of the parent link."""

    def joint(right: Any, element: Any) -> Any:
        found = right(element)
        object.__setattr__(found, "axis", found.origin[:3, :3].T @ found.axis)
        return found

    return instead(urdf, "joint", joint)


def _mimic(change: Callable[[Any], Any]) -> Deviation:
    return instead(urdf, "mimic", lambda mimic, element: change(mimic(element)))


wrong = means("EU-URD-032")
wrong(
    "A mimic joint is at multiplier · q.", lambda: _mimic(lambda found: urdf.Mimic(found.joint, found.multiplier, 0.0))
)
wrong("A mimic joint is at q + offset.", lambda: _mimic(lambda found: urdf.Mimic(found.joint, 1.0, found.offset)))
wrong(
    "A mimic joint is at multiplier · (q + offset).",
    lambda: _mimic(lambda found: urdf.Mimic(found.joint, found.multiplier, found.multiplier * found.offset)),
)


@means("EU-URD-032")
def chains_of_mimics_are_cut() -> Deviation:
    """Of a joint that mimics one that mimics, its own multiplier and offset alone count."""

    def drivers(right: Any, of: Any) -> Any:
        return [
            (driver, joint.mimic.multiplier, joint.mimic.offset) if joint.mimic else (driver, *others)
            for joint, (driver, *others) in zip(of.joints, right(of), strict=True)
        ]

    return instead(configuration, "drivers", drivers)


@means("EU-URD-032")
def mimic_is_inverted() -> Deviation:
    """A mimic joint is at (q − offset) / multiplier."""

    def inverted(found: Any) -> Any:
        m = found.multiplier or 1.0
        return urdf.Mimic(found.joint, 1.0 / m, -found.offset / m)

    return _mimic(inverted)
