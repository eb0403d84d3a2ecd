"""3d closures as hinges, where the bodies turn about one axis alone: for solvers that hold no ball in a loop."""

from __future__ import annotations

from collections.abc import Iterator
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
from eurdf.pinocchio.robot import Robot, build_robot

#: Singular values of an angular velocity, relative to those of the whole motion, that count as none.
_NO_TURN = 1e-9

#: How far the loops are moved to see whether the axis stays, rad or m, and how far it may turn, rad.
_STEP, _SAME = 0.2, 1e-6


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
