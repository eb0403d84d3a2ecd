"""Joints of a loop that probably have another type or axis: by their names, and by the joints beside them."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from math import asin, degrees
from typing import Any

import numpy as np
import pinocchio as pin

from eurdf.advice.hinges import axis_of, closures_of
from eurdf.array import Vector
from eurdf.diagnostics import Edit, Fix, enumerated
from eurdf.format.fixes import removed
from eurdf.format.urdf.data import UrdfJoint
from eurdf.kinematics.loop_analysis import LoopAnalysis
from eurdf.linking.counterparts import changes_between, is_alike, is_elsewhere, is_opposite
from eurdf.linking.robot_files import ReadRobot
from eurdf.mechanism.constraint import Closure
from eurdf.mechanism.joint import Joint
from eurdf.mechanism.joint_types import ROTARY, SLIDING
from eurdf.pinocchio.robot import Robot
from eurdf.writing.yaml_edits import NotEditable, YamlEdits, edited

# Words in the names of ball joints, of the published convention and of others.
_BALL = re.compile(r"(?i)spherical|rotul|(?<![^\W_\d])ball(?![^\W\d_])")

# The sine of the angle between two axes that count as parallel.
_PARALLEL = 1e-5

# An axis that is off by less than this, in degrees, is a mistake, if those of all others are parallel.
_SMALL = 10.0


def other_joints(read: ReadRobot, robot: Robot, q: Vector, loop: LoopAnalysis) -> Iterator[Fix]:
    """Proposals for a group of loops that locks actuators: another type, then another axis, of joints that are odd."""
    paths = [_path(robot, closure) for closure in closures_of(robot, loop)]
    joints = list({joint.name: joint for path in paths for joint in path}.values())
    yield from _missing_types(read, joints)
    yield from _locked(read, joints)
    yield from {fix.summary: fix for path in paths for fix in _odd_axes(read, robot, q, path)}.values()
    yield from _universal_axes(read, joints)


def missing_types(read: ReadRobot, robot: Robot) -> Iterator[Fix]:
    """Proposals to state the types of joints of loops that their names say."""
    paths = [_path(robot, closure) for closure in robot.mechanism.closures]
    yield from _missing_types(read, {joint.name: joint for path in paths for joint in path}.values())


def _path(robot: Robot, closure: Closure) -> list[Joint]:
    """The joints between the bodies of a closure, fixed ones too."""
    above = {joint.child: joint for joint in robot.mechanism.joints}
    ways: list[dict[str, Joint]] = []
    for anchor in closure.anchors:
        body, way = anchor.body, {}
        while body in above:
            way[above[body].name] = above[body]
            body = above[body].parent
        ways.append(way)
    return [joint for way, other in (ways, ways[::-1]) for name, joint in way.items() if name not in other]


def _missing_types(read: ReadRobot, joints: Iterable[Joint]) -> Iterator[Fix]:
    """The types of joints that are named like others whose type the description states, or like a ball."""
    document, is_first = read.description.document, read.mechanism.version == "1"
    stated = document.data.get("joints", {})
    if is_first:
        stated = dict(zip(document.data.get("joint_name", ()), document.data.get("joint_type", ()), strict=True))
    actuators = frozenset(read.mechanism.actuators)
    types: dict[str, Any] = {}
    balls = [kind in ("spherical", "SPHERICAL") for name, kind in stated.items() if _BALL.search(name)]
    says_ball = not balls or (any(balls) and balls.count(False) < 2)
    known = read.urdf.joints.keys() - actuators  # version 1 splits joints into others
    for joint in joints:
        name, own = joint.name, stated.get(joint.name)
        if name in known and (joint.type in ROTARY or (own is not None and not is_first)):
            like = [other for other in stated if other not in actuators and _is_like(other, name)]
            kind = "SPHERICAL" if is_first else "spherical"
            kind = kind if says_ball and _BALL.search(name) else stated[like[0]] if like else own
            if kind != own:
                types[name] = kind
    if types:
        kinds = {name: kind if type(kind) is str else kind.get("type") for name, kind in types.items()}
        shown = ", ".join(f"'{name}: {kind}'" for name, kind in kinds.items())

        def add(edits: YamlEdits) -> None:
            if is_first:
                edits.add_items("joint_name", list(types))
                edits.add_items("joint_type", list(types.values()))
                return
            edits.add_entries("joints", {name: kind for name, kind in types.items() if name not in stated})
            for name in types.keys() & stated.keys():
                start, end = document.span(("joints", name))
                if end is None:
                    raise NotEditable(f"'{name}' has a block")
                edits.change(start, end, edits.flow(types[name]))

        its = "its name says" if len(types) == 1 else "their names say"
        yield Fix(f"state {shown} in the joints, as {its}", edited(document, add), f"do the joints lack {shown}?")


def needless_types(read: ReadRobot, moved: Iterable[str]) -> Iterator[Fix]:
    """Proposals not to state the types of joints that move with every actuator held, where no name says the type."""
    document = read.description.document
    stated = document.data.get("joints", {}) if read.mechanism.version != "1" else {}
    for name in moved:
        kind = stated.get(name)
        if type(kind) is str and not _BALL.search(name) and not any(_is_like(name, other) for other in stated):
            pointer = ("joints", name) if len(stated) > 1 else ("joints",)
            for fix in removed(document, pointer, f"'{name}: {kind}' from 'joints'"):
                yield replace(fix, question=f"is joint '{name}' {kind}?", rivals=True)


def _is_like(name: str, other: str) -> bool:
    return is_opposite(name, other) or is_elsewhere(changes_between(name, other))


def _locked(read: ReadRobot, joints: Iterable[Joint]) -> Iterator[Fix]:
    """Fixed joints of the URDF whose counterpart turns, or the only one that states an axis."""
    fixed = (joint for joint in read.urdf.joints.values() if joint.type.is_fixed)
    stating = [joint for joint in fixed if joint.element.find("axis") is not None and any(joint.axis)]
    for joint in joints:
        element = read.urdf.joints.get(joint.name)
        if element is None or not element.type.is_fixed or read.urdf.links[joint.child].inertia is None:
            continue  # a frame, for instance
        like = next(
            (each for each in read.urdf.joints.values() if not each.type.is_fixed and is_alike(each.name, joint.name)),
            None,
        )
        has_axis = stating == [element]
        if like is not None or has_axis:
            kind = "revolute" if element.element.find("limit") is not None else "continuous"
            why = "it states an axis" if has_axis else f"'{like.name}' turns" if like else ""
            yield Fix(
                f"give joint '{joint.name}' the type {kind}: it is fixed, but {why}",
                _in_urdf(read, element.element, "type", kind),
                f"is joint '{joint.name}' a pin, since {why}?",
            )


def is_planar(robot: Robot, q: Vector, loop: LoopAnalysis) -> bool:
    """Whether the axes of all joints of a group of loops are parallel, and normal to what slides."""
    for closure in closures_of(robot, loop):
        found = _axes(robot, q, _path(robot, closure))
        if found is None or not found[0] or not _is_plane(next(iter(found[0].values())), found[0].values(), found[1]):
            return False
    return True


def _axes(robot: Robot, q: Vector, path: Iterable[Joint]) -> tuple[dict[str, Vector], list[Vector]] | None:
    """The axes in the world of joints that turn, by name, and of those that slide; None if some do other things."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    turns: dict[str, Vector] = {}
    slides: list[Vector] = []
    for joint in path:
        if joint.type.is_fixed:
            continue
        index, is_slide = robot.model.getJointId(joint.name), joint.type in SLIDING
        axis = axis_of(robot, data, index, q, slides=is_slide) if joint.type in ROTARY | SLIDING else None
        if axis is None:
            return None
        if is_slide:
            slides.append(axis)
        else:
            turns[joint.name] = axis
    return turns, slides


