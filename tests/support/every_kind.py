"""Robots of every type of joint, with constraints of any kinds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from eurdf.closures.distance import DistanceClosure
from eurdf.closures.frame import FrameClosure
from eurdf.closures.hinge import HingeClosure
from eurdf.closures.point import PointClosure
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint_types import JointType
from eurdf.pinocchio.robot import Robot, build_robot
from support.by_hand import some_pose, tree_of_all_types

KIND_NAMES = ("3d", "6d", "hinge", "distance", "coupling")


def some_constraint(
    kind: str, index: int, random: np.random.Generator, names: Sequence[str], joints: Sequence[str]
) -> Any:
    name = f"{kind}{index}"
    if kind == "coupling":
        chosen = random.choice(list(joints), 3, replace=False).tolist()
        return Coupling(name, tuple((each, float(random.uniform(0.5, 3.0))) for each in chosen), 0.3)
    a, b = (Anchor(each, some_pose(random)) for each in random.choice(list(names), 2, replace=False).tolist())
    if kind == "hinge":
        axes = random.uniform(-2.0, 2.0, (2, 3)).tolist()
        return HingeClosure(name, a, b, (tuple(axes[0]), tuple(axes[1])))
    if kind == "distance":
        return DistanceClosure(name, a, b, 0.7)
    return {"3d": PointClosure, "6d": FrameClosure}[kind](name, a, b)


def some_robot(random: np.random.Generator, kinds: Sequence[str]) -> Robot:
    mechanism = tree_of_all_types(random)
    single = {JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC, JointType.HELICAL}
    joints = [joint.name for joint in mechanism.joints if joint.type in single]
    names = [each.name for each in mechanism.bodies]
    found = [some_constraint(kind, index, random, names, joints) for index, kind in enumerate(kinds)]
    closures = tuple(each for each in found if isinstance(each, Closure))
    couplings = tuple(each for each in found if isinstance(each, Coupling))
    return build_robot(replace(mechanism, closures=closures, couplings=couplings), geometry=False)
