"""The joints of MuJoCo that one joint of the mechanism is."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from eurdf.importing.mjcf.joint_properties import position_range
from eurdf.importing.mjcf.reading import MjcfReading
from eurdf.importing.mjcf.step import Step
from eurdf.importing.mjcf.values import SAME, cross, dot, usable, vector
from eurdf.importing.orientation import orientation
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.pose import IDENTITY

#: By the types of the joints of a body, the ends of their names, and the joint that an export splits into them.
_EXPORTED: Mapping[tuple[str, ...], tuple[tuple[str, ...], JointType]] = {
    ("slide", "hinge"): (("_slide", "_turn"), JointType.CYLINDRICAL),
    ("hinge", "hinge"): (("_1", "_2"), JointType.UNIVERSAL),
    ("slide", "slide", "hinge"): (("_x", "_y", "_angle"), JointType.PLANAR),
    ("slide", "slide", "slide", "ball"): (("_x", "_y", "_z", "_ball"), JointType.FLOATING),
}


def grouped(reading: MjcfReading, body: int) -> list[Step]:
    """The joints of a body. Those that an export made of one joint, by their names, are that joint again."""
    joints = reading.joints_of.get(body, [])
    group = _exported_joint(reading, joints)
    if group is not None:
        return [group]
    return [_single(reading, joint, body) for joint in joints]


def _single(reading: MjcfReading, joint: int, body: int) -> Step:
    model = reading.model
    stated = model.names["joint"][joint]
    made = f"{reading.bodies[body].name}_joint" if joint == reading.joints_of[body][0] else f"joint_{joint}"
    name = reading.joint_names.new(usable(stated) or made)
    if not stated or usable(stated) != stated:
        reading.losses.add("import-name", stated or f"joint {joint}", f"becomes '{name}'")
    anchor, axis = vector(model["jnt_pos"][joint]), vector(model["jnt_axis"][joint])
    match model["jnt_type"][joint]:
        case "free":
            return Step(name, JointType.FLOATING, (joint,), (0.0, 0.0, 0.0))
        case "ball":
            return Step(name, JointType.SPHERICAL, (joint,), anchor)
        case "slide":
            return Step(name, JointType.PRISMATIC, (joint,), (0.0, 0.0, 0.0), (axis,))
    kind = JointType.REVOLUTE if any(map(math.isfinite, position_range(reading, joint))) else JointType.CONTINUOUS
    return Step(name, kind, (joint,), anchor, (axis,))


def _exported_joint(reading: MjcfReading, joints: Sequence[int]) -> Step | None:
    """The one joint that an export splits into these."""
    model = reading.model
    names = [model.names["joint"][joint] for joint in joints]
    kinds = [model["jnt_type"][joint] for joint in joints]
    suffixes, kind = _EXPORTED.get(tuple(kinds), ((), None))
    for ends, type_ in ((suffixes, kind), (("_slide", ""), JointType.HELICAL)):
        if type_ is None or len(ends) != len(names) or (type_ is JointType.HELICAL and kinds != ["slide", "hinge"]):
            continue
        stem = names[0].removesuffix(ends[0])
        if not stem or [stem + end for end in ends] != names or usable(stem) != stem:
            continue
        axes = [vector(model["jnt_axis"][joint]) for joint in joints]
        anchors = [vector(model["jnt_pos"][j]) for j, each in zip(joints, kinds, strict=True) if each != "slide"]
        if any(math.dist(anchor, anchors[0]) > SAME for anchor in anchors) or not _is_one(reading, joints, type_):
            continue
        turn, pitch = IDENTITY, 0.0
        match type_:
            case JointType.CYLINDRICAL | JointType.HELICAL:
                if math.dist(*axes) > SAME:
                    continue
                if type_ is JointType.HELICAL:
                    advance = _advance(reading, *joints)
                    if not advance:
                        continue
                    pitch = 2.0 * math.pi * advance
                axes = axes[:1]
            case JointType.UNIVERSAL:
                if math.hypot(*cross(*axes)) < 1e-6:
                    continue
            case _:
                if math.dist(cross(axes[0], axes[1]), axes[2]) > SAME or abs(dot(axes[0], axes[1])) > SAME:
                    continue
                turn, axes = orientation(axes[0], axes[1], axes[2]), []
        return Step(reading.joint_names.new(stem), type_, tuple(joints), anchors[0], tuple(axes), turn, pitch)
    return None


def _is_one(reading: MjcfReading, joints: Sequence[int], kind: JointType) -> bool:
    """Whether nothing acts on one of the joints alone."""
    model = reading.model
    used = {
        joint
        for kind_, one, other in zip(model["eq_type"], model["eq_obj1id"], model["eq_obj2id"], strict=True)
        if kind_ == "joint"
        for joint in (one, other)
    }
    if kind is JointType.HELICAL:
        return True
    driven = [joint in _driven(reading) for joint in joints]
    if kind is JointType.FLOATING:
        driven = driven[:3]
    sprung = kind in (JointType.PLANAR, JointType.FLOATING) and any(model["jnt_stiffness"][j] for j in joints)
    return used.isdisjoint(joints) and all(driven) == any(driven) and not sprung


def _driven(reading: MjcfReading) -> set[int]:
    model = reading.model
    kinds = zip(model["actuator_trntype"], model["actuator_trnid"], strict=True)
    return {ids[0] for kind, ids in kinds if kind in ("joint", "jointinparent")}


def _advance(reading: MjcfReading, slide: int, hinge: int) -> float:
    """m/rad by which an equality makes a slide follow a hinge; 0 if none does."""
    model = reading.model
    for index, kind in enumerate(model["eq_type"]):
        pair = model["eq_obj1id"][index], model["eq_obj2id"][index]
        data = model["eq_data"][index]
        if kind == "joint" and pair == (slide, hinge) and not data[0] and not any(data[2:5]):
            reading.consumed.add(index)
            return float(data[1])
    return 0.0
