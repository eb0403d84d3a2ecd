"""Mechanisms of one loop, with joints of chosen types at random places."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import eurdf
from eurdf.mechanism.body import Anchor, Body
from eurdf.mechanism.constraint import CLOSURES, Closure, Coupling
from eurdf.mechanism.joint import Joint, Mimic
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose
from eurdf.pinocchio.robot import build_robot

_AXES = {
    "universal": 2,
    "spherical": 0,
    "planar": 0,
    "floating": 0,
}


def one_loop(
    types: Sequence[str], closure: str, seed: int, *, follower: bool = False, coupled: bool = False
) -> eurdf.Robot:
    """A chain of joints j0, j1, …, on a fixed root, whose end is closed at the configuration `assembled`.

    Args:
        types: The types of the joints.
        closure: The type of the closure.
        seed: Of the random numbers.
        follower: Whether a joint that mimics j1 is added at the end.
        coupled: Whether j0 and j1 are coupled.
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
            axes=tuple(_vector(random) for _ in range(_AXES.get(kind, 1))),
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


def _closure(type_: str, a: Pose, b: Pose, body: str, random: np.random.Generator) -> Closure:
    kind = CLOSURES[type_]
    if type_ == "distance":
        away = Pose(tuple(a.act(_vector(random))))
        length = float(np.linalg.norm(np.subtract(away.xyz, a.xyz)))
        return kind("loop", Anchor("b0", away), Anchor(body, b), length=length)
    if type_ == "hinge":
        axis = _vector(random)
        return kind("loop", Anchor("b0", a), Anchor(body, b), axes=(axis, axis))
    return kind("loop", Anchor("b0", a), Anchor(body, b))


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
