"""Locking joints of a robot: a smaller robot of the same parts, that moves as the first does with these joints held."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.array import Indices, Vector
from eurdf.kinematics.assembly import start
from eurdf.kinematics.exceptions import CannotLock, LockedOpen
from eurdf.kinematics.locked_mechanism import lock_joints
from eurdf.kinematics.loop import find_loops
from eurdf.kinematics.residual import CLOSED, closure_openings, residual
from eurdf.kinematics.several import several
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.configuration import joint_coordinates
from eurdf.pinocchio.coordinates import slots
from eurdf.pinocchio.robot import Geometry, Robot, build_robot


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LockedRobot(Robot):
    """A robot some of whose joints are locked.

    With q (nq,) and v (nv,) of the robot that it comes from, at which the locked joints stand still, its own are
    ``q[robot.idx_q]`` and ``v[robot.idx_v]``.

    Attributes:
        locked_joints: Names of the joints that were locked, those that follow one of them too.
        dropped_closures: Names of the closures that have no constraint model any more, since no joint moves their
            frames against each other. They are closed.
        dropped_actuators: Names of the actuators that were locked.
        dropped_configurations: Names of the configurations that have a locked joint elsewhere.
        idx_q: Indices, in a q of the robot that it comes from, of its own coordinates (nq,).
        idx_v: Indices, in a v of that robot, of its own velocities (nv,).
    """

    locked_joints: tuple[str, ...]
    dropped_closures: tuple[str, ...]
    dropped_actuators: tuple[str, ...]
    dropped_configurations: tuple[str, ...]
    idx_q: Indices
    idx_v: Indices


def lock(
    robot: Robot, joints: str | Iterable[str], q: Vector | None = None, *, tolerance: float = CLOSED
) -> LockedRobot:
    """Lock joints of a robot where they stand at a configuration.

    The locked joints are fixed ones of the new robot: their frames, and all links, joints and frames, are found under
    their names, in the same order and, where the free joints stand as before, at the same poses. Closures, actuators,
    geometry, limits and named configurations are those of the first robot, less what has no meaning any more, which
    the new robot lists. A closure is left out where locked joints leave nothing that moves its frames against each
    other; one that has become redundant stays. A named configuration is left out where it places the child of a locked
    joint elsewhere than q does, by more than 1e-6 m or rad.

    Model, constraint models and actuation are built from ``robot.mechanism``, so that what was changed in them by hand
    is not carried over. Geometry is carried over as it is, with its collision pairs, and shares its meshes.

    It does what `freezeJoints` of the published toolbox (Batto, De Matteïs, Mansard, 2025) is for, and
    ``pin.buildReducedModel`` for a robot without closures.

    Args:
        robot: The robot, which stays as it is.
        joints: Names of joints, or one name. With a joint, those that follow it are locked. One that is fixed already
            stays so.
        q: Where to lock them (nq,); the coordinates of the other joints matter to closures that are left out alone.
            `assembled` by default, or else the neutral configuration.
        tolerance: What each row of the residual of a closure that is left out may be at q, m or rad.

    Raises:
        CannotLock: A name is that of no joint, of one that follows another that is not locked, or of a floating root's.
        LockedOpen: A closure that is left out is open at q.
        ValueError: ``q`` is no configuration.
    """
    names = set(several(joints))
    if ROOT_JOINT in names and robot.mechanism.root == "floating":
        raise CannotLock(ROOT_JOINT, "it is the robot's place in the world; load the robot with root='fixed'")
    q = start(robot, q)
    locked = lock_joints(robot.mechanism, names, joint_coordinates(robot.mechanism, robot.model, q))
    _check_closed(robot, q, {closure.name for closure in locked.closures}, tolerance)
    built = build_robot(locked.mechanism, geometry=False)
    idx_q, idx_v = _free_indices(robot, built)
    return LockedRobot(
        built.mechanism,
        built.model,
        built.constraint_models,
        built.actuation,
        built.configurations,
        robot.geometry and Geometry(*(_carried_over(each, robot.model, built.model) for each in robot.geometry)),
        robot.no_geometry,
        robot.diagnostics,
        locked_joints=locked.joints,
        dropped_closures=tuple(closure.name for closure in locked.closures),
        dropped_actuators=locked.actuators,
        dropped_configurations=locked.configurations,
        idx_q=idx_q,
        idx_v=idx_v,
    )


def _check_closed(robot: Robot, q: Vector, names: Collection[str], tolerance: float) -> None:
    """Refuse closures that are open at q.

    Raises:
        LockedOpen: Some are.
    """
    if not names:
        return
    r = residual(robot, q)
    is_open = [
        constraint.name in names and not np.abs(r[loop.rows]).max() <= tolerance
        for constraint, loop in zip(robot.constraint_models, find_loops(robot), strict=True)
    ]
    if any(is_open):
        openings = closure_openings(robot, q)
        raise LockedOpen(tuple(found for found, stays in zip(openings, is_open, strict=True) if stays), tolerance)


def _carried_over(geometry_model: Any, before: Any, after: Any) -> Any:
    """The geometry, fixed to the joints of the new model.

    Both models have the same frames in the same order: `build_model` gives a joint the same ones whether it is fixed or
    moves; what was added to the first by hand comes after them. So the first frame of each joint tells where what is
    fixed to the joint is now.
    """
    sites: dict[int, tuple[int, Any]] = {}
    for old, new in zip(before.frames, after.frames, strict=False):
        if old.parentJoint not in sites:
            stays = old.placement == new.placement
            jMj = pin.SE3.Identity() if stays else new.placement * old.placement.inverse()
            sites[old.parentJoint] = new.parentJoint, jMj
    carried = geometry_model.copy()
    for geometry in carried.geometryObjects:
        geometry.parentJoint, jMj = sites[geometry.parentJoint]
        geometry.placement = jMj * geometry.placement
    return carried


def _free_indices(before: Robot, after: Robot) -> tuple[Indices, Indices]:
    """Where the coordinates, and the velocities, of the new robot stand in those of the first."""
    nq, nv = (7, 6) if after.mechanism.root == "floating" else (0, 0)
    idx_q, idx_v = list(range(nq)), list(range(nv))
    old = slots(before.mechanism, before.model)
    for name, new in sorted(slots(after.mechanism, after.model).items(), key=lambda item: item[1].idx_q):
        idx_q += range(old[name].idx_q, old[name].idx_q + new.nq)
        idx_v += range(old[name].idx_v, old[name].idx_v + new.nv)
    return np.array(idx_q, dtype=np.intp), np.array(idx_v, dtype=np.intp)
