"""Random mechanisms of all joint types and kinds of constraints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin

import eurdf
from eurdf.closures import REGISTRY
from eurdf.mechanism.body import Anchor, Body
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism, Root
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.pinocchio.configuration import slots
from eurdf.pinocchio.frames import body_frame_ids
from eurdf.pinocchio.robot import Robot, build_robot
from support import by_hand
from support.by_hand import AXES
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
        if kind != "coupling":
            axis = _vector(random)
            closures.append(REGISTRY[kind](kind, *anchors, **_stated(kind, 1.3, (axis, axis))))
    names = {joint.type: joint.name for joint in mechanism.joints if joint.mimic is None}
    screw, slide = names[JointType.HELICAL], names[JointType.PRISMATIC]
    at = slots(mechanism)
    offset = 1.5 * q[at[screw].idx_q] - 2.0 * q[at[slide].idx_q]
    couplings = (Coupling("coupling", ((screw, 1.5), (slide, -2.0)), float(offset)),) if "coupling" in kinds else ()
    actuators = tuple(names[kind] for kind in (JointType.REVOLUTE, JointType.CYLINDRICAL, JointType.CONTINUOUS))
    mechanism = replace(mechanism, closures=tuple(closures), couplings=couplings, actuators=actuators)
    return build_robot(mechanism, geometry=False), q


def some_robot(random: np.random.Generator, kinds: Sequence[str]) -> Robot:
    """Every joint type once, with a constraint of each of these kinds, which are open."""
    mechanism = by_hand.tree_of_all_types(random)
    joints = [joint.name for joint in mechanism.joints if joint.type.nv == len(joint.type.coordinates) == 1]
    bodies = [each.name for each in mechanism.bodies]
    closures, couplings = [], []
    for index, kind in enumerate(kinds):
        if kind == "coupling":
            terms = [
                (name, float(random.uniform(0.5, 3.0))) for name in random.choice(joints, 3, replace=False).tolist()
            ]
            couplings.append(Coupling(f"coupling{index}", tuple(terms), 0.3))
        else:
            ends = [
                Anchor(name, by_hand.some_pose(random)) for name in random.choice(bodies, 2, replace=False).tolist()
            ]
            stated = _stated(kind, 0.7, (_vector(random), _vector(random)))
            closures.append(REGISTRY[kind](f"{kind}{index}", *ends, **stated))
    return build_robot(replace(mechanism, closures=tuple(closures), couplings=tuple(couplings)), geometry=False)


def one_loop(
    types: Sequence[str], closure: str, seed: int, *, follower: bool = False, coupled: bool = False
) -> eurdf.Robot:
    """A chain of joints j0, j1, …, on a fixed root, whose end is closed at the configuration `assembled`.

    A joint that mimics j1 is added at the end if there is a `follower`; j0 and j1 may be `coupled`.
    """
    random = np.random.default_rng(seed)
    bodies, joints, tip = [Body("b0")], [], IDENTITY
    coordinates: dict[str, tuple[float, ...]] = {}
    kinds = [*types, "revolute"] if follower else list(types)
    for index, kind in enumerate(kinds):
        mimics = follower and index == len(types)
        type_ = JointType(kind)
        joint = Joint(
            f"j{index}",
            type_,
            f"b{index}",
            f"b{index + 1}",
            _pose(random),
            axes=tuple(_vector(random) for _ in range(AXES.get(type_, 1))),
            pitch=0.3 if kind == "helical" else 0.0,
            mimic=Mimic("j1", -0.7, 0.2) if mimics else None,
        )
        c = (-0.7 * coordinates["j1"][0] + 0.2,) if mimics else _coordinates(type_, random)
        if not mimics:
            coordinates[joint.name] = c
        joints.append(joint)
        bodies.append(Body(f"b{index + 1}"))
        tip = tip * joint.placement * joint.transform(c)
    b = _pose(random)
    closed = _closure(closure, tip * b, b, f"b{len(joints)}", random)
    couplings = ()
    if coupled:
        (first,), (second,) = coordinates["j0"], coordinates["j1"]
        couplings = (Coupling("gear", (("j0", 1.5), ("j1", -2.0)), 1.5 * first - 2.0 * second),)
    mechanism = Mechanism(
        "one loop",
        "2.1",
        "fixed",
        tuple(bodies),
        tuple(joints),
        closures=(closed,),
        couplings=couplings,
        actuators=("j1",),
        configurations={"assembled": coordinates},
    )
    return build_robot(mechanism, geometry=False)


def _closure(kind: str, a: Pose, b: Pose, body: str, random: np.random.Generator) -> Closure:
    away = Pose(tuple(a.act(_vector(random)))) if kind == "distance" else a
    axis = _vector(random) if kind == "hinge" else (0.0, 0.0, 1.0)
    length = float(np.linalg.norm(np.subtract(away.xyz, a.xyz)))
    return REGISTRY[kind]("loop", Anchor("b0", away), Anchor(body, b), **_stated(kind, length, (axis, axis)))


def _stated(kind: str, length: float, axes: Any) -> dict[str, Any]:
    """What a closure of a kind states beside its name and its frames."""
    return {"distance": {"length": length}, "hinge": {"axes": axes}}.get(kind, {})


def _vector(random: np.random.Generator) -> tuple[float, float, float]:
    x, y, z = random.uniform(-1.0, 1.0, 3).tolist()
    return x, y, z


def _pose(random: np.random.Generator) -> Pose:
    x, y, z = (0.4 * random.uniform(-1.0, 1.0, 3)).tolist()
    return Pose.from_xyz_rpy((x, y, z), _vector(random))


def _coordinates(kind: JointType, random: np.random.Generator) -> tuple[float, ...]:
    values = 0.5 * random.uniform(-1.0, 1.0, len(kind.coordinates))
    if (first := kind.quaternion) is not None:
        values[first:] /= np.linalg.norm(values[first:])
    return tuple(values.tolist())
