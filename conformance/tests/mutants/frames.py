"""Parsers that place frames elsewhere, and drop, move or change shapes."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from eurdf_conformance.oracle import tree, urdf
from eurdf_conformance.oracle.transform import transform
from eurdf_conformance.protocol.message import CanonicalRobot, CanonicalShape, Pose
from mutants.mutant import Deviation, Members, describes, instead, means, refuses

wrong = means("EU-FRM-006")
wrong(
    "Roll, pitch and yaw are about x, y, z as each has been turned by those before.",
    lambda: _rpy(lambda from_rpy, rpy: from_rpy([rpy[0], 0, 0]) @ from_rpy([0, rpy[1], 0]) @ from_rpy([0, 0, rpy[2]])),
)
wrong(
    "Roll, pitch and yaw are in degrees.",
    lambda: _rpy(lambda from_rpy, rpy: from_rpy([math.radians(angle) for angle in rpy])),
)
wrong("The three angles are yaw, pitch and roll.", lambda: _rpy(lambda from_rpy, rpy: from_rpy(rpy[::-1])))
wrong("The orientation of a pose is ignored.", lambda: _rpy(lambda from_rpy, rpy: np.eye(3)))


def _rpy(other: Callable[..., Any]) -> Deviation:
    return instead(urdf, "from_rpy", other)


wrong = means("EU-FRM-006")
wrong(
    "The position of a pose is along the axes that its orientation has turned.",
    lambda: instead(urdf, "pose", lambda right, R, p: right(R) @ right(None, p)),
)


@means("EU-FRM-004")
def links_behind_fixed_joints_are_at_their_body() -> Deviation:
    """A link behind a fixed joint has the frame of the body that it is part of."""

    def fixed(right: Any, found: Any, joint: Any) -> None:
        found.links[joint.child] = found.joint_frames[joint.name] = found.links[joint.parent]

    return instead(tree, "add_fixed", fixed)


@means("EU-FRM-005")
def joint_frames_on_the_parents_side() -> Deviation:
    """The name of a joint refers to the frame in which it turns, on its parent's side."""

    def joint(right: Any, found: Any, of: Any, change: Any) -> None:
        right(found, of, change)
        found.joint_frames[of.name] = found.links[of.parent] @ of.origin

    return instead(tree, "add_joint", joint)


@means("EU-JNT-019")
def joints_are_locked_in_the_middle() -> Deviation:
    """A joint that becomes fixed is locked in the middle of its range."""

    def fixed(right: Any, found: Any, joint: Any) -> None:
        right(found, joint)
        if joint.lower is not None:
            middle = [(joint.lower + joint.upper) / 2]
            moved = transform(joint.type, joint.axis[None, :], 0.0, middle)
            found.links[joint.child] = found.joint_frames[joint.name] = found.links[joint.child] @ moved

    return instead(tree, "add_fixed", fixed)


@means("EU-JNT-019")
def locked_joints_lose_their_origin() -> Deviation:
    """What a locked joint carries is where its parent is."""

    def fixed(right: Any, found: Any, joint: Any) -> None:
        right(found, joint)
        if joint.type != "fixed":
            found.links[joint.child] = found.joint_frames[joint.name] = found.links[joint.parent]

    return instead(tree, "add_fixed", fixed)


@refuses("EU-FRM-004", versions=("2",))
def joints_with_another_name_are_no_frames(data: Members, robot: Any) -> bool:
    """`{joint: …}` must not name the last of three merged joints if their joint has another name."""
    entries = ((name, entry) for name, entry in data.get("joints", {}).items() if isinstance(entry, dict))
    gone = {entry["merges"][2] for name, entry in entries if "merges" in entry} - set(data.get("joints", {}))
    used = [*data.get("frames", ()), *(frame for closure in data.get("closures", ()) for frame in closure["frames"])]
    return any(isinstance(frame, dict) and frame.get("joint") in gone for frame in used)


_HERE = Pose(rotation=[[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation=[0, 0, 0])


def _each(robot: CanonicalRobot, change: Callable[[CanonicalShape], Members]) -> Members:
    return {"shapes": [shape.model_copy(update=change(shape)) for shape in robot.shapes]}


def _of_child_links(robot: CanonicalRobot, types: Sequence[str]) -> set[str]:
    return {joint.child for joint in robot.joints if joint.type in types}


wrong = describes("EU-CAN-006")
wrong("No shape is read.", lambda robot: {"shapes": []})
wrong(
    "Only visual shapes are read.", lambda robot: {"shapes": [shape for shape in robot.shapes if shape.use == "visual"]}
)
wrong(
    "A link has at most one visual and one collision shape.",
    lambda robot: {"shapes": list({(shape.link, shape.use): shape for shape in reversed(robot.shapes)}.values())},
)
wrong(
    "Visual shapes are for collisions, and the other way round.",
    lambda robot: _each(robot, lambda shape: {"use": "collision" if shape.use == "visual" else "visual"}),
)
wrong("The origin of a shape is ignored.", lambda robot: _each(robot, lambda shape: {"pose": _HERE}))
wrong(
    "The orientation of a shape is ignored.",
    lambda robot: _each(robot, lambda shape: {"pose": shape.pose.model_copy(update={"rotation": _HERE.rotation})}),
)


@describes("EU-CAN-006", versions=("1",))
def shapes_on_universal_joints_are_moved(robot: CanonicalRobot) -> Members:
    """The shapes of a link that a universal joint carries are moved."""
    moved = _of_child_links(robot, ("universal", "revolute", "continuous"))
    return _each(robot, lambda shape: {"pose": _HERE} if shape.link in moved else {})


@describes("EU-CAN-006", versions=("2",))
def shapes_on_spherical_joints_are_moved(robot: CanonicalRobot) -> Members:
    """The shapes of a link that a spherical joint carries are moved."""
    moved = _of_child_links(robot, ("spherical",))
    return _each(robot, lambda shape: {"pose": _HERE} if shape.link in moved else {})


wrong = describes("EU-CAN-006")
wrong(
    "The length of a cylinder is taken for twice its half.",
    lambda robot: _each(
        robot, lambda shape: {"size": [shape.size[0], shape.size[1] / 2]} if shape.type == "cylinder" else {}
    ),
)
wrong(
    "The scale of a mesh is ignored.",
    lambda robot: _each(robot, lambda shape: {"size": [1.0, 1.0, 1.0]} if shape.type == "mesh" else {}),
)
