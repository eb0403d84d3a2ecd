"""URDF with the joints and constraints of Drake.

Facts of Drake that the importer relies on (documentation of its parser): a robot floats unless it is joined to the link
``world``; limits that are not stated are infinite; a ``universal`` joint turns about x, then y, of its frame; a ball
constraint holds a point of one body at a point of another; a tendon constraint bounds a sum of joint coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from lxml import etree

from eurdf.importing.elements import Elements, local, named
from eurdf.importing.locked import LOCKED, without_locks
from eurdf.importing.orientation import orientation
from eurdf.importing.robot_read import ImportFormat, RobotRead
from eurdf.importing.urdf_tree import URDF_LOSSES, UrdfTree, read_tree
from eurdf.loss import Effect, Losses, LossKind
from eurdf.mechanism.constraint import Closure, Coupling, FrameClosure, HingeClosure, PointClosure
from eurdf.mechanism.frame import Anchor, Frame
from eurdf.mechanism.joint import Joint, JointProperties
from eurdf.mechanism.joint_type import COORDINATES, JointType
from eurdf.mechanism.mechanism import Mechanism
from eurdf.mechanism.pose import IDENTITY, Pose, Vector3
from eurdf.reading.resource import FileFinder
from eurdf.writing.names import UniqueNames
from eurdf.writing.urdf_elements import LARGEST

_WORLD = "world"
_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

#: Distances of two points in two bodies, m, that differ by no more are equal.
_SAME = 1e-9

#: Elements of Drake that are read here, and those that have no effect on the robot alone.
_KNOWN = (
    "frame",
    "ball_constraint",
    "tendon_constraint",
    "collision_filter_group",
)

LOSSES = (
    LOCKED,
    LossKind(
        "import-tendon",
        "tendon constraint",
        Effect.DROPPED,
        "is left out: it bounds a sum of coordinates, and does not fix it",
        "limit the motion in the controller",
    ),
    LossKind(
        "import-softness",
        "tendon constraint",
        Effect.APPROXIMATE,
        "becomes rigid: its stiffness and damping are left out",
        "keep them in a file of the simulator",
        error="what the constraint gives way under load",
    ),
    *URDF_LOSSES,
)


@dataclass(slots=True)
class _Joints:
    """The joints of Drake, while their elements become those of URDF.

    Attributes:
        kinds: By name, the type as written.
        pitches: By name, m per revolution.
        damping: By name, of a planar joint.
    """

    kinds: dict[str, str] = field(default_factory=dict)
    pitches: dict[str, float] = field(default_factory=dict)
    damping: dict[str, tuple[float, ...]] = field(default_factory=dict)


#: The type that a joint of Drake has in the plain URDF, and the one that it becomes.
_TYPES = {
    "ball": ("continuous", JointType.SPHERICAL),
    "universal": ("continuous", JointType.UNIVERSAL),
    "screw": ("continuous", JointType.HELICAL),
    "planar": ("planar", JointType.PLANAR),
}


def read(path: Path, finder: FileFinder) -> RobotRead:
    """Read a URDF of Drake.

    Raises:
        CannotImport: It has an error.
    """
    losses, elements, joints = Losses(LOSSES), Elements(path), _Joints()
    tree = read_tree(
        path,
        finder,
        losses,
        _KNOWN,
        lambda root: _make_plain(root, elements, joints),
        lambda joint: without_locks(_as_in_drake(joint, joints), losses),
    )
    mechanism = _on_the_world(tree.mechanism)
    names = UniqueNames(losses, code="import-name")
    mechanism = replace(
        mechanism,
        frames=_frames(tree, mechanism, losses),
        closures=_closures(tree, mechanism, names),
        couplings=_couplings(tree, mechanism, names, losses),
    )
    return RobotRead(mechanism, losses.found, tree.copies.files, sources=(path,))


def _make_plain(root: etree._Element, elements: Elements, joints: _Joints) -> None:
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
            unlimited = {"effort": f"{LARGEST!r}", "velocity": f"{LARGEST!r}"}
            if kind in ("revolute", "prismatic"):
                unlimited |= {"lower": f"{-LARGEST!r}", "upper": f"{LARGEST!r}"}
            for attribute, value in unlimited.items():
                if limit.get(attribute) is None:
                    limit.set(attribute, value)


def _as_in_drake(joint: Joint, joints: _Joints) -> Joint:
    """A joint with the type that it has in Drake."""
    stated = joints.kinds.get(joint.name)
    if stated is None:
        return joint
    kind = _TYPES[stated][1]
    nv = COORDINATES[kind].nv
    own = joint.properties
    properties = JointProperties.unlimited(kind)
    if stated == "planar":
        properties = replace(properties, damping=joints.damping.get(joint.name, properties.damping))
    else:
        properties = replace(properties, damping=own.damping * nv, friction=own.friction * nv, effort=own.effort * nv)
    axes = {"universal": (_X, _Y), "screw": joint.axes}.get(stated, ())
    return replace(joint, type=kind, axes=axes, pitch=joints.pitches.get(joint.name, 0.0), properties=properties)


def _on_the_world(mechanism: Mechanism) -> Mechanism:
    """The robot floats unless its root is the world, which is left out if it only holds the robot's own root."""
    if mechanism.bodies[0].name != _WORLD:
        return replace(mechanism, root="floating")
    world = mechanism.bodies[0]
    held = [joint for joint in mechanism.joints if joint.parent == _WORLD]
    bare = world.inertia is None and not world.visuals and not world.collisions
    if bare and len(held) == 1 and held[0].type is JointType.FIXED and held[0].placement == IDENTITY:
        return replace(mechanism, bodies=mechanism.bodies[1:], joints=mechanism.joints[1:])
    return mechanism


