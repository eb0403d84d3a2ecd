"""Parsers that place frames elsewhere, and drop, move or change shapes."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from eurdf_conformance.oracle import tree, urdf
from eurdf_conformance.oracle.transform import transform
from eurdf_conformance.protocol.message import CanonicalRobot, CanonicalShape, Pose
from mutants.mutant import Deviation, Members, instead

_rpy = partial(instead, urdf, "from_rpy")


def fixed_at(place: Callable[[Any, Any], Any]) -> Deviation:
    """What a joint carries that does not move is somewhere else: place(tree, joint), None if it is not."""

    def fixed(right: Any, found: Any, joint: Any) -> None:
        right(found, joint)
        if (other := place(found, joint)) is not None:
            found.links[joint.child] = found.joint_frames[joint.name] = other

    return instead(tree, "add_fixed", fixed)


def _parents_side(right: Any, found: Any, of: Any, change: Any) -> None:
    right(found, of, change)
    found.joint_frames[of.name] = found.links[of.parent] @ of.origin


def _in_the_middle(found: Any, joint: Any) -> Any:
    if joint.lower is None:
        return None
    return found.links[joint.child] @ transform(joint.type, joint.axis[None, :], 0.0, [(joint.lower + joint.upper) / 2])


def _uses_a_joint_that_is_gone(data: Members, robot: Any) -> bool:
    entries = ((name, entry) for name, entry in data.get("joints", {}).items() if isinstance(entry, dict))
    gone = {entry["merges"][2] for name, entry in entries if "merges" in entry} - set(data.get("joints", {}))
    used = [*data.get("frames", ()), *(frame for closure in data.get("closures", ()) for frame in closure["frames"])]
    return any(isinstance(frame, dict) and frame.get("joint") in gone for frame in used)


_HERE = Pose(rotation=[[1, 0, 0], [0, 1, 0], [0, 0, 1]], translation=[0, 0, 0])


def _each(change: Callable[[CanonicalShape], Members]) -> Callable[[CanonicalRobot], Members]:
    return lambda robot: {"shapes": [shape.model_copy(update=change(shape)) for shape in robot.shapes]}


def _moved_on(*types: str) -> Callable[[CanonicalRobot], Members]:
    def moved(robot: CanonicalRobot) -> Members:
        carried = {joint.child for joint in robot.joints if joint.type in types}
        return _each(lambda shape: {"pose": _HERE} if shape.link in carried else {})(robot)

    return moved


MEANS = {
    "EU-FRM-006": {
        "Roll, pitch and yaw are about x, y, z as each has been turned by those before.": _rpy(
            lambda right, rpy: right([rpy[0], 0, 0]) @ right([0, rpy[1], 0]) @ right([0, 0, rpy[2]])
        ),
        "Roll, pitch and yaw are in degrees.": _rpy(lambda right, rpy: right([math.radians(angle) for angle in rpy])),
        "The three angles are yaw, pitch and roll.": _rpy(lambda right, rpy: right(rpy[::-1])),
        "The orientation of a pose is ignored.": _rpy(lambda right, rpy: np.eye(3)),
        "The position of a pose is along the axes that its orientation has turned.": instead(
            urdf, "pose", lambda right, R, p: right(R) @ right(None, p)
        ),
    },
    "EU-FRM-004": {
        "A link behind a fixed joint has the frame of the body that it is part of.": fixed_at(
            lambda found, joint: found.links[joint.parent]
        ),
    },
    "EU-FRM-005": {
        "The name of a joint refers to the frame in which it turns, on its parent's side.": instead(
            tree, "add_joint", _parents_side
        ),
    },
    "EU-JNT-019": {
        "A joint that becomes fixed is locked in the middle of its range.": fixed_at(_in_the_middle),
        "What a locked joint carries is where its parent is.": fixed_at(
            lambda found, joint: found.links[joint.parent] if joint.type != "fixed" else None
        ),
    },
}

REFUSES = {
    ("EU-FRM-004", "2"): {
        "`{joint: …}` must not name the last of three merged joints if their joint has another name.": (
            _uses_a_joint_that_is_gone
        ),
    },
}

DESCRIBES = {
    "EU-CAN-006": {
        "No shape is read.": lambda robot: {"shapes": []},
        "Only visual shapes are read.": lambda robot: {
            "shapes": [shape for shape in robot.shapes if shape.use == "visual"]
        },
        "A link has at most one visual and one collision shape.": lambda robot: {
            "shapes": list({(shape.link, shape.use): shape for shape in reversed(robot.shapes)}.values())
        },
        "Visual shapes are for collisions, and the other way round.": _each(
            lambda shape: {"use": "collision" if shape.use == "visual" else "visual"}
        ),
        "The origin of a shape is ignored.": _each(lambda shape: {"pose": _HERE}),
        "The orientation of a shape is ignored.": _each(
            lambda shape: {"pose": shape.pose.model_copy(update={"rotation": _HERE.rotation})}
        ),
        "The length of a cylinder is taken for twice its half.": _each(
            lambda shape: {"size": [shape.size[0], shape.size[1] / 2]} if shape.type == "cylinder" else {}
        ),
        "The scale of a mesh is ignored.": _each(
            lambda shape: {"size": [1.0, 1.0, 1.0]} if shape.type == "mesh" else {}
        ),
    },
    ("EU-CAN-006", "1"): {
        "The shapes of a link that a universal joint carries are moved.": _moved_on(
            "universal", "revolute", "continuous"
        ),
    },
    ("EU-CAN-006", "2"): {"The shapes of a link that a spherical joint carries are moved.": _moved_on("spherical")},
}
