"""URDF with the joints and constraints of Drake.

Facts of Drake that the importer relies on (documentation of its parser): a robot floats unless it is joined to the link
``world``; limits that are not stated are infinite; a ``universal`` joint turns about x, then y, of its frame; a ball
constraint holds a point of one body at a point of another; a tendon constraint bounds a sum of joint coordinates.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from lxml import etree

from eurdf.closures.point import PointClosure
from eurdf.convert.import_format import LOCKED, ImportFormat, ImportInput, RobotRead, loss_kinds
from eurdf.convert.losses import approximate, dropped
from eurdf.convert.names import UniqueNames
from eurdf.convert.steps import without_locks
from eurdf.convert.urdf.read import URDF_LOSSES, UrdfDialect, read_tree
from eurdf.convert.xml_elements import Elements, local, named
from eurdf.mechanism.body import Anchor, Frame
from eurdf.mechanism.constraint import Closure, Coupling
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_types import JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose, X, Y
from eurdf.writing.urdf_elements import UNLIMITED

_WORLD = "world"

#: Elements of Drake that are read here, and those that have no effect on the robot alone.
_KNOWN = ("frame", "ball_constraint", "tendon_constraint", "collision_filter_group")

_LOSSES = {
    "locked-joint": LOCKED,
    "tendon": dropped(
        "tendon constraint",
        "is left out: it bounds a sum of coordinates, and does not fix it",
        "limit the motion in the controller",
    ),
    "softness": approximate(
        "tendon constraint",
        "becomes rigid: its stiffness and damping are left out",
        "keep them in a file of the simulator",
        error="what the constraint gives way under load",
    ),
    **URDF_LOSSES,
}


@dataclass(slots=True)
class _DrakeJoints:
    """The joints of Drake, while their elements become those of URDF.

    Attributes:
        kinds: By name, the type as written.
        pitches: By name, m per revolution.
        damping: By name, of a planar joint.
        acceleration: By name, the limit of both acceleration and deceleration, rad/s² or m/s².
    """

    kinds: dict[str, str] = field(default_factory=dict)
    pitches: dict[str, float] = field(default_factory=dict)
    damping: dict[str, tuple[float, ...]] = field(default_factory=dict)
    acceleration: dict[str, float] = field(default_factory=dict)


#: The type that a joint of Drake has in the plain URDF, and the one that it becomes.
_TYPES = {
    "ball": ("continuous", JointType.SPHERICAL),
    "universal": ("continuous", JointType.UNIVERSAL),
    "screw": ("continuous", JointType.HELICAL),
    "planar": ("planar", JointType.PLANAR),
}


def read(given: ImportInput) -> RobotRead:
    """Read a URDF of Drake.

    Raises:
        CannotImport: It has an error.
    """
    elements, joints = Elements(given.path), _DrakeJoints()
    tree = read_tree(
        given,
        _KNOWN,
        lambda root: _make_plain(root, elements, joints),
        lambda joint: without_locks(_as_in_drake(joint, joints), given.losses),
    )
    tree = replace(tree, mechanism=_on_the_world(tree.mechanism))
    names = UniqueNames(tree.losses)
    mechanism = replace(
        tree.mechanism, frames=_frames(tree), closures=_closures(tree, names), couplings=_couplings(tree, names)
    )
    return RobotRead(mechanism, (given.path,))


def _make_plain(root: etree._Element, elements: Elements, joints: _DrakeJoints) -> None:
    """Make the joints of Drake those of URDF, and state the limits that URDF asks for."""
    for joint in [child for child in root if isinstance(child.tag, str) and local(child) == "joint"]:
        name, kind = joint.get("name", ""), joint.get("type", "")
        if joint.tag != "joint":
            if kind not in _TYPES:
                raise elements.refuse(joint, f"{named(joint)} has the type '{kind}'; Drake has {', '.join(_TYPES)}")
            joints.kinds[name] = kind
            joint.tag = "joint"
            joint.set("type", _TYPES[kind][0])
            pitch = next((child for child in joint if local(child) == "screw_thread_pitch"), None)
            if kind == "screw":
                joints.pitches[name] = 0.0 if pitch is None else elements.attribute(pitch, "value")
                if not joints.pitches[name]:
                    raise elements.refuse(joint, f"{named(joint)} has no pitch")
            dynamics = joint.find("dynamics")
            if kind == "planar" and dynamics is not None:
                joints.damping[name] = elements.numbers(dynamics, dynamics.get("damping", "0 0 0"), 3, "'damping'")
                joint.remove(dynamics)
            if kind in ("ball", "universal"):
                for axis in joint.findall("axis"):
                    joint.remove(axis)
        kind = joint.get("type", "")
        limit = joint.find("limit")
        if kind in ("revolute", "prismatic") and limit is None:
            limit = etree.SubElement(joint, "limit")
        if limit is not None:
            for key in map(str, limit.keys()):
                if key.endswith(("}acceleration", ":acceleration")):
                    joints.acceleration[name] = elements.attribute(limit, key)
            unlimited = {"effort": f"{UNLIMITED!r}", "velocity": f"{UNLIMITED!r}"}
            if kind in ("revolute", "prismatic"):
                unlimited |= {"lower": f"{-UNLIMITED!r}", "upper": f"{UNLIMITED!r}"}
            for attribute, value in unlimited.items():
                if limit.get(attribute) is None:
                    limit.set(attribute, value)


def _as_in_drake(joint: Joint, joints: _DrakeJoints) -> Joint:
    """A joint with the type that it has in Drake."""
    stated = joints.kinds.get(joint.name)
    if stated is None:
        if joint.name not in joints.acceleration:
            return joint
        limit = (joints.acceleration[joint.name],)
        return joint.with_properties(replace(joint.properties, acceleration=limit, deceleration=limit))
    kind = _TYPES[stated][1]
    nv = kind.nv
    own = joint.properties
    properties = JointProperties.unlimited(kind)
    if stated == "planar":
        properties = replace(properties, damping=joints.damping.get(joint.name, properties.damping))
    else:
        properties = replace(properties, damping=own.damping * nv, friction=own.friction * nv, effort=own.effort * nv)
    axes = {"universal": (X, Y), "screw": joint.axes}.get(stated, ())
    return replace(joint, type=kind, axes=axes, pitch=joints.pitches.get(joint.name, 0.0), properties=properties)


def _on_the_world(mechanism: Mechanism) -> Mechanism:
    """The robot floats unless its root is the world, which is left out if it only holds the robot's own root."""
    if mechanism.bodies[0].name != _WORLD:
        return replace(mechanism, root="floating")
    world = mechanism.bodies[0]
    held = [joint for joint in mechanism.joints if joint.parent == _WORLD]
    bare = world.inertia is None and not world.visuals and not world.collisions
    if bare and len(held) == 1 and held[0].type.is_fixed and held[0].placement == IDENTITY:
        return replace(mechanism, bodies=mechanism.bodies[1:], joints=mechanism.joints[1:])
    return mechanism


