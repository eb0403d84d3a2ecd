"""The axis of a hinge of which a file states the frames, and no axis: the one that the rest of the mechanism allows."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Literal

from eurdf.closures.hinge import HingeClosure
from eurdf.convert.hinges import with_hinges
from eurdf.kinematics.assembly import assemble
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import Vector3
from eurdf.pinocchio.robot import build_robot

_AXES: Mapping[Literal["x", "y", "z"], Vector3] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

#: Largest angle between the axis that is allowed and one of the frames, rad: files may be in single precision.
_PARALLEL = 1e-4


def allowed_axes(
    mechanism: Mechanism, names: Collection[str], coordinates: Mapping[str, tuple[float, ...]]
) -> dict[str, Literal["x", "y", "z"]] | None:
    """For each hinge, the axis of its two frames that it can have, if that is one axis.

    With only their points closed, the other joints and closures decide how the links turn against each other. They must
    turn about one axis that is fixed in both links, and is x, y or z of both frames.

    Args:
        mechanism: The mechanism, in which the axes of these hinges have no meaning.
        names: Of the hinges.
        coordinates: Where to start closing the loops.

    Returns:
        The axes of the hinges that have one; None if the loops cannot be closed.
    """
    points = tuple(each.with_orientation_free() if each.name in names else each for each in mechanism.closures)
    robot = build_robot(replace(mechanism, closures=points), geometry=False)
    assembly = assemble(robot, robot.configuration(coordinates), limits=False)
    if not assembly.closes:
        return None
    hinges = with_hinges(robot, assembly.q)[0].mechanism.closures
    found: dict[str, Literal["x", "y", "z"]] = {}
    for closure in hinges:
        if closure.name in names and isinstance(closure, HingeClosure):
            for name, axis in _AXES.items():
                if _parallel(closure.axes, axis):
                    found[closure.name] = name
    return found


def with_axes(mechanism: Mechanism, axes: Mapping[str, Literal["x", "y", "z"]]) -> Mechanism:
    """The mechanism with these axes of its hinges, each the same in both frames."""
    closures = tuple(
        HingeClosure(each.name, each.a, each.b, axes=(_AXES[axes[each.name]],) * 2) if each.name in axes else each
        for each in mechanism.closures
    )
    return replace(mechanism, closures=closures)


def _parallel(axes: tuple[Vector3, Vector3], axis: Vector3) -> bool:
    """Whether unit vectors in both frames are along an axis, or both against it."""
    cosines = [sum(one * other for one, other in zip(each, axis, strict=True)) for each in axes]
    return cosines[0] * cosines[1] > 0.0 and min(map(abs, cosines)) > 1.0 - _PARALLEL**2 / 2.0
