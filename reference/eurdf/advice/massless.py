"""Advice on links of loops that have no mass."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.array import Matrix, Vector
from eurdf.diagnostics import Diagnostics
from eurdf.kinematics.loop import joints_of_loops
from eurdf.kinematics.scale import characteristic_length
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.mechanism import ROOT_JOINT
from eurdf.pinocchio.robot import Robot

# How far from the closed configuration the joints are moved for a second look, rad and characteristic lengths: what is
# singular at one configuration alone is a gimbal lock, and no missing mass.
_MOVE = 0.3

# Singular values below this, relative to the largest, are rounding of numbers in files; an entry of a motion, too.
_NOTHING = 1e-4

# What a link carries at most so far away, in m, is at the joint of the link: the bound for joints to merge.
_REACH = 1e-4


def advise_on_massless_links(read: ReadRobot, robot: Robot, q: Vector, diagnostics: Diagnostics) -> None:
    """Report links of loops without mass, unless they only part the axes of a joint of several, such as a ball.

    A link that reaches to another place than its joint is a part whose mass was forgotten. Any link that can move while
    all that has mass is at rest, as a rod between two balls can spin, makes the mass matrix singular. Nothing is
    reported of a link whose joint has an armature.
    """
    model = robot.model
    looped = set(joints_of_loops(robot))
    child_of = {ROOT_JOINT: robot.mechanism.bodies[0].name}
    child_of |= {joint.name: joint.child for joint in robot.mechanism.joints}
    # The coordinate of a leader that comes after its mimic joints is a joint without a link.
    with_link = [joint for joint in range(1, model.njoints) if model.names[joint] in child_of]
    # The first of two joints in series carries no link, and the second what both move.
    second = robot.tree.in_series
    massless = {joint for joint in (*with_link, *second) if _is_massless(model.inertias[joint])}
    if massless.isdisjoint(looped):
        return
    length = characteristic_length(robot)
    beside = q  # another configuration, made when it is needed: `numpy.random` takes time to import
    children: dict[int, list[int]] = {}
    for joint in range(1, model.njoints):
        children.setdefault(model.parents[joint], []).append(joint)
    anchors: dict[int, list[Any]] = {}
    for constraint in robot.constraints:
        for joint, placement in map(robot.tree.site, constraint.anchors):
            anchors.setdefault(joint, []).append(placement)
    for top in sorted(massless):
        if model.parents[top] in massless:
            continue
        joints = _together(top, massless, children)
        if looped.isdisjoint(joints) or any(model.nvs[joint] != model.nvExtendeds[joint] for joint in joints):
            continue  # what mimics another has that one's motion
        motions = _motions_at_rest(model, joints, massless, q, length)
        if len(motions) and beside is q:
            beside = pin.integrate(model, q, np.random.default_rng(0).uniform(-_MOVE, _MOVE, model.nv))
        if len(motions) and len(_motions_at_rest(model, joints, massless, beside, length)):
            columns = [joint for joint in joints for _ in range(model.nvs[joint])]
            fast = np.abs(motions).max(axis=0) > _NOTHING
            moving = dict.fromkeys(
                second.get(joint, joint) for joint, moves in zip(columns, fast, strict=True) if moves
            )
            names = " and ".join(f"'{model.names[joint]}'" for joint in moving)
            why = f"and can move by {names} without moving any mass: the mass matrix is singular"
            _report(read, [child_of[model.names[joint]] for joint in moving if joint in massless], why, diagnostics)
            continue
        for joint in joints:
            if joint not in massless or joint not in looped or joint in second:
                continue
            if (model.armature[list(robot.tree.velocities_of(model.names[joint]))] > 0.0).all():
                continue
            reach = _reach(model, joint, children, anchors)
            if reach > _REACH:
                why = f"but extends {reach:.3g} m from its joint: its mass is missing from the dynamics"
                _report(read, [child_of[model.names[joint]]], why, diagnostics)


def _report(read: ReadRobot, links: list[str], why: str, diagnostics: Diagnostics) -> None:
    """Report the first of the links that the URDF has."""
    urdf = read.urdf
    known = next((urdf.links[link] for link in links if link in urdf.links), None)
    if known is not None:
        diagnostics.report(
            "x-massless-link",
            f"link '{known.name}' of a loop has no mass {why}",
            partial(urdf.document.place, known.element),
            "state its mass and inertia",
        )


def _reach(model: Any, joint: int, children: dict[int, list[int]], anchors: dict[int, list[Any]]) -> float:
    """Distance from a joint to the furthest joint or frame of a closure on what it carries, m."""
    carried = [model.jointPlacements[child] for child in children.get(joint, [])] + anchors.get(joint, [])
    return max((float(np.linalg.norm(placement.translation)) for placement in carried), default=0.0)


def _is_massless(inertia: Any) -> bool:
    return not inertia.mass and not inertia.inertia.any()


def _together(top: int, massless: set[int], children: dict[int, list[int]]) -> list[int]:
    """A massless body, those that hang from it, and the first of each branch that has mass, each after its parent."""
    joints, pending = [], [top]
    while pending:
        joint = pending.pop()
        joints.append(joint)
        if joint in massless:
            pending += children.get(joint, [])
    return joints


def _motions_at_rest(model: Any, joints: list[int], massless: set[int], q: Vector, length: float) -> Matrix:
    """Basis (k, n) of the velocities of joints by which nothing moves that has mass, nor an armature that resists.

    The joints are as `_together` gives them, the characteristic length is in m.
    """
    first, columns = {}, 0
    for joint in joints:
        first[joint] = columns
        columns += model.nvs[joint]
    above = model.parents[joints[0]]
    poses, jacobians = {above: pin.SE3.Identity()}, {above: np.zeros((6, columns))}
    rows = [np.zeros((0, columns))]
    for joint in joints:
        joint_model, parent = model.joints[joint], model.parents[joint]
        data = joint_model.createData()
        joint_model.calc(data, q)
        # Seen from the first joint, so that far away from the origin turning is not taken for sliding.
        placement = pin.SE3.Identity() if parent == above else model.jointPlacements[joint]
        poses[joint] = poses[parent] * placement * data.M
        J = jacobians[parent].copy()
        J[:, first[joint] : first[joint] + model.nvs[joint]] += poses[joint].toActionMatrix() @ data.S.reshape(6, -1)
        jacobians[joint] = J
        if joint not in massless:
            rows.append(np.vstack([J[:3] / length, J[3:]]))
    armature = np.concatenate([model.armature[model.idx_vs[j] : model.idx_vs[j] + model.nvs[j]] for j in joints])
    rows.append(np.eye(columns)[armature > 0.0])
    _, values, right = np.linalg.svd(np.vstack(rows), full_matrices=True)
    rank = int((values > _NOTHING * values.max(initial=1.0)).sum())
    return np.asarray(right[rank:], dtype=np.float64)
