"""Random trees of all joint types with mimic joints, closed by constraints of all kinds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.mechanism.body import Anchor, Body
from eurdf.mechanism.constraint import (
    Closure,
    Coupling,
    DistanceClosure,
    FrameClosure,
    HingeClosure,
    PointClosure,
)
from eurdf.mechanism.joint import Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, Root
from eurdf.pinocchio.configuration import slots
from eurdf.pinocchio.frames import body_frame_ids
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.linkage import pose_of

KINDS = ("3d", "6d", "hinge", "distance", "coupling")


def tree(random: np.random.Generator, root: Root = "fixed") -> Mechanism:
    """Every joint type once, then two joints that mimic the prismatic and the continuous one."""
    mechanism = by_hand.tree_of_all_types(random)
    joints = list(mechanism.joints)
    leaders = {joint.type: joint.name for joint in joints}
    mimics = {
        JointType.REVOLUTE: Mimic(leaders[JointType.PRISMATIC], -0.7, 0.2),
        JointType.CONTINUOUS: Mimic(leaders[JointType.CONTINUOUS], -2.0, 0.4),
    }
    for kind, mimic in mimics.items():
        joint = by_hand.some_joint(kind, random, joints[-1].child, f"mimic_{kind}")
        joints.append(replace(joint, mimic=mimic))
    bodies = (*mechanism.bodies, *(Body(joint.child, by_hand.some_inertia(random)) for joint in joints[-2:]))
    return replace(mechanism, root=root, bodies=bodies, joints=tuple(joints))


def closed_tree(random: np.random.Generator, kinds: tuple[str, ...] = KINDS, root: Root = "fixed") -> tuple[Robot, Any]:
    """Such a tree with a constraint of each kind between two random bodies, and a configuration that meets them."""
    mechanism = tree(random, root)
    free = build_robot(mechanism, geometry=False)
    q = pin.integrate(free.model, pin.neutral(free.model), random.uniform(-1.0, 1.0, free.model.nv))
    data, frames = free.model.createData(), body_frame_ids(mechanism)
    pin.framesForwardKinematics(free.model, data, q)
    closures: list[Closure] = []
    for kind in kinds:
        a, b = random.choice([body.name for body in mechanism.bodies], 2, replace=False).tolist()
        A = by_hand.some_pose(random)
        oMA = data.oMf[frames[a]] * pin.SE3(by_hand.pose_matrix(A))
        AMB = pin.SE3(np.eye(3), np.array([0.3, -0.4, 1.2]) if kind == "distance" else np.zeros(3))
        anchors = Anchor(a, A), Anchor(b, pose_of(data.oMf[frames[b]].actInv(oMA * AMB)))
        axis = tuple(random.uniform(-1.0, 1.0, 3).tolist())
        match kind:
            case "3d":
                closures.append(PointClosure(kind, *anchors))
            case "6d":
                closures.append(FrameClosure(kind, *anchors))
            case "hinge":
                closures.append(HingeClosure(kind, *anchors, axes=(axis, axis)))
            case "distance":
                closures.append(DistanceClosure(kind, *anchors, length=1.3))
    names = {joint.type: joint.name for joint in mechanism.joints if joint.mimic is None}
    screw, slide = names[JointType.HELICAL], names[JointType.PRISMATIC]
    at = slots(mechanism)
    offset = 1.5 * q[at[screw].idx_q] - 2.0 * q[at[slide].idx_q]
    couplings = (Coupling("coupling", ((screw, 1.5), (slide, -2.0)), float(offset)),) if "coupling" in kinds else ()
    actuators = tuple(names[kind] for kind in (JointType.REVOLUTE, JointType.CYLINDRICAL, JointType.CONTINUOUS))
    mechanism = replace(mechanism, closures=tuple(closures), couplings=couplings, actuators=actuators)
    return build_robot(mechanism, geometry=False), q
