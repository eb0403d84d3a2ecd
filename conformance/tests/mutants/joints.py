"""Parsers that move joints differently: coordinates, axes, velocities, mimics."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from eurdf_conformance.oracle import configuration, kinematics, tree, urdf
from eurdf_conformance.oracle.spatial import pose, rotation
from mutants.mutant import Deviation, instead

_unit = partial(instead, urdf, "unit")


def _coordinates(kind: str, change: Callable[[Any], Any]) -> Deviation:
    """The coordinates of a type of joint are others."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        return right(of, axes, pitch, np.array(change(q)) if of == kind else q)

    return instead(kinematics, "transform", changed)


def _pitch(change: Callable[[float], float]) -> Deviation:
    return instead(kinematics, "transform", lambda right, of, axes, pitch, q: right(of, axes, change(pitch), q))


def _w_first(q: Any) -> Any:
    return [*q[1:], q[0]]


def _second_axis_first(right: Any, found: Any, of: Any, change: Any) -> None:
    right(found, of, replace(change, axes=change.axes[::-1]))


def _second_axis_fixed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
    if of != "universal":
        return right(of, axes, pitch, q)
    return pose(rotation(axes[1], q[1]) @ rotation(axes[0], q[0]))


def _motion(kind: str, change: Callable[[Any, Any], Any]) -> Deviation:
    """The columns of a type of joint are others: change(columns, rotation of the child in the joint's frame)."""

    def changed(right: Any, of: str, axes: Any, pitch: float, q: Any) -> Any:
        found = right(of, axes, pitch, q)
        return change(found, kinematics.transform(of, axes, pitch, q)[:3, :3]) if of == kind else found

    return instead(kinematics, "motion", changed)


def _with_axis_z(right: Any, element: Any) -> Any:
    if not element.all("axis"):
        element.children.append(urdf.Element("axis", {"xyz": "0 0 1"}, []))
    return right(element)


def _with_axis_of_the_parent(right: Any, element: Any) -> Any:
    found = right(element)
    object.__setattr__(found, "axis", found.origin[:3, :3].T @ found.axis)
    return found


def _nearest(unit: Any, axis: Any) -> Any:
    largest = int(np.argmax(np.abs(axis)))
    return np.eye(3)[largest] * np.sign(axis[largest])


def _mimic(change: Callable[[float, float], tuple[float, float]]) -> Deviation:
    """Multiplier and offset of a mimic joint are others."""

    def changed(right: Any, element: Any) -> Any:
        found = right(element)
        return urdf.Mimic(found.joint, *change(found.multiplier, found.offset))

    return instead(urdf, "mimic", changed)


def _own_drivers(right: Any, of: Any) -> Any:
    return [
        (driver, joint.mimic.multiplier, joint.mimic.offset) if joint.mimic else (driver, *others)
        for joint, (driver, *others) in zip(of.joints, right(of), strict=True)
    ]


MEANS = {
    "EU-JNT-015": {
        "The quaternion of a spherical joint is w, x, y, z, as in MuJoCo.": _coordinates("spherical", _w_first),
        "The quaternion of a spherical joint is the orientation of the parent in the child.": _coordinates(
            "spherical", lambda q: [*-q[:3], q[3]]
        ),
    },
    "EU-JNT-016": {
        "A universal joint turns about its second axis first.": instead(tree, "add_joint", _second_axis_first),
    },
    ("EU-JNT-016", "2"): {  # in version 1 it is two joints
        "The second axis of a universal joint is fixed to the parent.": instead(
            kinematics, "transform", _second_axis_fixed
        ),
    },
    "EU-JNT-017": {
        "The coordinates of a cylindrical joint are an angle, then a length.": _coordinates(
            "cylindrical", lambda q: q[::-1]
        ),
    },
    "EU-JNT-018": {
        "The pitch of a helical joint is metres per radian.": _pitch(lambda pitch: pitch * 2 * math.pi),
        "A helical joint of positive pitch is left-handed.": _pitch(lambda pitch: -pitch),
    },
    "EU-JNT-025": {
        "A revolute joint turns clockwise about its axis.": _coordinates("revolute", lambda q: -q),
        "The angle of a continuous joint is in degrees.": _coordinates("continuous", np.radians),
        "The length of a prismatic joint is in millimetres.": _coordinates("prismatic", lambda q: q / 1000),
        "The coordinates of a planar joint are its angle, then x and y.": _coordinates(
            "planar", lambda q: [q[1], q[2], q[0]]
        ),
        "The coordinates of a floating joint are its quaternion, then its position.": _coordinates(
            "floating", lambda q: [*q[4:], *q[:4]]
        ),
        "The quaternion of a floating joint is w, x, y, z, as in MuJoCo.": _coordinates(
            "floating", lambda q: [*q[:3], *_w_first(q[3:])]
        ),
    },
    "EU-JNT-026": {
        "The angular velocity of a spherical joint is along the axes of its parent's side.": _motion(
            "spherical", lambda columns, R: columns @ R.T
        ),
        "The velocities of a floating joint are along the axes of its parent's side, the world for a root.": _motion(
            "floating", lambda columns, R: columns @ np.kron(np.eye(2), R.T)
        ),
        "The linear velocity of a floating joint is along the world, the angular one along its child, as in MuJoCo.": (
            _motion("floating", lambda columns, R: np.hstack([columns[:, :3] @ R.T, columns[:, 3:]]))
        ),
        "The velocities of a floating joint are angular, then linear, as in Featherstone and Drake.": _motion(
            "floating", lambda columns, R: np.roll(columns, 3, axis=1)
        ),
        "The velocities of a planar joint are the derivatives of its coordinates.": _motion(
            "planar", lambda columns, R: np.hstack([columns[:, :2] @ R[:2, :2].T, columns[:, 2:]])
        ),
    },
    ("EU-JNT-026", "2"): {  # version 1 has none
        "The velocities of a cylindrical joint are angular, then linear.": _motion(
            "cylindrical", lambda columns, R: columns[:, ::-1]
        ),
    },
    "EU-ONE-009": {
        "In version 1 a mimic joint depends on its leader, as in version 2.": instead(
            urdf.Urdf, "without_mimics", lambda right, of: of
        ),
    },
    "EU-URD-035": {
        "An axis that is left out is z, as in SDF and MJCF.": instead(urdf, "joint", _with_axis_z),
        "A joint moves by the vector of its axis, whatever its length.": _unit(lambda right, axis: axis),
        "An axis is the nearest of x, y and z.": _unit(_nearest),
        "An axis is a direction in the frame of the parent link.": instead(urdf, "joint", _with_axis_of_the_parent),
    },
    "EU-URD-032": {
        "A mimic joint is at multiplier · q.": _mimic(lambda m, offset: (m, 0.0)),
        "A mimic joint is at q + offset.": _mimic(lambda m, offset: (1.0, offset)),
        "A mimic joint is at multiplier · (q + offset).": _mimic(lambda m, offset: (m, m * offset)),
        "A mimic joint is at (q − offset) / multiplier.": _mimic(
            lambda m, offset: (1.0 / (m or 1.0), -offset / (m or 1.0))
        ),
        "Of a joint that mimics one that mimics, its own multiplier and offset alone count.": instead(
            configuration, "drivers", _own_drivers
        ),
    },
}
