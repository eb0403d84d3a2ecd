"""Parsers that drop, move or change shapes."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from eurdf_conformance.protocol.message import CanonicalRobot, CanonicalShape, Pose
from mutants.mutant import Members, describes

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
