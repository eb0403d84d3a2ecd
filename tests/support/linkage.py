"""Linkages with known answers, built with Pinocchio alone, and what the kinematics needs of a robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.closures import REGISTRY
from eurdf.kinematics.residual import closure_openings, residual_and_jacobian
from eurdf.mechanism.body import Anchor
from eurdf.mechanism.constraint import Closure, Constraint
from eurdf.mechanism.pose import Pose
from eurdf.pinocchio.actuation import Actuation
from eurdf.pinocchio.configuration import Slot
from eurdf.pinocchio.constraint import build_constraint_models
from eurdf.pinocchio.memory import Cached
from eurdf.pinocchio.tree import Site, Tree
from support.plain_urdf import inertial, joint_element, link_element

X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Linkage(Cached):
    """A robot as the kinematics sees it."""

    model: Any
    constraints: Sequence[Constraint] = ()
    actuated: Sequence[str] = ()
    configurations: dict[str, Any] = field(default_factory=dict)
    derived: dict[Any, Any] = field(default_factory=dict, init=False)

    @cached_property
    def tree(self) -> Tree:
        """The bodies have the names of the joints that carry them."""
        model = self.model
        sites = {name: Site(joint, pin.SE3.Identity()) for joint, name in enumerate(model.names)}
        at = zip(model.names, model.idx_qs, model.nqs, model.idx_vs, model.nvs, strict=True)
        return Tree(model, sites, {name: Slot(None, *numbers) for name, *numbers in at})

    @cached_property
    def constraint_models(self) -> list[Any]:
        return build_constraint_models(self.constraints, self.tree)

    @property
    def actuation(self) -> Actuation:
        model = self.model
        found = [model.joints[model.getJointId(name)] for name in self.actuated]
        rows = [joint.idx_v + k for joint in found for k in range(joint.nv)]
        coordinates = [joint.idx_q + k for joint in found for k in range(joint.nq)]
        control = np.full((len(rows), 2), (-np.inf, np.inf))
        indices = np.array(coordinates, np.intp), np.array(rows, np.intp)
        return Actuation(tuple(self.actuated), *indices, self.model.nv, tuple(self.actuated), control)


def translation(*xyz: float) -> Any:
    return pin.SE3(np.eye(3), np.array(xyz, dtype=float))


def pose_of(placement: Any) -> Pose:
    x, y, z, qx, qy, qz, qw = map(float, pin.SE3ToXYZQUAT(placement))
    return Pose((x, y, z), (qx, qy, qz, qw))


def anchor(model: Any, joint: int, jMc: Any) -> Anchor:
    """A frame at jMc in a joint."""
    return Anchor(model.names[joint], pose_of(jMc))


def closure(model: Any, a: int, aMc: Any, b: int, bMc: Any, kind: str = "6d", name: str = "closure") -> Closure:
    """Frame A at aMc in joint a, frame B at bMc in joint b."""
    return REGISTRY[kind](name, anchor(model, a, aMc), anchor(model, b, bMc))


def pulled_apart(linkage: Linkage, jMa: Any) -> Linkage:
    """The same with frame A of its one closure elsewhere in its joint."""
    (end,) = linkage.constraints
    assert isinstance(end, Closure)
    moved = replace(end.a, pose=pose_of(jMa))
    return Linkage(linkage.model, [replace(end, a=moved)], linkage.actuated, linkage.configurations)


def swapped(linkage: Linkage) -> Linkage:
    """The same with frames A and B of every closure exchanged."""
    constraints = [replace(found, a=found.b, b=found.a) for found in linkage.constraints if isinstance(found, Closure)]
    return Linkage(linkage.model, constraints, linkage.actuated, linkage.configurations)


Pair = tuple[str, Sequence[float], Sequence[float]]


def loop(
    pairs: Sequence[Pair],
    kind: str = "6d",
    end: Sequence[float] = (0.0, 0.0, 0.0),
    away: float | Sequence[float] = 0.0,
    actuated: Sequence[str] = ("j0",),
    size: float = 1.0,
    decimals: int | None = None,
) -> Linkage:
    """One loop through the ground, drawn where it is closed.

    Its joints are called j0, j1, …; each is R, P or S for the type, a point, and the axis in the world. Frame A of the
    closure, at `end`, is on the ground. Coordinates of R and P are `away` at the closed configuration drawn. `size` is
    a factor on all lengths; positions and roll, pitch and yaw have so many `decimals`, None for all.
    """
    model = pin.Model()
    joint, oMi = 0, pin.SE3.Identity()
    for index, ((letter, point, axis), coordinate) in enumerate(
        zip(pairs, np.broadcast_to(away, len(pairs)), strict=True)
    ):
        along = np.array(axis, dtype=float) / np.linalg.norm(axis)
        # The frame of each joint has its z axis along the joint, and is turned about it by an angle of its own.
        turn = pin.Quaternion.FromTwoVectors(np.array(Z), along).matrix() @ pin.exp3(np.array(Z) * (0.3 + index))
        oMj = pin.SE3(turn, size * np.array(point, dtype=float))
        moved = {
            "R": pin.SE3(pin.exp3(-coordinate * np.array(Z)), np.zeros(3)),
            "P": translation(0.0, 0.0, -size * coordinate),
            "S": pin.SE3.Identity(),
        }[letter]
        joint_model = {"R": pin.JointModelRZ, "P": pin.JointModelPZ, "S": pin.JointModelSpherical}[letter]()
        joint = model.addJoint(joint, joint_model, rounded(oMi.actInv(oMj * moved), decimals), f"j{index}")
        oMi = oMj
    oMc = translation(*(size * np.array(end, dtype=float)))
    constraint = closure(model, 0, rounded(oMc, decimals), joint, rounded(oMi.actInv(oMc), decimals), kind, "end")
    return Linkage(model, [constraint], actuated)


def rounded(placement: Any, decimals: int | None) -> Any:
    """A placement as it comes back from a file."""
    if decimals is None:
        return placement
    rpy = np.round(pin.rpy.matrixToRpy(placement.rotation), decimals)
    return pin.SE3(pin.rpy.rpyToMatrix(rpy), np.round(placement.translation, decimals))


def n_bar(n: int, kind: str = "6d", **options: Any) -> Linkage:
    """Planar linkage of n bars, the ground one of them: mobility n - 3.

    In 6d, all n pins are joints; in 3d, the last one is the closure.
    """
    angles = 0.3 + 2.0 * np.pi * np.arange(n) / n
    corners = [((1.0 + 0.05 * i) * np.cos(a), np.sin(a), 0.0) for i, a in enumerate(angles)]
    if kind == "6d":
        return loop([("R", corner, Z) for corner in corners], **options)
    return loop([("R", corner, Z) for corner in corners[:-1]], "3d", corners[-1], **options)


def slider_crank(**options: Any) -> Linkage:
    return loop([("R", (0, 0, 0), Z), ("R", (1, 0.5, 0), Z), ("R", (3, 0, 0), Z), ("P", (3, 0, 0), X)], **options)


def chain(*lengths: float) -> Any:
    """The model of a planar arm of bars along x at zero, with joints j0, j1, … and a frame at its end."""
    model, parent, before = pin.Model(), 0, 0.0
    for index, length in enumerate(lengths):
        parent = model.addJoint(parent, pin.JointModelRZ(), translation(before, 0.0, 0.0), f"j{index}")
        before = length
    model.addFrame(pin.Frame("end", parent, 0, translation(before, 0.0, 0.0), pin.FrameType.OP_FRAME))
    return model


def four_bar(crank: float, coupler: float, rocker: float, ground: float) -> Linkage:
    """Planar four-bar with all bars along x at zero, pinned at its end by a 3d closure to the ground at ``ground``."""
    model = chain(crank, coupler, rocker)
    end = closure(model, 0, translation(ground, 0.0, 0.0), 3, translation(rocker, 0.0, 0.0), "3d", "end")
    return Linkage(model, [end], ["j0"])


def stretched(bend: float, size: float = 1.0, actuated: Sequence[str] = ()) -> Linkage:
    """Two bars in a vertical slide whose ends are held, stretched but for a bend: K loses rank where it is 0."""
    joints = [("P", (0.0, 0.0, 0.0), Z), ("R", (0.0, 0.0, 0.0), Z), ("R", (1.0, 0.0, 0.0), Z)]
    joints.append(("R", (1.5, bend / 2.0, 0.0), Y))
    return weighted(loop(joints, "3d", (2.0, bend, 0.0), actuated=actuated, size=size), size=size)


def drift_by_differences(robot: Any, q: Any, v: Any, step: float = 1e-3) -> Any:
    """K̇ v by central differences of the sixth order."""

    def at(t: float) -> Any:
        return residual_and_jacobian(robot, pin.integrate(robot.model, q, t * v))[1] @ v

    weights = {1: 45.0, 2: -9.0, 3: 1.0}
    return sum(weight * (at(k * step) - at(-k * step)) for k, weight in weights.items()) / (60.0 * step)


def spherical_four_bar(**options: Any) -> Linkage:
    axes = ((1, 0, 0), (1, 0.7, 0), (0.2, 0.8, 0.6), (0.1, 0, 1))
    return loop([("R", (0, 0, 0), axis) for axis in axes], **options)


def sarrus(**options: Any) -> Linkage:
    """Two planar legs at right angles: the top goes up and down, though 6 - 6 motions would be left."""
    legs = [((1, 0, 0), Y), ((1.5, 0, 1), Y), ((1, 0, 2), Y), ((0, 1, 2), X), ((0, 1.5, 1), X), ((0, 1, 0), X)]
    return loop([("R", point, axis) for point, axis in legs], **options)


def flat_sarrus(**options: Any) -> Linkage:
    """The same linkage pressed flat, where K loses rank."""
    legs = [((1, 0, 0), Y), ((2, 0, 0), Y), ((1, 0, 0), Y), ((0, 1, 0), X), ((0, 2, 0), X), ((0, 1, 0), X)]
    return loop([("R", point, axis) for point, axis in legs], **options)


def bennett(twist: float = 0.6, length: float = 1.0, other: float = 1.7) -> Linkage:
    """Four skew revolutes with the sines of the twists in proportion to the lengths: it moves, against all counting.

    The neutral configuration is open.
    """
    model = pin.Model()
    joint, placement = 0, pin.SE3.Identity()
    opposite = np.arcsin(other * np.sin(twist) / length)
    for index, (along, about) in enumerate([(length, twist), (other, opposite)] * 2):
        joint = model.addJoint(joint, pin.JointModelRZ(), placement, f"j{index}")
        placement = pin.SE3(pin.utils.rotate("x", about), np.array([along, 0.0, 0.0]))
    return Linkage(model, [closure(model, 0, pin.SE3.Identity(), joint, placement, name="end")], ["j0"])


def stewart() -> Linkage:
    """A Stewart platform: six legs of universal, prismatic and spherical joint, the first carries the platform.

    The neutral configuration is closed.
    """
    model, constraints = pin.Model(), []
    oMt = pin.SE3(pin.exp3(np.array([0.1, 0.2, 0.3])), np.array([0.1, -0.2, 1.0]))
    for leg in range(6):
        foot, head = leg * np.pi / 3 + 0.2 * (-1) ** leg, leg * np.pi / 3 - 0.3 * (-1) ** leg
        tMh = translation(0.6 * np.cos(head), 0.6 * np.sin(head), 0.0)
        oMf = translation(np.cos(foot), np.sin(foot), 0.0)
        along = (oMt * tMh).translation - oMf.translation
        oMf.rotation = pin.Quaternion.FromTwoVectors(np.array(Z), along).matrix()
        universal = model.addJoint(0, pin.JointModelUniversal(np.array(X), np.array(Y)), oMf, f"universal{leg}")
        slider = model.addJoint(universal, pin.JointModelPZ(), translation(0, 0, 0.4), f"slider{leg}")
        ball = model.addJoint(
            slider, pin.JointModelSpherical(), translation(0, 0, -0.4) * oMf.actInv(oMt * tMh), f"ball{leg}"
        )
        if leg == 0:
            carrier, hMt = ball, tMh.inverse()
        else:
            constraints.append(closure(model, carrier, hMt * tMh, ball, pin.SE3.Identity(), name=f"leg{leg}"))
    return Linkage(model, constraints, [f"slider{leg}" for leg in range(6)])


def three_rrr() -> Linkage:
    """A planar platform on three legs of three pins each, a motor at each foot; the first leg carries the platform.

    The neutral configuration is closed, and every closure says three things that the plane says already.
    """
    model, constraints = pin.Model(), []
    heads = [np.array([np.cos(a), np.sin(a), 0.0]) for a in (0.3, 2.4, 4.5)]
    for leg, head in enumerate(heads):
        foot, knee = 3.0 * head, 2.0 * head + 0.7 * np.array([-head[1], head[0], 0.0])
        shank = model.addJoint(0, pin.JointModelRZ(), translation(*foot), f"motor{leg}")
        shin = model.addJoint(shank, pin.JointModelRZ(), translation(*(knee - foot)), f"knee{leg}")
        ankle = model.addJoint(shin, pin.JointModelRZ(), translation(*(head - knee)), f"ankle{leg}")
        if leg == 0:
            platform = ankle
        else:
            constraints.append(
                closure(model, platform, translation(*(head - heads[0])), ankle, pin.SE3.Identity(), name=f"leg{leg}")
            )
    return Linkage(model, constraints, ["motor0", "motor1", "motor2"])


def ball_ended(kind: str) -> Linkage:
    """A crank, a slide and a swing that meet the ground in a ball: closed in 3d there, or in 6d behind a ball joint."""
    pairs: list[Pair] = [("R", (0, 0, 0), Z), ("R", (1, 0, 0.2), Y), ("P", (1, 0.5, 0), X), ("R", (1.5, 0.5, 0), X)]
    end = (2.0, 1.0, 0.6)
    if kind == "6d":
        return loop([*pairs, ("S", end, Z)], "6d", end)
    return loop(pairs, "3d", end)


#: Mechanisms of textbooks that move, whose arguments all have defaults.
MOVING = (slider_crank, three_rrr, stewart, sarrus, bennett, spherical_four_bar)


def weighted(linkage: Linkage, seed: int = 0, size: float = 1.0) -> Linkage:
    """With some inertia at every joint, a factor on its lengths, and armature at the motors."""
    random, model = np.random.default_rng(seed), linkage.model
    for joint in range(1, model.njoints):
        centre, A = random.uniform(-0.3, 0.3, 3), random.uniform(-0.3, 0.3, (3, 3))
        moments = size**2 * (A @ A.T + 0.02 * np.eye(3))
        model.inertias[joint] = pin.Inertia(random.uniform(0.5, 2.0), size * centre, moments)
    model.armature = 0.1 * linkage.actuation.selection.sum(axis=1)
    return linkage


def described(linkage: Linkage) -> tuple[str, str]:
    """The two files of a linkage: its URDF, and its description without the line of the version."""
    model = linkage.model
    types = {"JointModelRZ": "revolute", "JointModelPZ": "prismatic"}
    body = inertial(1.0, '<origin xyz="0.1 0.2 0.3"/>')
    parts, joints = [link_element("b0", body)], []
    for joint in range(1, model.njoints):
        kind, name = model.joints[joint].shortname(), model.names[joint]
        content = '<axis xyz="0 0 1"/><limit lower="-7" upper="7" effort="1" velocity="1"/>'
        xyz, rpy = _numbers(model.jointPlacements[joint])
        at = f'<origin xyz="{xyz}" rpy="{rpy}"/>'
        parts.append(link_element(f"b{joint}", body))
        parent = f"b{model.parents[joint]}"
        parts.append(joint_element(name, types.get(kind, "revolute"), parent, f"b{joint}", content, at))
        if kind == "JointModelSpherical":
            joints.append(f"  {name}: spherical\n")
        elif kind == "JointModelUniversal":
            joints.append(f"  {name}: {{type: universal, axes: xy}}\n")
        else:
            assert kind in types
    yaml = "closures:\n"
    for found in linkage.constraints:
        frames = []
        for joint, placement in map(linkage.tree.site, found.anchors):
            xyz, rpy = (numbers.replace(" ", ", ") for numbers in _numbers(placement))
            frames.append(f"{{link: b{joint}, xyz: [{xyz}], rpy: [{rpy}]}}")
        yaml += f"  - {{name: {found.name}, type: {found.type}, frames: [{', '.join(frames)}]}}\n"
    if joints:
        yaml += "joints:\n" + "".join(joints)
    return f'<robot name="linkage">{"".join(parts)}</robot>', yaml + f"actuators: [{', '.join(linkage.actuated)}]\n"


def _numbers(placement: Any) -> tuple[str, str]:
    """Position, and roll, pitch and yaw, as files have them."""
    rpy = pin.rpy.matrixToRpy(placement.rotation)
    xyz, angles = (" ".join(repr(float(value)) for value in values) for values in (placement.translation, rpy))
    return xyz, angles


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


def scissors(mimic: bool = True) -> Linkage:
    """Two bars of which the second folds back twice as fast as the first turns, and a slide under their end."""
    text = """<robot name="scissors"><link name="g"/><link name="a"/><link name="b"/><link name="c"/>
      <joint name="lead" type="revolute"><parent link="g"/><child link="a"/><axis xyz="0 0 1"/>
        <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
      <joint name="fold" type="revolute"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
        <limit lower="-3" upper="3" effort="1" velocity="1"/><mimic joint="lead" multiplier="-2"/></joint>
      <joint name="slide" type="prismatic"><parent link="g"/><child link="c"/><axis xyz="1 0 0"/>
        <limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""
    model = pin.buildModelFromXML(text, mimic=mimic)
    fold, slide = model.getJointId("fold"), model.getJointId("slide")
    return Linkage(model, [closure(model, slide, pin.SE3.Identity(), fold, translation(1.0, 0.0, 0.0), "3d")])
