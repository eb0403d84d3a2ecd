"""Revolute mates, of which a URDF has two points on the axis in each part: each is one hinge."""

from __future__ import annotations

from dataclasses import dataclass, replace

from eurdf.format.urdf.data import Urdf
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import HingeClosure, PointClosure
from eurdf.mechanism.spanning_tree import rigid_poses
from eurdf.writing.joined_closures import Apart, join_points
from eurdf.writing.naming_conventions import Found, NamedClosure


@dataclass(frozen=True, slots=True)
class Mates:
    """What the 3d closures of a URDF say by their points.

    Attributes:
        found: What the names say, with one hinge in the place of the closures that hold it.
        hinges: For each hinge, the names of these closures; the first is its own.
        apart: 3d closures of the same two parts that cannot both be closed.
    """

    found: Found
    hinges: tuple[tuple[str, ...], ...]
    apart: tuple[Apart, ...]


def revolute_mates(found: Found, urdf: Urdf) -> Mates:
    """Let one hinge take the place of the 3d closures of two parts whose points are on one axis.

    The axis in each frame points from its first point to the one that is farthest from it.
    """
    points = [
        PointClosure(closure.name, *(Anchor(_link(urdf, frame)) for frame in closure.frames))
        for closure in found.closures
        if closure.type == "3d"
    ]
    joined = join_points(points, rigid_poses(urdf.root, urdf.walk()))
    closures = {closure.name: closure for closure in found.closures}
    hinges = []
    for each in joined.joined:
        if isinstance(each.closure, HingeClosure):
            hinges.append(each.points)
            first = closures[each.closure.name]
            closures[first.name] = NamedClosure(first.name, "hinge", first.frames, axes=each.closure.axes)
            for name in each.points[1:]:
                del closures[name]
    return Mates(replace(found, closures=tuple(closures.values())), tuple(hinges), joined.apart)


def _link(urdf: Urdf, frame: str) -> str:
    return frame if frame in urdf.links else urdf.joints[frame].child
