"""The axis of a hinge, of which the rest of the mechanism shows that its bodies turn about this axis alone.

Exports make hinges of 3d closures, for solvers that hold no ball in a loop. Imports find the axes of hinges of which a
file states the frames alone.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.array import Vector
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.convert.common_losses import COMMON
from eurdf.convert.losses import Loss, Losses
from eurdf.kinematics.analysis import analyze
from eurdf.kinematics.assembly import assemble
from eurdf.kinematics.residual import residual_and_jacobian
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import AXES, Vector3
from eurdf.pinocchio.robot import Robot, build_robot

#: Singular values of an angular velocity, relative to those of the whole motion, that count as none.
_NO_TURN = 1e-9

#: How far the loops are moved to see whether the axis stays, rad or m, and how far it may turn, rad.
_STEP, _SAME = 0.2, 1e-6

#: Largest angle between the axis that is allowed and one of the frames, rad: files may be in single precision.
_PARALLEL = 1e-4

_AXES = dict(zip("xyz", AXES, strict=True))


def with_hinges(robot: Robot, q: Vector) -> tuple[Robot, tuple[Loss, ...]]:
    """The robot with a hinge for each 3d closure whose bodies turn about one axis, fixed in both of them.

    It moves as before: the axis is that of the relative angular velocity at q, and it is kept only if it stays the same
    in both bodies where the loops have moved.

    Args:
        robot: The robot.
        q: A closed configuration (nq,).

    Returns:
        The robot, and for each 3d closure what became of it.
    """
    losses = Losses(COMMON)
    freedoms = _freedoms(robot, q)
    moved = list(_moved(robot, q, freedoms))
    closures: list[Closure] = []
    for closure in robot.mechanism.closures:
        hinge = _hinge(robot, q, freedoms, moved, closure) if isinstance(closure, PointClosure) else None
        if hinge is not None:
            losses.add("export-hinge", closure.name)
        elif isinstance(closure, PointClosure):
            losses.add("export-ball", closure.name)
        closures.append(hinge or closure)
    found = build_robot(replace(robot.mechanism, closures=tuple(closures)), geometry=False)
    return found, losses.found


def _freedoms(robot: Robot, q: Vector) -> Vector:
    """The velocities that the loops allow, columns of shape (nv, mobility)."""
    _, K = residual_and_jacobian(robot, q)
    return np.asarray(np.linalg.svd(K)[2][analyze(robot, q).rank :].T)


def _moved(robot: Robot, q: Vector, freedoms: Vector) -> Iterator[Vector]:
    for velocity in freedoms.T:
        for step in (_STEP, -_STEP):
            assembly = assemble(robot, pin.integrate(robot.model, q, step * velocity), restarts=0)
            if assembly.closes:
                yield assembly.q


def _hinge(
    robot: Robot, q: Vector, freedoms: Vector, moved: list[Vector], closure: PointClosure
) -> HingeClosure | None:
    data = robot.model.createData()
    pin.computeJointJacobians(robot.model, data, q)
    joints = [robot.tree.site(anchor)[0] for anchor in closure.anchors]
    one, other = (pin.getJointJacobian(robot.model, data, joint, pin.WORLD)[3:] for joint in joints)
    turns, sizes, _ = np.linalg.svd((other - one) @ freedoms)
    if not len(sizes) or sizes[0] <= _NO_TURN or (sizes[1:] > _NO_TURN * sizes[0]).any():
        return None
    a, b = (frame.T @ turns[:, 0] for frame in _frames(robot, data, closure))
    for each in moved:
        pin.forwardKinematics(robot.model, data, each)
        frames = _frames(robot, data, closure)
        if np.linalg.norm(frames[0] @ a - frames[1] @ b) > _SAME:
            return None
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return HingeClosure(
        closure.name, closure.a, closure.b, axes=((ax, ay, az), (bx, by, bz)), compliance=closure.compliance
    )


def _frames(robot: Robot, data: Any, closure: Closure) -> list[Vector]:
    """Orientations (3, 3) of A and B in the world."""
    sites = [robot.tree.site(anchor) for anchor in closure.anchors]
    return [data.oMi[joint].rotation @ placement.rotation for joint, placement in sites]


# -- hinges without an axis -------------------------------------------------------------------------------------------


def allowed_axes(
    mechanism: Mechanism, names: Collection[str], coordinates: Mapping[str, tuple[float, ...]]
) -> dict[str, str] | None:
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
    found: dict[str, str] = {}
    for closure in hinges:
        if closure.name in names and isinstance(closure, HingeClosure):
            for name, axis in _AXES.items():
                if _parallel(closure.axes, axis):
                    found[closure.name] = name
    return found


def with_axes(mechanism: Mechanism, axes: Mapping[str, str]) -> Mechanism:
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
