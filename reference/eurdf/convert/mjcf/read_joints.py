"""The joints of an MJCF file: which of them are one joint of the mechanism, where it is, its limits and losses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from eurdf.closures.se3 import quaternion_of
from eurdf.convert.mjcf.compiled import Element
from eurdf.convert.mjcf.facts import UNLIMITED
from eurdf.convert.mjcf.read_state import MjcfReading, WholeJoint, flat, usable, vector, xyzw
from eurdf.convert.steps import SCREW_SLIDE, suffixes
from eurdf.mechanism.body import Body
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY, Pose, Quaternion, cross

#: Lengths (m), and parts of unit vectors, that differ by no more are equal.
_SAME = 1e-9

#: MuJoCo's types of joints, by the motions of ours.
_TYPES = {"slide": "slide", "turn": "hinge", "ball": "ball"}


def _parts(kind: JointType) -> dict[str, str]:
    return dict(zip(suffixes(kind), (_TYPES[step.kind] for step in kind.steps), strict=True))


#: The joints of MuJoCo that an export makes of one joint: the ends of their names, and their types.
_EXPORTED: Mapping[JointType, Mapping[str, str]] = {
    **{kind: _parts(kind) for kind in JointType if len(kind.steps) > 1},
    JointType.HELICAL: {SCREW_SLIDE: "slide", "": "hinge"},
}


def read_joints(reading: MjcfReading, body: int) -> None:
    """The joints between a body and its parent, with links without mass between them."""
    link = reading.bodies[body].name
    parent = reading.bodies[reading.model["body"][body].parentid].name
    pose = reading.pose_of(body)
    found = _whole_joints(reading, body)
    if not found:
        name = reading.joint_names.new(f"{link}_fixed")
        reading.joints[name] = Joint(name, JointType.FIXED, parent, link, pose)
        return
    # The coordinates of a free joint are the pose in the world.
    before = IDENTITY if reading.kinds(body) == ["free"] else pose
    for whole in found:
        last = whole is found[-1]
        here = Pose(whole.anchor) * whole.turn
        placement = before * here
        moved = _reference(reading, whole)
        if moved is not IDENTITY:
            placement = placement * moved.inverse()
        child = link
        if not last:
            child = reading.links.new(f"{whole.name}_link")
            reading.extra.append(Body(child))
        offset = here.inverse() if last and here != IDENTITY else IDENTITY
        properties = _properties(reading, whole)
        reading.joints[whole.name] = Joint(
            whole.name, whole.type, parent, child, placement, offset, whole.axes, whole.pitch, properties
        )
        reading.whole |= {joint.index: whole for joint in whole.joints}
        parent, before = child, here.inverse()


def _reference(reading: MjcfReading, whole: WholeJoint) -> Pose:
    """How far a joint has moved its child at qpos0."""
    if whole.type.quaternion is not None:
        return IDENTITY
    coordinates = coordinates_at(whole, reading.model.qpos0)
    bare = Joint(whole.name, whole.type, "", "", axes=whole.axes, pitch=whole.pitch)
    return bare.transform(coordinates) if any(coordinates) else IDENTITY


def coordinates_at(whole: WholeJoint, qpos: Sequence[float]) -> tuple[float, ...]:
    """The coordinates of a joint, as files have them, at a configuration of MuJoCo."""
    found: list[float] = []
    for joint in _moving(whole):
        at = joint.qposadr
        if joint.type == "free":
            found += qpos[at : at + 3]
            at += 3
        found += xyzw(qpos[at : at + 4]) if joint.type in ("free", "ball") else (float(qpos[at]),)
    if whole.type.quaternion is not None and whole.turn is not IDENTITY:
        turned = whole.turn.inverse() * Pose(quaternion=cast(Quaternion, tuple(found[-4:]))) * whole.turn
        found[-4:] = turned.quaternion
    return tuple(found)


def _moving(whole: WholeJoint) -> tuple[Element, ...]:
    """The joints of MuJoCo that have the coordinates of a joint: the slide of a helical one follows its hinge."""
    return whole.joints[1:] if whole.type is JointType.HELICAL else whole.joints


# -- one joint of several ---------------------------------------------------------------------------------------------


def _whole_joints(reading: MjcfReading, body: int) -> list[WholeJoint]:
    """The joints of a body. Those that an export made of one joint, by their names, are that joint again."""
    joints = reading.joints_of[body]
    for kind, parts in _EXPORTED.items():
        if [joint.type for joint in joints] == list(parts.values()):
            found = _exported(reading, joints, kind, list(parts))
            if found is not None:
                return [found]
    return [_single(reading, joint, body) for joint in joints]


def _single(reading: MjcfReading, joint: Element, body: int) -> WholeJoint:
    is_first = joint is reading.joints_of[body][0]
    made = f"{reading.bodies[body].name}_joint" if is_first else f"joint_{joint.index}"
    name = reading.new_name(reading.joint_names, joint, "joint", made)
    anchor, axis = vector(joint.pos), vector(joint.axis)
    match joint.type:
        case "free":
            return WholeJoint(name, JointType.FLOATING, (joint,))
        case "ball":
            return WholeJoint(name, JointType.SPHERICAL, (joint,), anchor)
        case "slide":
            return WholeJoint(name, JointType.PRISMATIC, (joint,), axes=(axis,))
    kind = JointType.REVOLUTE if any(map(math.isfinite, _range(joint))) else JointType.CONTINUOUS
    return WholeJoint(name, kind, (joint,), anchor, (axis,))


def _exported(
    reading: MjcfReading, joints: Sequence[Element], kind: JointType, ends: Sequence[str]
) -> WholeJoint | None:
    """The one joint that an export splits into these; None if they are not such joints."""
    stem = joints[0].name.removesuffix(ends[0])
    if not stem or [stem + end for end in ends] != [joint.name for joint in joints] or usable(stem) != stem:
        return None
    axes = [vector(joint.axis) for joint in joints]
    anchors = [vector(joint.pos) for joint in joints if joint.type != "slide"]
    if any(math.dist(anchor, anchors[0]) > _SAME for anchor in anchors) or not _is_one(reading, joints, kind):
        return None
    turn, pitch = IDENTITY, 0.0
    if kind in (JointType.CYLINDRICAL, JointType.HELICAL):
        if math.dist(*axes) > _SAME:
            return None
        if kind is JointType.HELICAL:
            pitch = 2.0 * math.pi * _advance(reading, *joints)
            if not pitch:
                return None
        axes = axes[:1]
    elif kind is JointType.UNIVERSAL:
        if math.hypot(*cross(*axes)) < 1e-6:
            return None
    else:
        x, y, z = axes[:3]
        if math.dist(cross(x, y), z) > _SAME or abs(x[0] * y[0] + x[1] * y[1] + x[2] * y[2]) > _SAME:
            return None
        turn = Pose(quaternion=cast(Quaternion, tuple(quaternion_of(np.transpose((x, y, z))).tolist())))
        axes = []
    return WholeJoint(reading.joint_names.new(stem), kind, tuple(joints), anchors[0], tuple(axes), turn, pitch)


def _is_one(reading: MjcfReading, joints: Sequence[Element], kind: JointType) -> bool:
    """Whether nothing acts on one of the joints alone."""
    if kind is JointType.HELICAL:
        return True
    model, own = reading.model, {joint.index for joint in joints}
    if any(each.type == "joint" and not own.isdisjoint((each.obj1id, each.obj2id)) for each in model["eq"]):
        return False
    acted_on = {joint.index for each in model["actuator"] if (joint := reading.driven(each))}
    driven = [joint.index in acted_on for joint in joints[: 3 if kind is JointType.FLOATING else None]]
    is_sprung = kind.moving_frame and any(joint.stiffness for joint in joints)
    return all(driven) == any(driven) and not is_sprung


def _advance(reading: MjcfReading, slide: Element, hinge: Element) -> float:
    """m/rad by which an equality makes a slide follow a hinge; 0 if none does."""
    for each in reading.model["eq"]:
        pair = each.obj1id, each.obj2id
        if each.type == "joint" and pair == (slide.index, hinge.index) and not each.data[0] and not any(each.data[2:5]):
            reading.consumed.add(each.index)
            return float(each.data[1])
    return 0.0


# -- limits, losses and springs ---------------------------------------------------------------------------------------


def _range(joint: Element) -> tuple[float, float]:
    """Smallest and largest coordinate of a joint of MuJoCo, rad or m; infinite for no limit."""
    if not joint.limited:
        return -math.inf, math.inf
    lower, upper = joint.range
    return (lower if lower > -UNLIMITED else -math.inf), (upper if upper < UNLIMITED else math.inf)


def _properties(reading: MjcfReading, whole: WholeJoint) -> JointProperties:
    """What a joint has beside its axes and its motor, which `read_actuators` reads."""
    free = JointProperties.unlimited(whole.type)
    joints = _moving(whole)
    dofs = [dof for joint in joints for dof in _dofs(reading, joint)]
    if any(any(flat(joint.stiffnesspoly)) for joint in whole.joints) or any(any(flat(dof.dampingpoly)) for dof in dofs):
        reading.losses.add("import-nonlinear-spring", whole.name)
    springs = {}
    if whole.type.moving_frame:
        if any(joint.stiffness for joint in joints):
            reading.losses.add("import-ball-spring", whole.name)
        if any(joint.limited for joint in joints):
            reading.losses.add("import-ball-limit", whole.name)
        bounds = list(zip(free.lower, free.upper, strict=True))
    else:
        bounds = list(map(_range, joints))
        if any(joint.stiffness for joint in joints):
            rest = tuple(reading.model.qpos_spring[joint.qposadr] for joint in joints)
            springs = {"stiffness": tuple(float(joint.stiffness) for joint in joints), "rest": rest}
    efforts = [effort for joint in joints for effort in [_effort(reading, joint)] * len(_dofs(reading, joint))]
    return replace(
        free,
        lower=tuple(lower for lower, _ in bounds),
        upper=tuple(upper for _, upper in bounds),
        effort=tuple(efforts),
        damping=tuple(float(dof.damping) for dof in dofs),
        friction=tuple(float(dof.frictionloss) for dof in dofs),
        armature=tuple(float(dof.armature) for dof in dofs),
        **springs,
    )


def _dofs(reading: MjcfReading, joint: Element) -> Sequence[Element]:
    count = {"free": 6, "ball": 3}.get(joint.type, 1)
    return reading.model["dof"][joint.dofadr : joint.dofadr + count]


def _effort(reading: MjcfReading, joint: Element) -> float:
    """The effort limit that a joint states, N·m or N."""
    return largest_effort(reading, joint.actfrcrange, joint.name) if joint.actfrclimited else math.inf


def largest_effort(reading: MjcfReading, bounds: Sequence[float], name: str) -> float:
    """The effort limit, N·m or N, that a range of torques or forces is."""
    lower, upper = bounds
    if -lower != upper:
        reading.losses.add("import-unequal-effort", name, f"is {lower:g} to {upper:g}: the larger one is taken")
    return float(max(abs(lower), abs(upper)))