def _frames(tree: UrdfDialect) -> tuple[Frame, ...]:
    names = tree.frame_names()
    return tuple(
        Frame(
            names.new(element.get("name", "frame")),
            tree.link(element, element.get("link")),
            tree.elements.pose(element),
        )
        for element in tree.children("frame")
    )


def _closures(tree: UrdfDialect, names: UniqueNames) -> tuple[Closure, ...]:
    """The ball constraints. A collision filter group names those of its two bodies that are before it."""
    found: list[Closure] = []
    group: list[tuple[Anchor, Anchor]] = []

    def close(name: str = "") -> None:
        for number, (a, b) in enumerate(group, 1):
            stated = name or f"{a.body}_{b.body}"
            found.append(PointClosure(names.new(stated if number == 1 else f"{stated}_{number}"), a, b))
        group.clear()

    for element in tree.root:
        tag = local(element) if isinstance(element.tag, str) else ""
        bodies = [end.body for end in group[0]] if group else []
        if tag == "ball_constraint":
            parts = {local(child).removeprefix("ball_constraint_"): child for child in element}
            if missing := {"body_A", "body_B", "p_AP", "p_BQ"} - parts.keys():
                raise tree.elements.refuse(element, f"<ball_constraint> has no <drake:ball_constraint_{min(missing)}>")
            a, b = (
                Anchor(tree.link(element, parts[body].get("name")), Pose(tree.elements.vector(parts[point], "value")))
                for body, point in (("body_A", "p_AP"), ("body_B", "p_BQ"))
            )
            if [a.body, b.body] != bodies:
                close()
            group.append((a, b))
        elif tag == "collision_filter_group":
            members = {child.get("link") for child in element if local(child) == "member"}
            if members == set(bodies):
                close(element.get("name", ""))
    close()
    return tuple(found)


def _couplings(tree: UrdfDialect, names: UniqueNames) -> tuple[Coupling, ...]:
    joints = {joint.name for joint in tree.mechanism.joints}
    found = []
    for element in tree.children("tendon_constraint"):
        parts = {local(child).removeprefix("tendon_constraint_"): child for child in element}
        terms: dict[str, float] = {}
        for child in element:
            if local(child) == "tendon_constraint_joint":
                joint = child.get("name", "")
                if joint not in joints:
                    raise tree.elements.refuse(
                        element, f"<tendon_constraint> names the joint '{joint}', which does not exist"
                    )
                terms[joint] = terms.get(joint, 0.0) + tree.elements.attribute(child, "a")
        offset, lower, upper = (
            tree.elements.attribute(parts[key], "value") if key in parts else default
            for key, default in (("offset", 0.0), ("lower_limit", -math.inf), ("upper_limit", math.inf))
        )
        stated = "_".join(terms)
        if lower != upper or len(terms) < 2:
            tree.losses.add("import-tendon", stated)
            continue
        name = names.new(stated)
        tree.losses.add("import-softness", name)
        found.append(Coupling(name, tuple(terms.items()), lower - offset))
    return tuple(found)


FORMAT = ImportFormat(read, loss_kinds(_LOSSES))