def _frames(tree: UrdfTree, mechanism: Mechanism, losses: Losses) -> tuple[Frame, ...]:
    links = [body.name for body in mechanism.bodies]
    names = UniqueNames(losses, *links, *(joint.name for joint in mechanism.joints), code="import-name")
    return tuple(
        Frame(
            names.new(element.get("name", "frame")),
            tree.elements.link(element, element.get("link"), links),
            tree.elements.pose(element),
        )
        for element in tree.root
        if isinstance(element.tag, str) and local(element) == "frame"
    )


def _closures(tree: UrdfTree, mechanism: Mechanism, names: UniqueNames) -> tuple[Closure, ...]:
    """The ball constraints; several of one pair of bodies in a row, at points that are as far apart, are one closure.

    A collision filter group of the two bodies names it, and ends it.
    """
    links = [body.name for body in mechanism.bodies]
    found: list[Closure] = []
    group: list[tuple[Vector3, Vector3]] = []
    bodies = ("", "")

    def close(name: str = "") -> None:
        if group:
            stated = names.new(name or f"{bodies[0]}_{bodies[1]}")
            found.extend(_held(stated, bodies, group, names))
            group.clear()

    for element in tree.root:
        tag = local(element) if isinstance(element.tag, str) else ""
        if tag == "ball_constraint":
            parts = {local(child).removeprefix("ball_constraint_"): child for child in element}
            if missing := {"body_A", "body_B", "p_AP", "p_BQ"} - parts.keys():
                raise tree.elements.refuse(element, f"<ball_constraint> has no <drake:ball_constraint_{min(missing)}>")
            pair = tuple(tree.elements.link(element, parts[key].get("name"), links) for key in ("body_A", "body_B"))
            points = tuple(tree.elements.vector(parts[key], "value") for key in ("p_AP", "p_BQ"))
            if pair != bodies or not _congruent(group, (points[0], points[1])):
                close()
            bodies = pair[0], pair[1]
            group.append((points[0], points[1]))
        elif tag == "collision_filter_group":
            members = {child.get("link") for child in element if local(child) == "member"}
            if members == set(bodies):
                close(element.get("name", ""))
    close()
    return tuple(found)


def _congruent(group: Sequence[tuple[Vector3, Vector3]], more: tuple[Vector3, Vector3]) -> bool:
    return len(group) < 3 and all(
        math.dist(p, more[0]) > _SAME and abs(math.dist(p, more[0]) - math.dist(q, more[1])) < _SAME for p, q in group
    )


def _held(
    name: str, bodies: tuple[str, str], points: Sequence[tuple[Vector3, Vector3]], names: UniqueNames
) -> list[Closure]:
    """The closure that holds one, two or three points of a body at those of another."""
    (p, q), *others = points
    if not others:
        return [PointClosure(name, Anchor(bodies[0], Pose(p)), Anchor(bodies[1], Pose(q)))]
    differences = [tuple(np.subtract(each[side], points[0][side]) for each in others) for side in (0, 1)]
    if len(others) == 1:
        one, other = ((float(d[0][0]), float(d[0][1]), float(d[0][2])) for d in differences)
        return [HingeClosure(name, Anchor(bodies[0], Pose(p)), Anchor(bodies[1], Pose(q)), (one, other))]
    poses = []
    for origin, (along, across) in zip((p, q), differences, strict=True):
        x = along / np.linalg.norm(along)
        y = across - (across @ x) * x
        if np.linalg.norm(y) < _SAME:  # three points on a line hold a hinge
            return _held(name, bodies, points[:2], names)
        y = y / np.linalg.norm(y)
        axes = (tuple(map(float, axis)) for axis in (x, y, np.cross(x, y)))
        poses.append(Pose(origin, orientation(*axes).quaternion))  # type: ignore[arg-type]
    return [FrameClosure(name, Anchor(bodies[0], poses[0]), Anchor(bodies[1], poses[1]))]


def _couplings(tree: UrdfTree, mechanism: Mechanism, names: UniqueNames, losses: Losses) -> tuple[Coupling, ...]:
    joints = {joint.name for joint in mechanism.joints}
    found = []
    for element in tree.root:
        if not isinstance(element.tag, str) or local(element) != "tendon_constraint":
            continue
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
            losses.add("import-tendon", stated)
            continue
        name = names.new(stated)
        losses.add("import-softness", name)
        found.append(Coupling(name, tuple(terms.items()), lower - offset))
    return tuple(found)


FORMAT = ImportFormat("drake", "URDF with the joints and constraints of Drake", read, LOSSES)
