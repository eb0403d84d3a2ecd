"""Advice on quaternions that were likely written w first."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from eurdf.diagnostics import Diagnostics
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import ROOT_JOINT, Mechanism

if TYPE_CHECKING:
    from eurdf.pinocchio.robot import Robot

# Numbers of a quaternion that differ by less are one.
_SAME_NUMBER = 1e-6

_Coordinates = Mapping[str, tuple[float, ...]]


def advise_on_quaternions(read: ReadRobot, robot: Robot | None, diagnostics: Diagnostics) -> None:
    """Report the quaternions of named configurations that are likely w x y z, in place of x y z w.

    They are so where the loops close by them in that order alone; or where they are the identity in that order,
    ``[1, 0, 0, 0]``, and no loop closes by half a turn about x, which that is in the order of the format.
    """
    mechanism, description = read.mechanism, read.description
    for name, coordinates in mechanism.configurations.items():
        turned = w_first(mechanism, coordinates)
        if not turned:
            continue
        looped: set[str] = set()
        closed = by_turned = False
        if robot is not None:
            from eurdf.kinematics.loop import joints_of_loops

            looped = {robot.model.names[joint] for joint in joints_of_loops(robot)}
            closed = _closes(robot, coordinates)
            by_turned = not closed and _closes(robot, {**coordinates, **turned})
        for joint, values in turned.items():
            is_identity = abs(values[-1]) > 1.0 - _SAME_NUMBER
            if (by_turned and joint in looped) or (is_identity and not (closed and joint in looped)):
                why = "the loops close" if by_turned and joint in looped else "it is the identity"
                quaternion = ", ".join(f"{value + 0.0:g}" for value in values[-4:])
                diagnostics.report(
                    "x-quaternion-order",
                    f"the quaternion of joint '{joint}' in configuration '{name}' "
                    f"is probably in the order w, x, y, z: {why} only then",
                    description.document.place(("configurations", name, joint)),
                    f"the order is x, y, z, w: {quaternion}",
                )


def w_first(mechanism: Mechanism, coordinates: _Coordinates) -> dict[str, tuple[float, ...]]:
    """The coordinates of the joints with a quaternion, read w first, where that is another orientation."""
    quaternion = {joint.name: joint.type.quaternion for joint in mechanism.joints}
    quaternion[ROOT_JOINT] = 3
    turned = {}
    for name, values in coordinates.items():
        start = quaternion.get(name)
        if start is not None:
            x, y, z, w = values[start : start + 4]
            if min(_distance((x, y, z, w), (y, z, w, x)), _distance((x, y, z, w), (-y, -z, -w, -x))) > _SAME_NUMBER:
                turned[name] = (*values[:start], y, z, w, x)
    return turned


def _distance(one: tuple[float, ...], other: tuple[float, ...]) -> float:
    return max(abs(a - b) for a, b in zip(one, other, strict=True))


def _closes(robot: Robot, coordinates: _Coordinates) -> bool:
    from eurdf.kinematics.residual import all_openings

    q = robot.configuration(coordinates)
    return not any(opening.is_open for opening in all_openings(robot, q))