def _is_plane(normal: Vector, turns: Iterable[Vector], slides: Iterable[Vector]) -> bool:
    parallel = all(np.linalg.norm(np.cross(normal, axis)) <= _PARALLEL for axis in turns)
    return parallel and all(abs(normal @ axis) <= _PARALLEL for axis in slides)


def _odd_axes(read: ReadRobot, robot: Robot, q: Vector, path: Sequence[Joint]) -> Iterator[Fix]:
    """The joints of a loop whose axis alone is not parallel to those of all others."""
    found = _axes(robot, q, path)
    if found is None:
        return
    turns, slides = found
    for name, axis in turns.items():
        others = {other: each for other, each in turns.items() if other != name}
        if len(others) + len(slides) < 2 or not others:
            continue
        normal = next(iter(others.values()))
        off = float(np.linalg.norm(np.cross(axis, normal)))
        if off > _PARALLEL and _is_plane(normal, others.values(), slides):
            yield _given_axis(read, robot, q, name, normal if axis @ normal >= 0.0 else -normal, off, others)


def _given_axis(
    read: ReadRobot, robot: Robot, q: Vector, name: str, axis: Vector, off: float, others: Collection[str]
) -> Fix:
    """The proposal to give a joint the axis, a unit vector in the world, that is that of others."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, q)
    index = robot.model.getJointId(name)
    placed = data.oMi[robot.model.parents[index]].rotation @ robot.model.jointPlacements[index].rotation
    own = np.round(placed.T @ axis, 9) + 0.0
    text = " ".join(f"{number:.9g}" for number in own)
    angle = degrees(asin(min(off, 1.0)))
    beside = f"the axes of {enumerated(list(others))} are parallel"
    if len(others) == 1:
        beside = f"the axis of {enumerated(list(others))} is normal to what slides"
    said = f"{beside}, that of '{name}' is {angle:.2g}° off"
    like = any(
        is_elsewhere(changes_between(name, each.name)) and np.allclose(each.axis, own)
        for each in read.urdf.joints.values()
    )
    is_sure = like or angle < _SMALL or len(others) > 2
    return Fix(
        f"give joint '{name}' the axis xyz=\"{text}\": {said}",
        _with_axis(read, read.urdf.joints[name], text) if is_sure else (),
        f"is the axis of joint '{name}' wrong, since {said}?",
        rivals=not like and (angle >= _SMALL or len(others) < 2),
    )


def _universal_axes(read: ReadRobot, joints: Iterable[Joint]) -> Iterator[Fix]:
    """The axes of universal joints, stated by letters, that others of their kind have; else whether they are right."""
    document = read.description.document
    data = document.data.get("joints", {}) if read.mechanism.version != "1" else {}
    stated = {name: kind["axes"] for name, kind in data.items() if type(kind) is dict and type(kind.get("axes")) is str}
    names = [joint.name for joint in joints if joint.name in stated]
    for name in names:
        like = (axes for other, axes in stated.items() if axes != stated[name] and is_alike(other, name))
        for axes in dict.fromkeys(like):
            what = f"the axes {axes}, as another joint of its kind has"
            edit = document.edit(("joints", name, "axes"), axes)
            yield Fix(f"give joint '{name}' {what}", (edit,), f"does joint '{name}' have {what}?")
    if names:
        shown = ", ".join(f"{stated[name]} of '{name}'" for name in names)
        yield Fix("", (), f"are the axes of the universal joints right: {shown}?")


def _with_axis(read: ReadRobot, joint: UrdfJoint, text: str) -> tuple[Edit, ...]:
    axis = joint.element.find("axis")
    if axis is not None:
        return _in_urdf(read, axis, "xyz", text)
    source = read.urdf.document.source
    end = source.text.index(">", read.urdf.document.span(joint.element, "type")[1]) + 1
    return () if source.made_from else (source.edit(end, end, f'<axis xyz="{text}"/>'),)


def _in_urdf(read: ReadRobot, element: Any, attribute: str, text: str) -> tuple[Edit, ...]:
    """The edit of an attribute; none where the URDF was made of other files."""
    document = read.urdf.document
    return () if document.source.made_from else (document.source.edit(*document.span(element, attribute), text),)
