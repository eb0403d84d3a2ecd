"""Linkages of every joint type: branching trees with several kinds of loops, and one with mimic joints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.kinematics.residual import closure_openings
from support.linkage import Linkage, X, Y, closure


def composite(*models: Any) -> Any:
    joined = pin.JointModelComposite()
    for model in models:
        joined.addJoint(model, pin.SE3.Identity())
    return joined


SKEW = np.array([0.6, 0.0, 0.8])
CONTINUOUS = """<robot name="one"><link name="a"/><link name="b"/>
  <joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0.6 0 0.8"/></joint></robot>"""
JOINTS = {
    "revolute about x": lambda: pin.JointModelRX(),
    "revolute about a skew axis": lambda: pin.JointModelRevoluteUnaligned(SKEW),
    "continuous about y": lambda: pin.JointModelRUBY(),
    "continuous about a skew axis": lambda: pin.buildModelFromXML(CONTINUOUS).joints[1],
    "prismatic along z": lambda: pin.JointModelPZ(),
    "prismatic along a skew axis": lambda: pin.JointModelPrismaticUnaligned(SKEW),
    "helical": lambda: pin.JointModelHelicalUnaligned(SKEW, 0.05),
    "universal": lambda: pin.JointModelUniversal(np.array(X), np.array(Y)),
    "universal with axes that are not square": lambda: composite(
        pin.JointModelRX(), pin.JointModelRevoluteUnaligned(SKEW)
    ),
    "cylindrical": lambda: composite(pin.JointModelPZ(), pin.JointModelRZ()),
    "spherical": lambda: pin.JointModelSpherical(),
    "planar": lambda: pin.JointModelPlanar(),
    "floating": lambda: pin.JointModelFreeFlyer(),
}


def branching(joint_models: list[Any], random: np.random.Generator) -> Linkage:
    """A tree of a trunk and two branches, closed in 6d and 3d across the branches, to the ground and to an ancestor."""

    def place() -> Any:
        return pin.SE3(pin.exp3(random.uniform(-2.0, 2.0, 3)), random.uniform(-0.5, 0.5, 3))

    model = pin.Model()
    third = max(1, len(joint_models) // 3)
    parent, trunk = 0, 0
    for index, joint_model in enumerate(joint_models):
        if index == 2 * third:
            parent = trunk
        parent = model.addJoint(parent, joint_model, place(), f"joint{index}")
        if index == third - 1:
            trunk = parent
    branch, tip = 2 * third, parent
    ends = [(branch, tip, "6d"), (tip, branch, "3d"), (0, tip, "6d"), (tip, 0, "3d"), (trunk, branch, "3d")]
    constraints = [
        closure(model, a, place(), b, place(), kind, f"closure{index}") for index, (a, b, kind) in enumerate(ends)
    ]
    return Linkage(model, constraints)


def somewhere(model: Any, random: np.random.Generator) -> Any:
    return pin.integrate(model, pin.neutral(model), random.uniform(-1.5, 1.5, model.nv))


def far_from_half_a_turn(linkage: Linkage, q: Any) -> bool:
    """Where two frames are half a turn apart, log6 jumps and has no derivative."""
    return all(opening.angle < np.pi - 0.2 for opening in closure_openings(linkage, q))


MIMIC = """<robot name="mimic">
  <link name="ground"/><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
  <joint name="lead" type="revolute"><parent link="ground"/><child link="a"/><origin xyz="0.1 0 0.2" rpy="0.1 0.2 0.3"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="slide" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0.3 0.1 0" rpy="0.5 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="same" type="revolute"><parent link="b"/><child link="c"/><origin xyz="0.2 0 0.1" rpy="0 0.7 0"/>
    <axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/>
    <mimic joint="lead" multiplier="-2" offset="0.4"/></joint>
  <joint name="other" type="revolute"><parent link="ground"/><child link="d"/><origin xyz="-0.2 0 0.1"/>
    <axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/>
    <mimic joint="lead" multiplier="0.5" offset="0"/></joint>
</robot>"""
