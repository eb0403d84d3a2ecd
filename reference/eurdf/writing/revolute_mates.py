"""Revolute mates, of which a URDF has a point and a second one on the axis in each part: each is one hinge."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from eurdf.format.urdf.data import Urdf
from eurdf.mechanism.joint_type import JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3, direction
from eurdf.writing.naming_conventions import Conventions, Found, NamedClosure, find

#: Two points nearer to each other than this do not state the direction of an axis, m.
_SHORTEST = 1e-6

#: A unit vector that is nearer than this to an axis of its frame is that axis: the rest is rounding.
_ROUNDED = 1e-12


def lowest_version(urdf: Urdf, convention: Conventions) -> Literal["2", "2.1"]:
    """The lowest version 2 that can describe a robot: 2.1 if it has a revolute mate, which is a hinge."""
    found = find(urdf, convention)
    return "2" if with_hinges(found, urdf) == found else "2.1"


def with_hinges(found: Found, urdf: Urdf) -> Found:
    """Let one hinge take the place of the two closures that hold a revolute mate by two points.

    The axis in each frame points from its first point to the second one. A mate whose two points are not on one link,
    or coincide, keeps the two closures.
    """
    poses = _poses(urdf)
    closures = {closure.name: closure for closure in found.closures}
    for name, closure in list(closures.items()):
        second = closures.get(f"{name}_z")
        if second is None or not (closure.hinge and second.hinge):
            continue
        axes = [_axis(urdf, poses, point, end) for point, end in zip(closure.frames, second.frames, strict=True)]
        if axes[0] is not None and axes[1] is not None:
            closures[name] = NamedClosure(name, "hinge", closure.frames, axes=(axes[0], axes[1]))
            del closures[second.name]
    return replace(found, closures=tuple(closures.values()))


def _axis(urdf: Urdf, poses: Mapping[str, tuple[str, Pose]], point: str, end: str) -> Vector3 | None:
    """The unit vector from a frame to another that is fixed to it; None if it is not, or at the same place."""
    (body, at), (other, beyond) = (poses[_link(urdf, name)] for name in (point, end))
    if body != other:
        return None
    to = at.inverse().act(beyond.xyz)
    if math.hypot(*to) < _SHORTEST:
        return None
    x, y, z = direction(to)
    nearest: Vector3 = (float(round(x)), float(round(y)), float(round(z)))
    return nearest if math.dist((x, y, z), nearest) < _ROUNDED else (x, y, z)


def _link(urdf: Urdf, frame: str) -> str:
    return frame if frame in urdf.links else urdf.joints[frame].child


def _poses(urdf: Urdf) -> dict[str, tuple[str, Pose]]:
    """For each link, the one nearest to the root that it is rigidly fixed to, and its pose in that one."""
    poses = {urdf.root: (urdf.root, IDENTITY)}
    for joint in urdf.walk():
        body, pose = poses[joint.parent]
        is_fixed = joint.type is JointType.FIXED
        poses[joint.child] = (body, pose * joint.placement) if is_fixed else (joint.child, IDENTITY)
    return poses
